//! The spatial inertia of a rigid body.

use crate::placement::Placement;
use crate::spatial::{Force, Motion};
use crate::symmetric::Symmetric;
use nalgebra::Vector3;
use std::ops::AddAssign;

/// Inertia of a rigid body about the origin of its frame: ten numbers that add up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct SpatialInertia {
    /// Mass m, kg.
    pub mass: f64,
    /// First moment h = m c, kg m.
    pub moment: Vector3<f64>,
    /// Rotational inertia about the origin, kg m².
    pub rotational: Symmetric,
}

impl SpatialInertia {
    /// Featherstone (2.63): `I m` = (Ī ω + h × v, m v - h × ω).
    #[inline(always)]
    pub fn times(&self, m: &Motion) -> Force {
        Force {
            angular: self.rotational.times(&m.angular) + self.moment.cross(&m.linear),
            linear: m.linear * self.mass - self.moment.cross(&m.angular),
        }
    }

    /// The same body seen from the parent: `ᵖX꜀* I ᶜXₚ`, Featherstone (2.66).
    #[inline(always)]
    pub fn in_parent(&self, x: &Placement) -> SpatialInertia {
        // u = R h,  h' = u + m p
        let p = &x.translation;
        let u = x.rotation * self.moment;
        let moment = u + p * self.mass;
        // Ī' = R Ī Rᵀ + p·(u + h') 1 - (p uᵀ + h' pᵀ)
        let r = self.rotational.rotated(&x.rotation);
        let trace = p.dot(&(u + moment));
        let rotational = Symmetric {
            xx: r.xx + trace - (p.x * u.x + moment.x * p.x),
            yy: r.yy + trace - (p.y * u.y + moment.y * p.y),
            zz: r.zz + trace - (p.z * u.z + moment.z * p.z),
            yz: r.yz - (p.y * u.z + moment.y * p.z),
            zx: r.zx - (p.z * u.x + moment.z * p.x),
            xy: r.xy - (p.x * u.y + moment.x * p.y),
        };
        SpatialInertia { mass: self.mass, moment, rotational }
    }
}

impl AddAssign for SpatialInertia {
    #[inline(always)]
    fn add_assign(&mut self, b: SpatialInertia) {
        self.mass += b.mass;
        self.moment += b.moment;
        self.rotational += b.rotational;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inertia::Inertia;

    const M: Motion = Motion { angular: Vector3::new(0.1, 0.7, -0.4), linear: Vector3::new(1.0, -2.0, 0.5) };

    #[test]
    fn an_inertia_acts_alike_in_child_and_parent() -> Result<(), Box<dyn std::error::Error>> {
        let body = Inertia::from_moments(2.0, [0.3, -0.1, 0.6], [0.5, 0.6, 0.7], [0.02, -0.03, 0.05])?;
        let x = Placement::from_rpy([0.3, -0.2, 0.9], [0.4, -1.0, 2.2]);
        let through_child = x.force_to_parent(&body.spatial().times(&x.motion_to_child(&M)));
        for in_parent in [body.spatial().in_parent(&x), body.placed(&x).spatial()] {
            let direct = in_parent.times(&M);
            assert!((direct.angular - through_child.angular).norm() < 1e-14);
            assert!((direct.linear - through_child.linear).norm() < 1e-14);
        }
        Ok(())
    }

    #[test]
    fn a_moving_body_has_the_energy_of_its_centre_of_mass_and_its_rotation()
    -> Result<(), Box<dyn std::error::Error>> {
        let body = Inertia::from_moments(2.0, [0.3, -0.1, 0.6], [0.5, 0.6, 0.7], [0.0; 3])?;
        let speed = M.linear + M.angular.cross(&body.com);
        let turning = M.angular.dot(&(body.about_com * M.angular));
        let expected = body.mass * speed.norm_squared() + turning;
        assert!((M.dot(&body.spatial().times(&M)) - expected).abs() < 1e-14);
        Ok(())
    }
}
