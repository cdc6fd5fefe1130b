//! Placements: where one frame is in another.

use crate::spatial::{Force, Motion};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::ops::Mul;

/// Where a child frame is in its parent frame, `T = [R p; 0 1]`: `x_parent = R x_child + p`.
///
/// ```
/// use blocksim_multibody::Placement;
/// use nalgebra::Vector3;
/// let lifted = Placement::from_translation([0.0, 0.0, 1.0]);
/// let turned = Placement::from_rpy([0.0, 0.0, 0.0], [0.0, 0.0, std::f64::consts::FRAC_PI_2]);
/// let point = (lifted * turned).point(&Vector3::x());
/// assert!((point - Vector3::new(0.0, 1.0, 1.0)).norm() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Rotation `R`: its columns are the axes of the child in parent coordinates.
    pub rotation: Matrix3<f64>,
    /// Translation `p`: the origin of the child in parent coordinates, m.
    pub translation: Vector3<f64>,
}

impl Placement {
    /// Both frames coincide.
    pub fn identity() -> Self {
        Placement { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// Parallel axes, the child's origin at `xyz` (m).
    pub fn from_translation(xyz: impl Into<Vector3<f64>>) -> Self {
        Placement { rotation: Matrix3::identity(), translation: xyz.into() }
    }

    /// The origin at `xyz` (m), rotated by roll, pitch and yaw (rad): `R = Rz(yaw) Ry(pitch) Rx(roll)`, as
    /// robot descriptions (URDF) write it.
    pub fn from_rpy(xyz: impl Into<Vector3<f64>>, rpy: [f64; 3]) -> Self {
        let rotation = Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]).into_inner();
        Placement { rotation, translation: xyz.into() }
    }

    /// The origin at `xyz` (m), rotated by `angle` (rad) about `axis`, whose length does not matter; an axis
    /// of length zero does not rotate.
    pub fn from_axis_angle(xyz: impl Into<Vector3<f64>>, axis: impl Into<Vector3<f64>>, angle: f64) -> Self {
        let axis = axis.into();
        let length = axis.norm();
        let rotation = match length > 0.0 {
            true => Rotation3::new(axis * (angle / length)).into_inner(),
            false => Matrix3::identity(),
        };
        Placement { rotation, translation: xyz.into() }
    }

    /// The placement of the parent in the child: `R⁻¹ = Rᵀ`, `p⁻¹ = -Rᵀ p`.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Placement { rotation, translation: -(rotation * self.translation) }
    }

    /// A point of the child in parent coordinates.
    pub fn point(&self, x: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * x + self.translation
    }

    /// A direction of the child in parent coordinates.
    pub fn direction(&self, x: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * x
    }

    /// Largest entry of `|RᵀR - 1|`, or infinity where `R` is a reflection or not finite.
    pub(crate) fn rotation_error(&self) -> f64 {
        let r = &self.rotation;
        let error = (r.transpose() * r - Matrix3::identity()).abs().max();
        if error.is_finite() && r.determinant() > 0.0 { error } else { f64::INFINITY }
    }

    /// A motion of the parent, in child coordinates at the child's origin: `ᶜXₚ m`.
    #[inline(always)]
    pub(crate) fn motion_to_child(&self, m: &Motion) -> Motion {
        Motion {
            angular: self.rotation.tr_mul(&m.angular),
            linear: self.rotation.tr_mul(&(m.linear + m.angular.cross(&self.translation))),
        }
    }

    /// A force on the child, in parent coordinates about the parent's origin: `ᵖX꜀* f`.
    #[inline(always)]
    pub(crate) fn force_to_parent(&self, f: &Force) -> Force {
        let linear = self.rotation * f.linear;
        Force { angular: self.rotation * f.angular + self.translation.cross(&linear), linear }
    }
}

impl Mul for Placement {
    type Output = Placement;

    /// The grandchild in the parent: `(R₁ R₂, R₁ p₂ + p₁)`.
    #[inline(always)]
    fn mul(self, inner: Placement) -> Placement {
        Placement {
            rotation: self.rotation * inner.rotation,
            translation: self.rotation * inner.translation + self.translation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn sample() -> Placement {
        Placement::from_rpy([0.3, -0.2, 0.9], [0.4, -1.0, 2.2])
    }

    #[test]
    fn a_placement_times_its_inverse_is_the_identity() {
        let one = sample() * sample().inverse();
        assert!((one.rotation - Matrix3::identity()).abs().max() < 1e-15);
        assert!(one.translation.norm() < 1e-15);
    }

    #[test]
    fn roll_pitch_and_yaw_are_applied_about_fixed_axes_in_that_order() {
        let axis = |axis, angle| Placement::from_axis_angle([0.0; 3], axis, angle);
        let expected = axis([0.0, 0.0, 1.0], 2.2) * axis([0.0, 3.0, 0.0], -1.0) * axis([2.0, 0.0, 0.0], 0.4);
        assert!((sample().rotation - expected.rotation).abs().max() < 1e-15);
        let pitched = Placement::from_rpy([0.0; 3], [0.0, FRAC_PI_2, 0.0]);
        assert!((pitched.direction(&Vector3::z()) - Vector3::x()).norm() < 1e-15);
    }

    #[test]
    fn power_does_not_depend_on_the_frame() {
        let motion = Motion { angular: [0.1, 0.7, -0.4].into(), linear: [1.0, -2.0, 0.5].into() };
        let force = Force { angular: [3.0, 1.0, -2.0].into(), linear: [0.2, 0.6, 5.0].into() };
        let in_child = sample().motion_to_child(&motion).dot(&force);
        let in_parent = motion.dot(&sample().force_to_parent(&force));
        assert!((in_child - in_parent).abs() < 1e-14);
    }

    #[test]
    fn a_reflection_a_shear_and_not_a_number_are_no_rotations() {
        assert!(sample().rotation_error() < 1e-15);
        let off = |rotation| Placement { rotation, ..sample() }.rotation_error();
        assert!(off(Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0))).is_infinite());
        assert!(off(Matrix3::from_element(f64::NAN)).is_infinite());
        let shear = Matrix3::new(1.0, 0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
        assert!((off(shear) - 0.1).abs() < 1e-15);
    }
}
