use blocksim_block::prelude::*;

use crate::mechanics::contact::SpringDamper;
use crate::mechanics::elastic::Elastic;
use crate::mechanics::quantities::ROTATION;

/// Torsion spring between two turning parts.
///
/// $$ \tau = k \varphi, \qquad \dot\varphi = w_r - w_c $$
///
/// The deflection is a state. With a very stiff spring two parts turn almost as one; where that is all it is
/// for, connect them rigidly instead: that costs nothing and is exact.
///
/// ```ron
/// RotationalSpring(k: "10 N*m/rad")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Spring, builds = Elastic<SpringDamper>)]
pub struct RotationalSpring {
    /// Stiffness; zero is allowed.
    #[block(unit = "N*m/rad", not_negative)]
    pub k: f64,
    /// Deflection at the start.
    #[block(unit = "rad", finite, default = 0.0)]
    pub phi0: f64,
}

impl RotationalSpring {
    fn build(self, _errors: &mut ParamErrors) -> Option<Elastic<SpringDamper>> {
        Some(Elastic { law: SpringDamper::spring(self.k), quantities: &ROTATION, start: self.phi0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_torque_follows_the_deflection_and_the_deflection_the_speed() {
        let spring = RotationalSpring { k: 10.0, phi0: 0.2 }.built();
        assert_eq!(spring.part(&Given::nothing()).states[0].initial, 0.2);
        let (mut tau, mut dx) = ([Torque::default()], [0.0]);
        let c = Seen { x: &[0.3], speed: &[-4.0], ..law() }.loaded();
        spring.torques(&c, &mut tau);
        Component::derivatives(&spring, &c, &mut dx);
        assert_eq!((tau[0].value, dx[0]), (3.0, -4.0));
    }

    #[test]
    fn a_negative_stiffness_is_refused() {
        assert_eq!(RotationalSpring { k: -1.0, phi0: 0.0 }.errors()[0].param, "k");
    }
}
