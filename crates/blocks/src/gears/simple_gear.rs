use blocksim_block::physical::{Domain, DryMesh};
use blocksim_block::prelude::*;

use super::mesh::{BothWays, Direction};

/// Pair of gear wheels with one efficiency for both directions of power: $w_B = \mp i\, w_F$.
///
/// Losses act as in a `CycloidalDrive` whose two efficiencies are equal. The gear has no inertia; its housing
/// stands still (an implied ground).
///
/// ```ron
/// SimpleGear(ratio: 50.0, direction: Same, efficiency: 0.95)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Gears", symbol = Gear)]
pub struct SimpleGear {
    /// Teeth of the follower over teeth of the base: the reduction $i$.
    #[block(positive, remedy = "the sign of the ratio is given by `direction: Reversed` or `Same`")]
    pub ratio: f64,
    /// `Reversed` or `Same`.
    #[block(default = Direction::Reversed)]
    pub direction: Direction,
    /// Its losses.
    #[block(group)]
    pub losses: BothWays,
}

impl Component for SimpleGear {
    fn part(&self, _given: &Given) -> Part {
        self.losses.mesh().part(Domain::Rotational, self.direction.ratio(1.0 / self.ratio))
    }

    fn mesh_losses(&self, _c: &Flowing, _speed: &[f64], losses: &mut [DryMesh]) {
        losses.fill(self.losses.mesh().dry());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_ratio_is_refused_with_a_hint_at_the_direction() {
        let gear = SimpleGear { ratio: -2.0, direction: Direction::Same, losses: BothWays::NONE };
        let error = gear.errors()[0].clone();
        assert_eq!(error.param, "ratio");
        assert!(error.help.is_some_and(|help| help.contains("direction")));
    }
}
