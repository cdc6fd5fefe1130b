use blocksim_block::prelude::*;

use crate::mechanics::quantities::ROTATION;

/// A rotating mass: $\tau = J \dot w$, against an implied ground.
///
/// Inertias that are coupled rigidly, through gears too, are one state: an inertia behind a gear of ratio $i$ counts
/// $i^2$ times.
///
/// ```ron
/// Inertia(j: "0.26 kg*m^2")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Inertia)]
pub struct Inertia {
    /// Moment of inertia; zero is allowed where something else gives the part its inertia.
    #[block(unit = "kg*m^2", not_negative)]
    pub j: f64,
    /// Speed at the start. Where none is given it is that of the parts it is coupled to, else zero.
    #[block(unit = "rad/s", finite, default = None)]
    pub w0: Option<f64>,
}

impl Component for Inertia {
    fn part(&self, _given: &Given) -> Part {
        ROTATION.inertia("the rotating part", self.j, self.w0)
    }
}
