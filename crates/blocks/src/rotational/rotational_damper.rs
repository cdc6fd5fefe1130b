use blocksim_block::prelude::*;

use crate::mechanics::quantities::ROTATION;

/// Viscous friction between two turning parts: $\tau = d\,(w_r - w_c)$.
///
/// ```ron
/// RotationalDamper(d: "0.001 N*m*s/rad")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Damper)]
pub struct RotationalDamper {
    /// Damping coefficient; zero is allowed.
    #[block(unit = "N*m*s/rad", not_negative)]
    pub d: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl Component for RotationalDamper {
    fn part(&self, _given: &Given) -> Part {
        ROTATION.damped().heat_port(self.heat_port)
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        tau[0] = Torque { value: self.d * c.speed[0], slope: self.d };
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(self.d * c.speed[0] * c.speed[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_torque_is_the_damping_coefficient_times_the_speed() {
        for (d, w) in [(0.5, 3.0), (0.0, 1e6), (2.0, -0.25)] {
            let mut tau = [Torque::default()];
            RotationalDamper { d, heat_port: false }
                .torques(&Seen { speed: &[w], ..law() }.loaded(), &mut tau);
            assert_eq!(tau[0], Torque { value: d * w, slope: d });
        }
    }

    #[test]
    fn a_negative_coefficient_is_refused() {
        assert_eq!(RotationalDamper { d: -1.0, heat_port: false }.errors()[0].param, "d");
    }
}
