use blocksim_block::prelude::*;

use crate::mechanics::quantities::{TRANSLATION, undamped};

/// Spring between two sliding parts.
///
/// $$ F = k x, \qquad \dot x = v_r - v_c $$
///
/// The deflection is a state; a positive one is a spring pulled long. With a very stiff spring two parts move almost as
/// one; where that is all it is for, connect them rigidly instead: that costs nothing and is exact.
///
/// ```ron
/// TranslationalSpring(k: "2 N/mm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Spring)]
pub struct TranslationalSpring {
    /// Stiffness; zero is allowed.
    #[block(unit = "N/m", not_negative)]
    pub k: f64,
    /// Deflection at the start.
    #[block(unit = "m", finite, default = 0.0)]
    pub x0: f64,
}

impl Component for TranslationalSpring {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.elastic(self.x0)
    }

    fn torques(&self, c: &Flowing, f: &mut [Torque]) {
        f[0] = undamped(self.k * c.x[0]);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::stored(0.5 * self.k * c.x[0] * c.x[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_negative_stiffness_and_an_endless_deflection_are_refused() {
        assert_eq!(TranslationalSpring { k: -1.0, x0: 0.0 }.errors()[0].param, "k");
        assert_eq!(TranslationalSpring { k: 1.0, x0: f64::NAN }.errors()[0].param, "x0");
    }
}
