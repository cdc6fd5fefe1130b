//! Orientations of balls: quaternions (w, x, y, z).

/// The quaternion of roll, pitch and yaw: `R = Rz(yaw) Ry(pitch) Rx(roll)`.
pub(crate) fn from_rpy(rpy: [f64; 3]) -> [f64; 4] {
    let [(sr, cr), (sp, cp), (sy, cy)] = rpy.map(|angle| (0.5 * angle).sin_cos());
    [
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    ]
}

/// Axis times angle, rad, at most half a turn.
pub(crate) fn rotation_vector([w, x, y, z]: [f64; 4]) -> [f64; 3] {
    let sine = (x * x + y * y + z * z).sqrt();
    // the same rotation the short way round
    let (w, sign) = if w < 0.0 { (-w, -1.0) } else { (w, 1.0) };
    let scale = if sine < 1e-9 { 2.0 } else { 2.0 * sine.atan2(w) / sine };
    [x, y, z].map(|e| sign * scale * e)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quaternion_has_the_rotation_vector_of_its_angle() {
        for angle in [0.0, 1e-12, 0.4, 3.0, -2.0] {
            let found = rotation_vector(from_rpy([0.0, angle, 0.0]));
            assert!((found[1] - angle).abs() < 1e-15 && found[0] == 0.0 && found[2] == 0.0, "{found:?}");
        }
        let [w, x, y, z] = from_rpy([0.3, -0.4, 1.2]);
        assert!((w * w + x * x + y * y + z * z - 1.0).abs() < 1e-15);
    }
}
