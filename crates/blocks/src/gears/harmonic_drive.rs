use blocksim_block::physical::{Domain, DryMesh};
use blocksim_block::prelude::*;

use super::mesh::{Direction, EachWay};

/// Harmonic drive: a wave generator (`base`) presses a flexible spline with $n_E$ teeth (`follower`) into a
/// circular spline with $n_C$ teeth, which is fixed to the housing.
///
/// $$ w_F = \mp r w_B, \qquad r = \frac{n_C - n_E}{n_E}, \qquad T_B = T + T_f $$
///
/// The output turns against the input (`Reversed`); `Same` is for drives whose mounting undoes the reversal. The
/// reduction is $1/r$: 200 teeth in 202 give 100.
///
/// Losses act as in a `CycloidalDrive`: far above the thresholds the side that is driven gets the share
/// `efficiency_forward` (base drives) or `efficiency_backward` (follower drives) of the torque. The drive is
/// rigid and has no inertia: put a `RotationalSpringDamper` behind the follower for its elasticity, and an
/// `Inertia` at the base for the wave generator. Its housing stands still (an implied ground).
///
/// ```ron
/// HarmonicDrive(flexspline_teeth: 200, circular_teeth: 202, efficiency_forward: 0.75, efficiency_backward: 0.6)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = WaveGear)]
pub struct HarmonicDrive {
    /// Teeth of the flexible spline $n_E$.
    #[block(at_least = 1, zero = "a spline has teeth")]
    pub flexspline_teeth: u32,
    /// Teeth of the circular spline $n_C$, more than the flexible one has.
    #[block(
        above = flexspline_teeth,
        remedy = "the circular spline surrounds the flexible one and has a few teeth more, mostly two",
    )]
    pub circular_teeth: u32,
    /// `Reversed` or `Same`.
    #[block(default = Direction::Reversed)]
    pub direction: Direction,
    /// Its losses.
    #[block(group)]
    pub losses: EachWay,
}

impl HarmonicDrive {
    /// Speed of the follower over speed of the base.
    fn ratio(&self) -> f64 {
        let (flexible, circular) = (f64::from(self.flexspline_teeth), f64::from(self.circular_teeth));
        self.direction.ratio((circular - flexible) / flexible)
    }
}

impl Component for HarmonicDrive {
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

    fn drive(flexspline_teeth: u32, circular_teeth: u32) -> HarmonicDrive {
        HarmonicDrive {
            flexspline_teeth,
            circular_teeth,
            direction: Direction::Reversed,
            losses: EachWay::NONE,
        }
    }

    #[test]
    fn two_teeth_of_difference_give_half_the_teeth_as_reduction() {
        for (flexible, reduction) in [(100, 50.0), (160, 80.0), (200, 100.0), (320, 160.0)] {
            let found = -1.0 / drive(flexible, flexible + 2).ratio();
            assert!((found - reduction).abs() < 1e-12 * reduction, "{flexible}: {found} != {reduction}");
        }
    }

    #[test]
    fn a_circular_spline_without_more_teeth_is_refused() {
        let error = drive(202, 200).errors()[0].clone();
        assert_eq!(error.param, "circular_teeth");
        assert!(error.help.is_some());
        assert_eq!(drive(0, 2).errors()[0].param, "flexspline_teeth");
        assert_eq!(
            HarmonicDrive { losses: EachWay { efficiency_forward: 1.5, ..EachWay::NONE }, ..drive(200, 202) }
                .errors()[0]
                .param,
            "efficiency_forward"
        );
        assert_eq!(drive(200, 202).errors()[..], []);
    }
}
