use blocksim_block::prelude::*;

use crate::mechanics::quantities::ROTATION;
use crate::mechanics::rigid_stop::{RigidStop, without_end};

/// Rigid end of travel between two turning parts: free between two angles, and an end is never passed.
///
/// What hits an end bounces back with the part $e$ of its speed,
///
/// $$ w^+ = -e\,w^- $$
///
/// and the impulse goes through everything that is rigidly coupled, not through dry friction. The bounces of what falls
/// on an end follow each other ever faster and are over at a finite time: then it rests there, exactly, until it is pulled
/// away. With $e = 0$ it rests at once.
///
/// Ends with a spring and a damper are a `RotationalHardStop`.
///
/// ```ron
/// RotationalRigidStop(lower: "-90 deg", upper: "90 deg", restitution: 0.3)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = HardStop, builds = RigidStop)]
pub struct RotationalRigidStop {
    /// Least angle; none unless given.
    #[block(unit = "rad", finite, default = None)]
    pub lower: Option<f64>,
    /// Largest angle; none unless given.
    #[block(unit = "rad", finite, above = lower, default = None)]
    pub upper: Option<f64>,
    /// Restitution $e$: part of the speed that is left after a bounce, 0 to 1.
    #[block(at_least = 0.0, at_most = 1.0, default = 0.0, remedy = "0 does not bounce, 1 loses nothing")]
    pub restitution: f64,
    /// Angle at the start.
    #[block(
        unit = "rad", finite, at_least = lower, at_most = upper, default = 0.0,
        remedy = "start within the travel, or move `lower` and `upper`",
    )]
    pub phi0: f64,
}

impl RotationalRigidStop {
    fn validate(&self, errors: &mut ParamErrors) {
        if self.lower.is_none() && self.upper.is_none() {
            errors.add(without_end());
        }
    }

    fn build(self, _errors: &mut ParamErrors) -> Option<RigidStop> {
        let Self { lower, upper, restitution, phi0 } = self;
        Some(RigidStop { lower, upper, restitution, quantities: &ROTATION, start: phi0 })
    }
}
