use blocksim_block::prelude::*;

use crate::mechanics::contact::Travel;
use crate::mechanics::elastic::Elastic;
use crate::mechanics::quantities::TRANSLATION;
use crate::multibody::joint_limit::JointLimit;

/// End of travel between two sliding parts: free between two positions, a spring and a damper beyond them.
///
/// $$ F = s\,(k\,\delta + d\,\dot\delta), \qquad s = 3 x^2 - 2 x^3, \quad x = \min(\delta / b, 1) $$
///
/// with the penetration $\delta$ beyond the upper end, or the mirrored law at the lower end. Both parts set in smoothly
/// over the transition width $b$; the stop pushes back and never pulls, so it never delivers more than its spring has
/// stored. The position of `r` against `c` is a state.
///
/// ```ron
/// TranslationalHardStop(lower: "0 mm", upper: "400 mm", stiffness: "2e6 N/m", damping: "4e3 N*s/m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = HardStop, builds = Elastic<Travel>)]
pub struct TranslationalHardStop {
    /// Least position without contact.
    #[block(unit = "m", finite, default = -0.1)]
    pub lower: f64,
    /// Largest position without contact.
    #[block(unit = "m", finite, above = lower, default = 0.1)]
    pub upper: f64,
    /// Stiffness $k$ of both ends.
    #[block(unit = "N/m", not_negative, default = 1e6)]
    pub stiffness: f64,
    /// Damping $d$ of both ends.
    #[block(unit = "N*s/m", not_negative, default = 1e3)]
    pub damping: f64,
    /// Width $b$ over which an end sets in; zero sets in at once.
    #[block(unit = "m", not_negative, default = 1e-4)]
    pub transition: f64,
    /// Position at the start.
    #[block(
        unit = "m", finite, at_least = lower, at_most = upper, default = 0.0,
        remedy = "start within the free travel, or move `lower` and `upper`",
    )]
    pub x0: f64,
}

impl TranslationalHardStop {
    fn build(self, _errors: &mut ParamErrors) -> Option<Elastic<Travel>> {
        let Self { lower, upper, stiffness, damping, transition, x0 } = self;
        let law = Travel { lower, upper, end: JointLimit { stiffness, damping, transition } };
        Some(Elastic { law, quantities: &TRANSLATION, start: x0 })
    }
}
