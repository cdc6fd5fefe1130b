//! Losses of meshes.

use super::Torque;

/// How torque is lost in a mesh; see [`Element::Gear`](super::Element::Gear).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshLoss {
    /// Efficiency when the base drives the follower, in (0, 1].
    pub forward: f64,
    /// Efficiency when the follower drives the base, in (0, 1].
    pub backward: f64,
    /// How the loss sets in around standstill.
    pub model: LossModel,
}

/// How the loss of a mesh sets in around standstill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LossModel {
    /// `T_f = |T_B| lambda tanh(w_B / threshold)`: never delivers power. Threshold in rad/s at the base.
    Dissipative {
        /// Speed of the base at which the loss is fully there (tanh 1), rad/s.
        threshold: f64,
    },
    /// `T_f = T_B/2 ((FL + BL) tanh(4 p / threshold) + FL - BL)` with the power `p = T_B w_B`. Threshold in W.
    Published {
        /// Power above which the full loss acts, W.
        threshold: f64,
    },
    /// The full loss at any speed, and truly stuck at rest; [`Component::mesh_losses`](super::Component::mesh_losses) gives it, the efficiencies
    /// beside are not looked at. The network chooses between forward, backward and stuck ([`Moving::mode`](super::Moving::mode)).
    Stiction,
}

/// What a mesh loses while it slides; at rest it holds up to the same torque. With `T` the torque into the base that
/// passes on to the follower, the loss at the base is the larger one of `share[0] T + bearing[0]` and
/// `-share[1] T + bearing[1]` while the base turns forward, and against that, with `-T`, while it turns backward.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DryMesh {
    /// Loss over torque while the base drives (`1/eta - 1`) and while the follower drives (`1 - eta`, above 1 for a mesh
    /// that locks itself).
    pub share: [f64; 2],
    /// Torque of the bearings at the base while the base drives and while the follower drives, N*m; not negative.
    pub bearing: [Torque; 2],
}

impl DryMesh {
    /// Loss at the base, N*m, and its derivatives by the torque that passes and by the speed of the base, while the
    /// base turns in the direction of `sense` (1 or -1).
    pub fn loss(&self, torque: f64, sense: f64) -> (f64, f64, f64) {
        let driving = self.share[0] * sense * torque + self.bearing[0].value;
        let driven = -self.share[1] * sense * torque + self.bearing[1].value;
        if driving >= driven {
            (sense * driving, self.share[0], self.bearing[0].slope)
        } else {
            (sense * driven, -self.share[1], self.bearing[1].slope)
        }
    }
}
