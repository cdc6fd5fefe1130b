use blocksim_block::physical::{Domain, DryMesh};
use blocksim_block::prelude::*;

use crate::gears::mesh::{Direction, Loss, Mesh};

use super::converter::radius;

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
    #[block(unit = "m")]
    pub radius: f64,
    /// `Same`: the rack moves forward while the base turns in the positive sense; or `Reversed`.
    #[block(default = Direction::Same)]
    pub direction: Direction,
    /// Efficiency, above 0 and at most 1.
    #[block(default = 1.0)]
    pub efficiency: f64,
    /// `Dissipative`, `Published` or `Stiction`: how the loss sets in around standstill.
    #[block(default = Loss::Dissipative)]
    pub loss: Loss,
    /// Speed of the pinion above which the full loss acts; for `Dissipative`.
    #[block(unit = "rad/s", default = 1.0)]
    pub threshold: f64,
    /// Power above which the full loss acts; for `Published`.
    #[block(unit = "W", default = 1e-3)]
    pub power_threshold: f64,
}

impl RackAndPinion {
    fn mesh(&self) -> Mesh {
        Mesh {
            forward: ("efficiency", self.efficiency),
            backward: ("efficiency", self.efficiency),
            loss: self.loss,
            threshold: self.threshold,
            power_threshold: self.power_threshold,
        }
    }
}

impl Block for RackAndPinion {
    fn check(&self) -> Result<(), ParamError> {
        radius(self.radius)?;
        self.mesh().check()
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for RackAndPinion {
    fn part(&self, _given: &Given) -> Part {
        self.mesh().part(Domain::Translational, self.direction.ratio(self.radius))
    }

    fn mesh_losses(&self, _c: &Law, _speed: &[f64], losses: &mut [DryMesh]) {
        losses.fill(self.mesh().dry());
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y[0] = c.mesh[0];
    }
}
