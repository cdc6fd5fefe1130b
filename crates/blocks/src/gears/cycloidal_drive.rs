use blocksim_block::physical::{Domain, DryMesh};
use blocksim_block::prelude::*;

use super::mesh::{Direction, EachWay};

/// Cycloidal gear: a disc with $n_C$ lobes rolls in a ring with $n_R$ pins.
///
/// $$ w_F = \mp r w_B, \qquad r = \frac{n_R - n_C}{n_C}, \qquad T_B = T + T_f $$
///
/// The output turns against the input (`Reversed`), as that of a bare cycloidal stage does; `Same` is for
/// drives whose further stages or mounting undo the reversal. The reduction is $1/r$: 50 lobes and 51 pins
/// give 50, and any rational ratio $p/q$ is $n_C = p$, $n_R = p + q$.
///
/// Losses. Far above the thresholds the side that is driven gets the share `efficiency_forward` (base drives)
/// or `efficiency_backward` (follower drives) of the torque. With $\lambda = 1 - \eta_{BF}$ when the base
/// drives and $1/\eta_{FB} - 1$ when the follower does, the loss of torque at the base is
///
/// $$ T_f = |T_B| \lambda \tanh\frac{w_B}{w_{th}} \quad\text{(Dissipative)}, \qquad
///    T_f = \frac{T_B}{2}\Bigl((FL + BL)\tanh\frac{4 T_B w_B}{p_{th}} + FL - BL\Bigr)
///    \quad\text{(Published)} $$
///
/// with $FL = 1 - \eta_{BF}$ and $BL = 1/\eta_{FB} - 1$. With `Stiction` the full loss acts at any speed, and at rest the
/// gear is truly stuck while the torques on both sides are within the losses. The gear has no inertia: add an `Inertia` at the
/// base. Its housing stands still (an implied ground).
///
/// ```ron
/// CycloidalDrive(
///     disc_teeth: 126, ring_teeth: 127, direction: Same,
///     efficiency_forward: 0.75, efficiency_backward: 0.7,
/// )
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = WaveGear)]
pub struct CycloidalDrive {
    /// Lobes of the disc.
    #[block(at_least = 1, zero = "a disc has lobes")]
    pub disc_teeth: u32,
    /// Pins of the ring, more than lobes.
    #[block(above = disc_teeth, remedy = "for a reduction of `disc_teeth` the ring has one tooth more")]
    pub ring_teeth: u32,
    /// `Reversed` or `Same`.
    #[block(default = Direction::Reversed)]
    pub direction: Direction,
    /// Its losses.
    #[block(group)]
    pub losses: EachWay,
}

impl CycloidalDrive {
    /// Speed of the follower over speed of the base.
    fn ratio(&self) -> f64 {
        self.direction
            .ratio((f64::from(self.ring_teeth) - f64::from(self.disc_teeth)) / f64::from(self.disc_teeth))
    }
}

impl Component for CycloidalDrive {
    fn part(&self, _given: &Given) -> Part {
        self.losses.mesh().part(Domain::Rotational, self.ratio())
    }

    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], losses: &mut [DryMesh]) {
        losses.fill(self.losses.mesh().dry());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(disc_teeth: u32, ring_teeth: u32) -> CycloidalDrive {
        CycloidalDrive { disc_teeth, ring_teeth, direction: Direction::Reversed, losses: EachWay::NONE }
    }

    #[test]
    fn ratios_of_real_gears_are_exact() {
        for (disc, ring, reduction) in [
            (126, 127, 126.0),
            (141, 142, 141.0),
            (105, 106, 105.0),
            (323, 326, 323.0 / 3.0),
            (2133, 2146, 2133.0 / 13.0),
        ] {
            let found = -1.0 / drive(disc, ring).ratio();
            assert!((found - reduction).abs() < 1e-12 * reduction, "{disc}, {ring}: {found} != {reduction}");
            let same = CycloidalDrive { direction: Direction::Same, ..drive(disc, ring) };
            assert_eq!(same.ratio(), -drive(disc, ring).ratio());
        }
    }

    #[test]
    fn a_ring_without_more_teeth_than_the_disc_is_refused() {
        assert_eq!(drive(50, 50).errors()[0].param, "ring_teeth");
        assert_eq!(drive(0, 50).errors()[0].param, "disc_teeth");
        assert_eq!(drive(50, 51).errors()[..], []);
    }
}
