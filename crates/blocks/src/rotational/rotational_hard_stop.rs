use blocksim_block::prelude::*;

use crate::mechanics::contact::Travel;
use crate::mechanics::elastic::Elastic;
use crate::mechanics::quantities::ROTATION;
use crate::multibody::joint_limit::JointLimit;

/// End of travel between two turning parts: free between two angles, a spring and a damper beyond them.
///
/// $$ \tau = s\,(k\,\delta + d\,\dot\delta), \qquad s = 3 x^2 - 2 x^3, \quad x = \min(\delta / b, 1) $$
///
/// with the penetration $\delta = \varphi - \varphi_{upper}$, or the mirrored law at the lower end. Both parts
/// set in smoothly over the transition width $b$; the stop pushes back and never pulls, so it never delivers
/// more than its spring has stored. The angle $\varphi$, $\dot\varphi = w_r - w_c$, is a state.
///
/// ```ron
/// RotationalHardStop(lower: "-90 deg", upper: "90 deg", stiffness: "1e5 N*m/rad", damping: "50 N*m*s/rad")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = HardStop, builds = Elastic<Travel>)]
pub struct RotationalHardStop {
    /// Least angle without contact.
    #[block(unit = "rad", finite, default = -0.1)]
    pub lower: f64,
    /// Largest angle without contact.
    #[block(unit = "rad", finite, above = lower, default = 0.1)]
    pub upper: f64,
    /// Stiffness $k$ of both ends.
    #[block(unit = "N*m/rad", not_negative, default = 1e6)]
    pub stiffness: f64,
    /// Damping $d$ of both ends.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.01)]
    pub damping: f64,
    /// Width $b$ over which an end sets in; zero sets in at once.
    #[block(unit = "rad", not_negative, default = 1e-3)]
    pub transition: f64,
    /// Angle at the start.
    #[block(
        unit = "rad", finite, at_least = lower, at_most = upper, default = 0.0,
        remedy = "start within the free travel, or move `lower` and `upper`",
    )]
    pub phi0: f64,
}

impl RotationalHardStop {
    fn build(self, _errors: &mut ParamErrors) -> Option<Elastic<Travel>> {
        let Self { lower, upper, stiffness, damping, transition, phi0 } = self;
        let law = Travel { lower, upper, end: JointLimit { stiffness, damping, transition } };
        Some(Elastic { law, quantities: &ROTATION, start: phi0 })
    }
}
