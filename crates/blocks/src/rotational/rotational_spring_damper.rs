use blocksim_block::prelude::*;

use crate::mechanics::contact::SpringDamper;
use crate::mechanics::elastic::Elastic;
use crate::mechanics::quantities::ROTATION;

/// Elastic shaft: a torsion spring and a damper side by side, with backlash if there is any.
///
/// $$ \tau = k \varphi + d w, \qquad \dot\varphi = w = w_r - w_c $$
///
/// With a backlash $b$, the whole play from flank to flank, nothing is transmitted while $|\varphi| < b/2$.
/// Beyond it the flanks are pressed together by $\delta = |\varphi| - b/2$ and
///
/// $$ \tau = \operatorname{sgn}(\varphi)\, \max\bigl(0,\; s\,(k \delta + d \dot\delta)\bigr) $$
///
/// Flanks push and never pull. The contact sets in at once ($s = 1$), or over the width `transition` with
/// $s = 3 x^2 - 2 x^3$, $x = \min(\delta / \mathtt{transition}, 1)$, which solvers with step size control like
/// better. Without backlash the parts are joined, and the torque acts in both directions.
///
/// ```ron
/// RotationalSpringDamper(k: "2e4 N*m/rad", d: "15 N*m*s/rad", backlash: "0.02 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = SpringDamper, builds = Elastic<SpringDamper>)]
pub struct RotationalSpringDamper {
    /// Stiffness; zero is allowed.
    #[block(unit = "N*m/rad", not_negative)]
    pub k: f64,
    /// Damping coefficient; zero is allowed.
    #[block(unit = "N*m*s/rad", not_negative)]
    pub d: f64,
    /// Play between the flanks, from one contact to the other.
    #[block(unit = "rad", not_negative, default = 0.0)]
    pub backlash: f64,
    /// Width over which the contact sets in; with backlash only.
    #[block(unit = "rad", not_negative, default = 0.0)]
    pub transition: f64,
    /// Deflection at the start; zero is the middle of the play.
    #[block(unit = "rad", finite, default = 0.0)]
    pub phi0: f64,
}

impl RotationalSpringDamper {
    fn law(&self) -> SpringDamper {
        SpringDamper { k: self.k, d: self.d, backlash: self.backlash, transition: self.transition }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.law().validate(errors);
    }

    fn build(self, _errors: &mut ParamErrors) -> Option<Elastic<SpringDamper>> {
        Some(Elastic { law: self.law(), quantities: &ROTATION, start: self.phi0 })
    }
}
