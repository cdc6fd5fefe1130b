use blocksim_block::prelude::*;

use crate::mechanics::quantities::{ROTATION, undamped};

/// Constant torque between two turning parts, whatever their speed: positive `tau` drives `r` against `c`.
///
/// For a torque that changes use an `IdealTorqueSource`.
///
/// ```ron
/// ConstantTorque(tau: "-12 N*m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Torque)]
pub struct ConstantTorque {
    /// Torque on `r`.
    #[block(unit = "N*m", finite)]
    pub tau: f64,
}

impl Component for ConstantTorque {
    fn part(&self, _given: &Given) -> Part {
        ROTATION.branch()
    }

    fn torques(&self, _c: &Flowing, tau: &mut [Torque]) {
        tau[0] = undamped(-self.tau);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::supplied(self.tau * c.speed[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_torque_is_the_same_at_every_speed() {
        for w in [-7.0, 0.0, 300.0] {
            let mut tau = [Torque::default()];
            ConstantTorque { tau: 2.5 }.torques(&Seen { speed: &[w], ..law() }.loaded(), &mut tau);
            assert_eq!(tau[0], Torque { value: -2.5, slope: 0.0 });
        }
    }

    #[test]
    fn an_infinite_torque_is_refused() {
        assert_eq!(ConstantTorque { tau: f64::INFINITY }.errors()[0].param, "tau");
    }
}
