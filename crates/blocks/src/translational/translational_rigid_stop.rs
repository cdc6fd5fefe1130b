use blocksim_block::prelude::*;

use crate::mechanics::quantities::TRANSLATION;
use crate::mechanics::rigid_stop::{RigidStop, without_end};

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
#[block(category = "Translational", symbol = HardStop, builds = RigidStop)]
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
    fn validate(&self, errors: &mut ParamErrors) {
        if self.lower.is_none() && self.upper.is_none() {
            errors.add(without_end());
        }
    }

    fn build(self, _errors: &mut ParamErrors) -> Option<RigidStop> {
        let Self { lower, upper, restitution, x0 } = self;
        Some(RigidStop { lower, upper, restitution, quantities: &TRANSLATION, start: x0 })
    }
}
