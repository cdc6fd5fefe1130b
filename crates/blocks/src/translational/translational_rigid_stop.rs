use blocksim_block::physical::Grip;
use blocksim_block::prelude::*;

use crate::mechanics::quantities::TRANSLATION;
use crate::mechanics::rigid_stop::RigidStop;

/// Rigid end of travel between two sliding parts: free between two positions, and an end is never passed.
///
/// What hits an end bounces back with the part $e$ of its speed,
///
/// $$ v^+ = -e\,v^- $$
///
/// and the impulse goes through everything that is rigidly coupled, not through dry friction. The bounces of what falls
/// on an end follow each other ever faster and are over at a finite time: then it rests there, exactly, until it is pulled
/// away. With $e = 0$ it rests at once.
///
/// Ends with a spring and a damper are a `TranslationalHardStop`.
///
/// ```ron
/// TranslationalRigidStop(lower: "0 m", restitution: 0.8)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = HardStop)]
pub struct TranslationalRigidStop {
    /// Least position; none unless given.
    #[block(unit = "m", finite, default = None)]
    pub lower: Option<f64>,
    /// Largest position; none unless given.
    #[block(unit = "m", finite, above = lower, default = None)]
    pub upper: Option<f64>,
    /// Restitution $e$: part of the speed that is left after a bounce, 0 to 1.
    #[block(at_least = 0.0, at_most = 1.0, default = 0.0, remedy = "0 does not bounce, 1 loses nothing")]
    pub restitution: f64,
    /// Position at the start.
    #[block(
        unit = "m", finite, at_least = lower, at_most = upper, default = 0.0,
        remedy = "start within the travel, or move `lower` and `upper`",
    )]
    pub x0: f64,
}

impl TranslationalRigidStop {
    fn law(&self) -> RigidStop {
        RigidStop { lower: self.lower, upper: self.upper, restitution: self.restitution }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.law().validate(errors);
    }
}

impl Component for TranslationalRigidStop {
    fn part(&self, _given: &Given) -> Part {
        self.law().part(&TRANSLATION, self.x0)
    }

    fn grips(&self, c: &Flowing, grips: &mut [Grip]) {
        grips[0] = self.law().grip(c.x[0]);
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        self.law().guards(c.x[0], g);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }
}
