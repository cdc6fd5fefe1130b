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

/// The unit quaternion with w >= 0 of a rotation matrix, row by row, from its largest element (S. W. Shepperd,
/// Quaternion from rotation matrix, J. Guidance and Control 1 (1978)).
pub(crate) fn from_matrix(r: &[[f64; 3]; 3]) -> [f64; 4] {
    let trace = r[0][0] + r[1][1] + r[2][2];
    let diagonal = [trace, r[0][0], r[1][1], r[2][2]];
    let k = (1..4).fold(0, |best, i| if diagonal[i] > diagonal[best] { i } else { best });
    // 4 p_k p, of which the element k is a sum of squares
    let own = 1.0 + 2.0 * diagonal[k] - trace;
    let (a, b, c) = (r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]);
    let (xy, yz, zx) = (r[0][1] + r[1][0], r[1][2] + r[2][1], r[2][0] + r[0][2]);
    let p = match k {
        0 => [own, a, b, c],
        1 => [a, own, xy, zx],
        2 => [b, xy, own, yz],
        _ => [c, zx, yz, own],
    };
    let length = p.iter().map(|e| e * e).sum::<f64>().sqrt();
    let sign = if p[0] < 0.0 { -1.0 } else { 1.0 };
    p.map(|e| sign * e / length)
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

    #[test]
    fn a_rotation_matrix_has_the_quaternion_of_its_angles() {
        for rpy in [[0.3, -0.4, 1.2], [3.0, 0.1, 0.2], [0.1, 3.0, 0.2], [0.1, 0.2, -3.1], [0.0; 3]] {
            let p = from_rpy(rpy);
            let [w, x, y, z] = p;
            let matrix = [
                [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
                [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
                [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
            ];
            let sign = if w < 0.0 { -1.0 } else { 1.0 };
            let found = from_matrix(&matrix);
            (0..4).for_each(|k| assert!((found[k] - sign * p[k]).abs() < 1e-14, "{rpy:?}: {found:?}"));
        }
    }
}
