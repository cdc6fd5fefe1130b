//! Orientation of spherical joints: four positions (w, x, y, z) whose direction alone counts.

use nalgebra::{Matrix3, Vector3};

/// The four numbers, scaled to length one; not finite where all are zero.
#[inline(always)]
pub(crate) fn normalized([w, x, y, z]: [f64; 4]) -> [f64; 4] {
    let length = (w * w + x * x + y * y + z * z).sqrt();
    [w, x, y, z].map(|e| e / length)
}

/// Rotation matrix: coordinates in the child to coordinates in the parent.
#[inline(always)]
pub(crate) fn rotation([w, x, y, z]: [f64; 4]) -> Matrix3<f64> {
    let s = 2.0 / (w * w + x * x + y * y + z * z);
    Matrix3::new(
        1.0 - s * (y * y + z * z),
        s * (x * y - w * z),
        s * (x * z + w * y),
        s * (x * y + w * z),
        1.0 - s * (x * x + z * z),
        s * (y * z - w * x),
        s * (x * z - w * y),
        s * (y * z + w * x),
        1.0 - s * (x * x + y * y),
    )
}

/// Hamilton's product `a b`: first b, then a.
#[inline(always)]
pub(crate) fn product([aw, ax, ay, az]: [f64; 4], [bw, bx, by, bz]: [f64; 4]) -> [f64; 4] {
    [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]
}

/// `dp/dt = p (0, omega) / 2` with the angular velocity in the child.
#[inline(always)]
pub(crate) fn derivative(p: [f64; 4], omega: &Vector3<f64>) -> [f64; 4] {
    product(p, [0.0, omega.x, omega.y, omega.z]).map(|e| 0.5 * e)
}

/// The rotation by a vector: its length is the angle, rad.
pub(crate) fn exponential(turn: &Vector3<f64>) -> [f64; 4] {
    let half = 0.5 * turn.norm();
    // sin(h) / (2 h), by its series where the quotient loses digits
    let scale = if half < 1e-4 { 0.5 - half * half / 12.0 } else { 0.5 * half.sin() / half };
    [half.cos(), scale * turn.x, scale * turn.y, scale * turn.z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::placement::Placement;

    const P: [f64; 4] = [0.4, -0.2, 0.7, 0.3];

    #[test]
    fn a_quaternion_of_any_length_is_a_rotation() {
        let r = rotation(P);
        assert!((r.transpose() * r - Matrix3::identity()).abs().max() < 1e-15);
        assert!((rotation(normalized(P)) - r).abs().max() < 1e-15);
        assert!((rotation(P.map(|e| -3.0 * e)) - r).abs().max() < 1e-15);
    }

    #[test]
    fn the_exponential_turns_about_the_axis() {
        for angle in [0.0, 1e-9, 1e-5, 0.3, 3.0] {
            let axis = Vector3::new(0.6, 0.0, 0.8);
            let expected = Placement::from_axis_angle([0.0; 3], axis, angle).rotation;
            assert!((rotation(exponential(&(axis * angle))) - expected).abs().max() < 1e-15);
        }
    }

    #[test]
    fn products_chain_rotations_and_derivatives_follow_them() {
        let b = exponential(&Vector3::new(0.1, -0.5, 0.3));
        assert!((rotation(product(P, b)) - rotation(P) * rotation(b)).abs().max() < 1e-15);
        let omega = Vector3::new(1.0, 2.0, -0.5);
        let step = 1e-6;
        let ahead = product(P, exponential(&(omega * step)));
        let slope = derivative(P, &omega);
        for i in 0..4 {
            assert!(((ahead[i] - P[i]) / step - slope[i]).abs() < 1e-5);
        }
    }
}
