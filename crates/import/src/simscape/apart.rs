//! How far two places are apart, in words.

use blocksim_multibody::Placement;
use nalgebra::Vector3;

/// Lengths and angles that differ by less are equal: CAD programs write nine digits or more. m and rad.
pub(super) const SAME: f64 = 1e-6;

/// How far two places are apart, in words; `None` if they are the same.
pub(super) fn apart(a: &Placement, b: &Placement) -> Option<String> {
    let gap = (a.translation - b.translation).norm();
    let turn = angle(&(a.rotation.transpose() * b.rotation));
    (gap > SAME || turn > SAME).then(|| distance(gap, turn))
}

pub(super) fn distance(gap: f64, turn: f64) -> String {
    match turn > SAME {
        true => format!("{:.3} mm and {:.4} deg", 1e3 * gap, turn.to_degrees()),
        false => format!("{:.3} mm", 1e3 * gap),
    }
}

/// Angle of a rotation, exact also where it is small: from the skew part.
fn angle(r: &nalgebra::Matrix3<f64>) -> f64 {
    let skew = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    (0.5 * skew.norm()).atan2(0.5 * (r.trace() - 1.0))
}
