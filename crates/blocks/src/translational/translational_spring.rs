use blocksim_block::prelude::*;

use crate::mechanics::contact::SpringDamper;
use crate::mechanics::elastic::Elastic;
use crate::mechanics::quantities::TRANSLATION;

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
#[block(category = "Translational", symbol = Spring, builds = Elastic<SpringDamper>)]
pub struct TranslationalSpring {
    /// Stiffness; zero is allowed.
    #[block(unit = "N/m", not_negative)]
    pub k: f64,
    /// Deflection at the start.
    #[block(unit = "m", finite, default = 0.0)]
    pub x0: f64,
}

impl TranslationalSpring {
    fn build(self, _errors: &mut ParamErrors) -> Option<Elastic<SpringDamper>> {
        Some(Elastic { law: SpringDamper::spring(self.k), quantities: &TRANSLATION, start: self.x0 })
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
