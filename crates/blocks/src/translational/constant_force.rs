use blocksim_block::prelude::*;

use crate::mechanics::quantities::{TRANSLATION, undamped};

/// Constant force between two sliding parts, whatever their velocity: positive `f` drives `r` against `c`.
///
/// The weight of a mass that hangs, for instance; for a force that changes use an `IdealForceSource`.
///
/// ```ron
/// ConstantForce(f: "-20 kg * 9.80665 m/s^2")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Force)]
pub struct ConstantForce {
    /// Force on `r`.
    #[block(unit = "N", finite)]
    pub f: f64,
}

impl Component for ConstantForce {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.branch()
    }

    fn torques(&self, _c: &Flowing, f: &mut [Torque]) {
        f[0] = undamped(-self.f);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::supplied(self.f * c.speed[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_infinite_force_is_refused() {
        assert_eq!(ConstantForce { f: f64::INFINITY }.errors()[0].param, "f");
    }
}
