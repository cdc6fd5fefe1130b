use blocksim_block::prelude::*;

use crate::mechanics::quantities::TRANSLATION;

/// Viscous friction between two sliding parts: $F = d\,(v_r - v_c)$.
///
/// ```ron
/// TranslationalDamper(d: "40 N*s/m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Damper)]
pub struct TranslationalDamper {
    /// Damping coefficient; zero is allowed.
    #[block(unit = "N*s/m", not_negative)]
    pub d: f64,
    /// Has the thermal port `h`, by which the heat of all losses leaves.
    #[block(default = false)]
    pub heat_port: bool,
}

impl Component for TranslationalDamper {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.damped().heat_port(self.heat_port)
    }

    fn torques(&self, c: &Flowing, f: &mut [Torque]) {
        f[0] = Torque { value: self.d * c.speed[0], slope: self.d };
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(self.d * c.speed[0] * c.speed[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_coefficient_is_refused() {
        assert_eq!(TranslationalDamper { d: -1.0, heat_port: false }.errors()[0].param, "d");
    }
}
