use blocksim_block::physical::Domain;
use blocksim_block::prelude::*;

use crate::gears::mesh::{BothWays, Direction};

/// Wheel (`base`, turns) and what rolls off it without slip or losses (`follower`, slides): $v_F = \pm r\, w_B$.
///
/// A driven wheel on the road, a belt on its pulley, a rope on a drum. The rope of a drum is taken as always tight: it
/// pulls and pushes. For losses use a `RackAndPinion`.
///
/// ```ron
/// WheelAndAxle(radius: "0.31 m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Rack)]
pub struct WheelAndAxle {
    /// Radius $r$ of the wheel.
    #[block(
        unit = "m",
        positive,
        remedy = "the direction of the follower is set by `direction: Same` or `Reversed`"
    )]
    pub radius: f64,
    /// `Same`: the follower moves forward while the base turns in the positive sense; or `Reversed`.
    #[block(default = Direction::Same)]
    pub direction: Direction,
}

impl Component for WheelAndAxle {
    fn part(&self, _given: &Given) -> Part {
        BothWays::NONE.mesh().part(Domain::Translational, self.direction.ratio(self.radius))
    }
}
