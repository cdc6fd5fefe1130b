//! Spatial vectors and their cross products.

use nalgebra::Vector3;
use std::ops::{Add, AddAssign};

/// A spatial motion vector (velocity or acceleration), angular part first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// ω in rad/s, or its derivative in rad/s².
    pub angular: Vector3<f64>,
    /// Velocity of the frame's origin in m/s, or the linear part of the acceleration in m/s².
    pub linear: Vector3<f64>,
}

/// A spatial force vector, angular part first.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Force {
    /// Moment about the frame's origin, N m.
    pub angular: Vector3<f64>,
    /// Force, N.
    pub linear: Vector3<f64>,
}

impl Motion {
    /// Featherstone (2.33): `m × b` = (ω × ω_b, ω × v_b + v × ω_b).
    #[inline(always)]
    pub fn cross(&self, b: &Motion) -> Motion {
        Motion {
            angular: self.angular.cross(&b.angular),
            linear: self.angular.cross(&b.linear) + self.linear.cross(&b.angular),
        }
    }

    /// Featherstone (2.34): `m ×* f` = (ω × n + v × f, ω × f).
    #[inline(always)]
    pub fn cross_force(&self, f: &Force) -> Force {
        Force {
            angular: self.angular.cross(&f.angular) + self.linear.cross(&f.linear),
            linear: self.angular.cross(&f.linear),
        }
    }

    /// Power `m · f` of a force, W.
    #[inline(always)]
    pub fn dot(&self, f: &Force) -> f64 {
        self.angular.dot(&f.angular) + self.linear.dot(&f.linear)
    }
}

impl Add for Motion {
    type Output = Motion;

    #[inline(always)]
    fn add(self, b: Motion) -> Motion {
        Motion { angular: self.angular + b.angular, linear: self.linear + b.linear }
    }
}

impl Add for Force {
    type Output = Force;

    #[inline(always)]
    fn add(self, b: Force) -> Force {
        Force { angular: self.angular + b.angular, linear: self.linear + b.linear }
    }
}

impl AddAssign for Force {
    #[inline(always)]
    fn add_assign(&mut self, b: Force) {
        *self = *self + b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const M: Motion = Motion { angular: Vector3::new(0.1, 0.7, -0.4), linear: Vector3::new(1.0, -2.0, 0.5) };
    const B: Motion = Motion { angular: Vector3::new(-0.9, 0.2, 0.3), linear: Vector3::new(0.4, 0.8, -1.5) };
    const F: Force = Force { angular: Vector3::new(3.0, 1.0, -2.0), linear: Vector3::new(0.2, 0.6, 5.0) };

    #[test]
    fn the_cross_products_of_motions_and_forces_are_adjoint() {
        // (m × b) · f = -b · (m ×* f)
        assert!((M.cross(&B).dot(&F) + B.dot(&M.cross_force(&F))).abs() < 1e-14);
        assert_eq!(M.cross(&M), Motion::default());
    }
}
