use blocksim_block::physical::{Domain, DryMesh};
use blocksim_block::prelude::*;

use crate::gears::mesh::{BothWays, Direction};

/// Pinion (`base`, turns) and rack (`follower`, slides): $v_F = \pm r\, w_B$.
///
/// The pinion feels the force of the rack as the torque $r F$ and a mass on the rack as the moment of inertia $m r^2$.
/// One efficiency serves both directions of power; losses act as in a `SimpleGear`. The pair has neither inertia nor
/// mass; its housing stands still (an implied ground).
///
/// ```ron
/// RackAndPinion(radius: "30 mm", efficiency: 0.95)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Rack)]
pub struct RackAndPinion {
    /// Radius $r$ of the pitch circle of the pinion.
    #[block(
        unit = "m",
        positive,
        remedy = "the direction of the follower is set by `direction: Same` or `Reversed`"
    )]
    pub radius: f64,
    /// `Same`: the rack moves forward while the base turns in the positive sense; or `Reversed`.
    #[block(default = Direction::Same)]
    pub direction: Direction,
    /// Its losses.
    #[block(group)]
    pub losses: BothWays,
}

impl Component for RackAndPinion {
    fn part(&self, _given: &Given) -> Part {
        self.losses.mesh().part(Domain::Translational, self.direction.ratio(self.radius))
    }

    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], losses: &mut [DryMesh]) {
        losses.fill(self.losses.mesh().dry());
    }
}
