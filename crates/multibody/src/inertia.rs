//! Mass, centre of mass and inertia of a rigid body, as data sheets and CAD programs state them.

use crate::error::InertiaError;
use crate::placement::Placement;
use crate::spatial_inertia::SpatialInertia;
use crate::symmetric::Symmetric;
use nalgebra::{Matrix3, Vector3};
use std::ops::Add;

/// How far, relative to the trace, an inertia may miss the triangle inequality and symmetry: published
/// tensors are rounded to a few digits, and a thin plate sits exactly on the bound.
const TOLERANCE: f64 = 1e-4;

/// Mass properties of a rigid body in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the frame, m.
    pub com: Vector3<f64>,
    /// Inertia tensor about the centre of mass, along the axes of the frame, kg m².
    pub about_com: Matrix3<f64>,
}

impl Inertia {
    /// Checked mass properties: mass in kg, centre of mass in m, tensor about the centre of mass in kg m².
    ///
    /// # Errors
    /// As [`Inertia::check`].
    pub fn new(
        mass: f64,
        com: impl Into<Vector3<f64>>,
        about_com: Matrix3<f64>,
    ) -> Result<Self, InertiaError> {
        let inertia = Inertia { mass, com: com.into(), about_com };
        inertia.check()?;
        Ok(inertia)
    }

    /// Checked mass properties from moments (Ixx, Iyy, Izz) and products (Iyz, Izx, Ixy), kg m².
    ///
    /// Products are elements of the tensor, `Iyz = -∫ y z dm`.
    ///
    /// # Errors
    /// As [`Inertia::check`].
    pub fn from_moments(
        mass: f64,
        com: impl Into<Vector3<f64>>,
        moments: [f64; 3],
        products: [f64; 3],
    ) -> Result<Self, InertiaError> {
        let [xx, yy, zz] = moments;
        let [yz, zx, xy] = products;
        Inertia::new(mass, com, Symmetric { xx, yy, zz, yz, zx, xy }.full())
    }

    /// No mass: a frame that only carries others.
    pub fn zero() -> Self {
        Inertia { mass: 0.0, com: Vector3::zeros(), about_com: Matrix3::zeros() }
    }

    /// A point mass (kg) at `com` (m).
    ///
    /// # Errors
    /// As [`Inertia::check`].
    pub fn point(mass: f64, com: impl Into<Vector3<f64>>) -> Result<Self, InertiaError> {
        Inertia::new(mass, com, Matrix3::zeros())
    }

    /// Whether a rigid body can have these properties.
    ///
    /// # Errors
    /// Numbers that are not finite, a negative mass, a tensor that is not symmetric, or principal moments
    /// that break `Iₐ + I_b ≥ I_c` (which also rules out negative moments); tolerance 1e-4 of the trace.
    pub fn check(&self) -> Result<(), InertiaError> {
        let numbers = self.com.iter().chain(self.about_com.iter());
        if !self.mass.is_finite() || numbers.into_iter().any(|x| !x.is_finite()) {
            return Err(InertiaError::NotFinite);
        }
        if self.mass < 0.0 {
            return Err(InertiaError::NegativeMass { mass: self.mass });
        }
        let allowed = TOLERANCE * self.about_com.trace().abs();
        let asymmetry = (self.about_com - self.about_com.transpose()).abs().max();
        if asymmetry > allowed {
            return Err(InertiaError::NotSymmetric { difference: asymmetry });
        }
        let mut principal: [f64; 3] = self.about_com.symmetric_eigenvalues().into();
        principal.sort_by(f64::total_cmp);
        if principal[0] + principal[1] - principal[2] < -allowed {
            return Err(InertiaError::Triangle { principal });
        }
        Ok(())
    }

    /// The same body described in the frame in which its own frame is placed at `placement`.
    pub fn placed(&self, placement: &Placement) -> Self {
        let r = &placement.rotation;
        Inertia {
            mass: self.mass,
            com: placement.point(&self.com),
            about_com: r * self.about_com * r.transpose(),
        }
    }

    /// About the frame's origin, in the form that the algorithms add up.
    pub(crate) fn spatial(&self) -> SpatialInertia {
        let c = &self.com;
        let about_origin = self.about_com + steiner(self.mass, c);
        SpatialInertia {
            mass: self.mass,
            moment: c * self.mass,
            rotational: Symmetric::from_upper(&about_origin),
        }
    }
}

/// Parallel axis theorem: `m (c·c 1 - c cᵀ)`.
fn steiner(mass: f64, c: &Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * mass
}

impl Add for Inertia {
    type Output = Inertia;

    /// Two bodies in the same frame, rigidly joined.
    fn add(self, b: Inertia) -> Inertia {
        let mass = self.mass + b.mass;
        let com = match mass > 0.0 {
            true => (self.com * self.mass + b.com * b.mass) / mass,
            false => Vector3::zeros(),
        };
        let about_com = self.about_com
            + steiner(self.mass, &(self.com - com))
            + b.about_com
            + steiner(b.mass, &(b.com - com));
        Inertia { mass, com, about_com }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_bodies_are_refused_with_the_reason() {
        let of = |mass, moments| Inertia::from_moments(mass, [0.0; 3], moments, [0.0; 3]).err();
        assert_eq!(of(-2.0, [1.0; 3]), Some(InertiaError::NegativeMass { mass: -2.0 }));
        assert_eq!(of(f64::NAN, [1.0; 3]), Some(InertiaError::NotFinite));
        assert_eq!(of(1.0, [1.0, 3.0, 1.0]), Some(InertiaError::Triangle { principal: [1.0, 1.0, 3.0] }));
        assert!(matches!(of(1.0, [-1.0, -1.0, -1.0]), Some(InertiaError::Triangle { .. })));
        let crooked = Matrix3::new(1.0, 0.2, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        let error = Inertia::new(1.0, [0.0; 3], crooked).err();
        assert_eq!(error, Some(InertiaError::NotSymmetric { difference: 0.2 }));
    }

    #[test]
    fn products_too_large_for_the_moments_are_refused() {
        let error = Inertia::from_moments(1.0, [0.0; 3], [1.0; 3], [0.0, 0.0, 0.6]).err();
        let text = error.map(|e| e.to_string()).unwrap_or_default();
        assert!(text.contains("0.400000, 1.000000 and 1.600000"), "{text}");
    }

    #[test]
    fn plates_rods_points_and_rotors_without_mass_are_possible() {
        for (mass, moments) in [
            (1.0, [1.0, 1.0, 2.0]),
            (1.0, [0.0, 1.0, 1.0]),
            (1.0, [0.0; 3]),
            (0.0, [0.5, 0.5, 1.0]),
            // a plate from a data sheet with four digits
            (1.0, [0.3333, 0.3333, 0.6667]),
        ] {
            assert!(Inertia::from_moments(mass, [0.0; 3], moments, [0.0; 3]).is_ok(), "{moments:?}");
        }
    }

    #[test]
    fn two_half_boxes_make_a_box() -> Result<(), InertiaError> {
        // edges a, b, c along x, y, z
        let cuboid = |mass: f64, [a, b, c]: [f64; 3], com: [f64; 3]| {
            let moment = |u: f64, v: f64| mass / 12.0 * (u * u + v * v);
            Inertia::from_moments(mass, com, [moment(b, c), moment(a, c), moment(a, b)], [0.0; 3])
        };
        let whole = cuboid(6.0, [2.0, 1.0, 0.5], [0.0; 3])?;
        let left = cuboid(3.0, [1.0, 1.0, 0.5], [-0.5, 0.0, 0.0])?;
        let right = cuboid(3.0, [1.0, 1.0, 0.5], [0.5, 0.0, 0.0])?;
        let sum = left + right;
        assert!((sum.com - whole.com).norm() < 1e-15);
        assert!((sum.about_com - whole.about_com).abs().max() < 1e-15);
        assert_eq!(sum.mass, whole.mass);
        Ok(())
    }
}
