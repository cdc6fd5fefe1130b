//! Orientations: rotation matrices, ZYX Euler angles, unit quaternions and rotation vectors.

use crate::quaternion;
use nalgebra::{Matrix3, Vector3};
use std::error::Error;
use std::fmt;

/// Where cos β is below this, the angles α and γ turn about the same line.
const LOCK: f64 = 1e-9;

/// ZYX Euler angles `R = Rz(α) Ry'(β) Rx''(γ)`, rad: first about z, then about the new y, then about the new x.
///
/// At β = ±90° (gimbal lock) only α ∓ γ matters; [`EulerZyx::from_rotation`] then gives γ = 0 and puts all of the turn
/// into α, and [`EulerZyx::is_locked`] says so. The rotation is right all the same.
///
/// ```
/// use blocksim_multibody::EulerZyx;
/// let angles = EulerZyx { alpha: 0.3, beta: -0.4, gamma: 2.0 };
/// let again = EulerZyx::from_rotation(&angles.rotation());
/// assert!((again.gamma - 2.0).abs() < 1e-15 && !again.is_locked());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EulerZyx {
    /// α about z, in (-π, π] where it comes from a rotation.
    pub alpha: f64,
    /// β about the new y, in [-π/2, π/2] where it comes from a rotation.
    pub beta: f64,
    /// γ about the new x, in (-π, π] where it comes from a rotation.
    pub gamma: f64,
}

impl EulerZyx {
    /// The rotation matrix.
    pub fn rotation(&self) -> Matrix3<f64> {
        let ((sa, ca), (sb, cb), (sg, cg)) =
            (self.alpha.sin_cos(), self.beta.sin_cos(), self.gamma.sin_cos());
        Matrix3::new(
            ca * cb,
            ca * sb * sg - sa * cg,
            ca * sb * cg + sa * sg,
            sa * cb,
            sa * sb * sg + ca * cg,
            sa * sb * cg - ca * sg,
            -sb,
            cb * sg,
            cb * cg,
        )
    }

    /// The angles of a rotation matrix.
    pub fn from_rotation(r: &Matrix3<f64>) -> Self {
        let cos_beta = r[(0, 0)].hypot(r[(1, 0)]);
        let alpha = match cos_beta < LOCK {
            true => (-r[(0, 1)]).atan2(r[(1, 1)]),
            false => r[(1, 0)].atan2(r[(0, 0)]),
        };
        // Rz(-α) R = Ry(β) Rx(γ), whose second row is (0, cos γ, -sin γ): near the lock γ makes good what α lacks
        let (sin, cos) = alpha.sin_cos();
        let gamma = (sin * r[(0, 2)] - cos * r[(1, 2)]).atan2(cos * r[(1, 1)] - sin * r[(0, 1)]);
        EulerZyx { alpha, beta: (-r[(2, 0)]).atan2(cos_beta), gamma }
    }

    /// Whether β is ±90°, so that α and γ are not determined one by one.
    pub fn is_locked(&self) -> bool {
        self.beta.cos().abs() < LOCK
    }
}

/// Why numbers are no orientation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OrientationError {
    /// A quaternion whose entries are all zero, or one of them not finite.
    Quaternion {
        /// The numbers given: w, x, y, z.
        value: [f64; 4],
    },
}

impl fmt::Display for OrientationError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let OrientationError::Quaternion { value: [w, x, y, z] } = self;
        write!(
            f,
            "({w}, {x}, {y}, {z}) is no orientation: give four finite numbers (w, x, y, z), not all zero"
        )
    }
}

impl Error for OrientationError {}

/// The rotation matrix of a quaternion (w, x, y, z), whose length does not matter.
///
/// # Errors
/// All numbers zero, or one not finite.
pub fn rotation_of_quaternion(value: [f64; 4]) -> Result<Matrix3<f64>, OrientationError> {
    // scaled first, so that squares neither vanish nor overflow
    let largest = value.iter().fold(0.0_f64, |m, e| if e.is_nan() { f64::NAN } else { m.max(e.abs()) });
    match largest > 0.0 && largest.is_finite() && value.iter().all(|e| e.is_finite()) {
        true => Ok(quaternion::rotation(value.map(|e| e / largest))),
        false => Err(OrientationError::Quaternion { value }),
    }
}

/// The unit quaternion (w, x, y, z) of a rotation matrix, the one of the two with w ≥ 0.
///
/// Source: S. W. Shepperd, Quaternion from rotation matrix, J. Guidance and Control 1 (1978).
pub fn quaternion_of_rotation(r: &Matrix3<f64>) -> [f64; 4] {
    let trace = r.trace();
    // the largest of the four, from which the others follow without loss of digits
    let candidates = [trace, r[(0, 0)], r[(1, 1)], r[(2, 2)]];
    let largest = (1..4).fold(0, |best, i| if candidates[i] > candidates[best] { i } else { best });
    let (x, y, z) = (r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let (xy, zx, yz) = (r[(0, 1)] + r[(1, 0)], r[(0, 2)] + r[(2, 0)], r[(1, 2)] + r[(2, 1)]);
    let square = 1.0 + 2.0 * candidates[largest] - trace;
    let q = match largest {
        0 => [1.0 + trace, x, y, z],
        1 => [x, square, xy, zx],
        2 => [y, xy, square, yz],
        _ => [z, zx, yz, square],
    };
    let q = quaternion::normalized(q);
    if q[0] < 0.0 { q.map(|e| -e) } else { q }
}

/// The rotation vector of a rotation matrix: along its axis, as long as its angle in [0, π] (rad).
pub fn rotation_vector(r: &Matrix3<f64>) -> Vector3<f64> {
    let [w, x, y, z] = quaternion_of_rotation(r);
    let v = Vector3::new(x, y, z);
    let sin = v.norm();
    // 2 atan(s / w) / s, by its limit where s vanishes
    if sin < 1e-12 { v * 2.0 } else { v * (2.0 * sin.atan2(w) / sin) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::Placement;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn samples() -> impl Iterator<Item = EulerZyx> {
        let steps = |n: i32, top: f64| (-n..=n).map(move |i| f64::from(i) / f64::from(n) * top);
        steps(6, 3.1).flat_map(move |alpha| {
            steps(8, FRAC_PI_2)
                .flat_map(move |beta| steps(6, 3.1).map(move |gamma| EulerZyx { alpha, beta, gamma }))
        })
    }

    fn apart(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
        (a - b).abs().max()
    }

    #[test]
    fn euler_angles_turn_about_z_then_y_then_x() {
        for e in samples() {
            let expected = Placement::from_rpy([0.0; 3], [e.gamma, e.beta, e.alpha]).rotation;
            assert!(apart(&e.rotation(), &expected) < 1e-15);
        }
    }

    #[test]
    fn euler_angles_go_to_a_matrix_and_back() {
        for e in samples() {
            let again = EulerZyx::from_rotation(&e.rotation());
            assert!(apart(&again.rotation(), &e.rotation()) < 2e-15);
            assert_eq!(again.is_locked(), e.is_locked());
            if e.is_locked() {
                assert!(again.gamma.abs() < 1e-15);
            } else {
                let worst = (again.alpha - e.alpha)
                    .abs()
                    .max((again.beta - e.beta).abs())
                    .max((again.gamma - e.gamma).abs());
                assert!(worst < 1e-14, "{e:?} {again:?}");
            }
        }
    }

    #[test]
    fn near_the_gimbal_lock_the_rotation_keeps_all_digits() {
        for exponent in 1..16 {
            for sign in [-1.0, 1.0] {
                let beta = sign * (FRAC_PI_2 - 10f64.powi(-exponent));
                let e = EulerZyx { alpha: 0.7, beta, gamma: -1.2 };
                let again = EulerZyx::from_rotation(&e.rotation());
                // at 1e-10 the angles count as locked: the rotation is right to that share
                assert!(apart(&again.rotation(), &e.rotation()) < 3e-10);
                assert!(exponent > 8 || apart(&again.rotation(), &e.rotation()) < 1e-15);
            }
        }
    }

    #[test]
    fn quaternions_go_to_a_matrix_and_back() -> Result<(), OrientationError> {
        for e in samples() {
            let r = e.rotation();
            let q = quaternion_of_rotation(&r);
            assert!(q[0] >= 0.0 && (q.iter().map(|e| e * e).sum::<f64>() - 1.0).abs() < 1e-14);
            assert!(apart(&rotation_of_quaternion(q)?, &r) < 1e-15);
            assert!(apart(&rotation_of_quaternion(q.map(|e| -1e-200 * e))?, &r) < 1e-15);
            let turn = quaternion::exponential(&rotation_vector(&r));
            assert!(apart(&quaternion::rotation(turn), &r) < 2e-15);
        }
        Ok(())
    }

    #[test]
    fn the_rotation_vector_is_right_from_nothing_to_a_half_turn() {
        let axis = Vector3::new(0.6, 0.0, -0.8);
        for angle in [0.0, 1e-14, 1e-9, 1e-3, 1.0, 3.0, PI - 1e-9, PI] {
            let r = Placement::from_axis_angle([0.0; 3], axis, angle).rotation;
            let v = rotation_vector(&r);
            // at a half turn the axis may point either way
            assert!((v - axis * angle).norm().min((v + axis * angle).norm()) < 1e-15, "{angle}: {v}");
        }
    }

    #[test]
    fn numbers_that_are_no_quaternion_are_refused() {
        for value in [[0.0; 4], [f64::NAN, 0.0, 0.0, 1.0], [1.0, f64::INFINITY, 0.0, 0.0]] {
            let error = rotation_of_quaternion(value).map_err(|e| e.to_string()).unwrap_err();
            assert!(error.contains("not all zero"), "{error}");
        }
    }
}
