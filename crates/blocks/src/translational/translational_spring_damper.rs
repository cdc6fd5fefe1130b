use blocksim_block::prelude::*;

use crate::mechanics::contact::SpringDamper;
use crate::mechanics::elastic::Elastic;
use crate::mechanics::quantities::TRANSLATION;

/// Elastic link: a spring and a damper side by side, with play if there is any.
///
/// $$ F = k x + d v, \qquad \dot x = v = v_r - v_c $$
///
/// With a backlash $b$, the whole play from flank to flank, nothing is transmitted while $|x| < b/2$. Beyond it the
/// flanks are pressed together by $\delta = |x| - b/2$ and
///
/// $$ F = \operatorname{sgn}(x)\, \max\bigl(0,\; s\,(k \delta + d \dot\delta)\bigr) $$
///
/// as in a `RotationalSpringDamper`: flanks push and never pull, and the contact sets in at once ($s = 1$) or over the
/// width `transition`.
///
/// ```ron
/// TranslationalSpringDamper(k: "1e7 N/m", d: "2e3 N*s/m", backlash: "0.02 mm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = SpringDamper, builds = Elastic<SpringDamper>)]
pub struct TranslationalSpringDamper {
    /// Stiffness; zero is allowed.
    #[block(unit = "N/m", not_negative)]
    pub k: f64,
    /// Damping coefficient; zero is allowed.
    #[block(unit = "N*s/m", not_negative)]
    pub d: f64,
    /// Play between the flanks, from one contact to the other.
    #[block(unit = "m", not_negative, default = 0.0)]
    pub backlash: f64,
    /// Width over which the contact sets in; with backlash only.
    #[block(unit = "m", not_negative, default = 0.0)]
    pub transition: f64,
    /// Deflection at the start; zero is the middle of the play.
    #[block(unit = "m", finite, default = 0.0)]
    pub x0: f64,
}

impl TranslationalSpringDamper {
    fn law(&self) -> SpringDamper {
        SpringDamper { k: self.k, d: self.d, backlash: self.backlash, transition: self.transition }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.law().validate(errors);
    }

    fn build(self, _errors: &mut ParamErrors) -> Option<Elastic<SpringDamper>> {
        Some(Elastic { law: self.law(), quantities: &TRANSLATION, start: self.x0 })
    }
}
