//! The nearest points of two convex sets, from their supports alone.
//!
//! Gilbert, Johnson and Keerthi, "A fast procedure for computing the distance between complex objects in
//! three-dimensional space", IEEE J. Robotics and Automation 4 (1988). The point of a simplex next to the origin is
//! found among all its corners, edges, faces and its inside, which needs no case to be argued away.

use nalgebra::{Matrix3, Vector3};

/// Most rounds. Round shapes need about ten.
const ROUNDS: usize = 100;

/// Relative error of the squared distance at which the search ends.
const ACCURACY: f64 = 1e-13;

/// Distance below which the sets overlap, m.
const TOUCHING: f64 = 1e-10;

/// A point of the difference of both sets, and the points that it comes from.
#[derive(Debug, Clone, Copy)]
struct Corner {
    difference: Vector3<f64>,
    a: Vector3<f64>,
    b: Vector3<f64>,
}

/// The nearest points of both sets and the way from the second to the first; `None` where the sets overlap. A support is the point farthest in a direction; both
/// in the same axes. `start` is any direction from the second to the first set.
pub(crate) fn nearest(
    support_a: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    support_b: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    start: Vector3<f64>,
) -> Option<([Vector3<f64>; 2], Vector3<f64>)> {
    let corner = |towards: &Vector3<f64>| {
        let (a, b) = (support_a(towards), support_b(&-towards));
        Corner { difference: a - b, a, b }
    };
    let first = corner(&-start);
    let mut simplex = vec![(first, 1.0)];
    let mut v = first.difference;
    for _ in 0..ROUNDS {
        if v.norm() < TOUCHING {
            return None;
        }
        let next = corner(&-v);
        // Nothing lies nearer than the plane through `next`, square to v.
        let gained = v.norm_squared() - v.dot(&next.difference);
        if gained <= ACCURACY * v.norm_squared() {
            break;
        }
        let corners: Vec<Corner> = simplex.iter().map(|(corner, _)| *corner).chain([next]).collect();
        let (reduced, nearer) = reduce(&corners);
        if nearer.norm_squared() >= v.norm_squared() {
            // Rounding: this is as near as it gets.
            break;
        }
        (simplex, v) = (reduced, nearer);
        if simplex.len() == 4 {
            return None;
        }
    }
    let sum = |of: fn(&Corner) -> Vector3<f64>| {
        simplex.iter().fold(Vector3::zeros(), |sum, (corner, weight)| sum + of(corner) * *weight)
    };
    Some(([sum(|corner| corner.a), sum(|corner| corner.b)], v))
}

/// The part of a simplex whose inside is next to the origin, with the weights of that point, and the point.
fn reduce(corners: &[Corner]) -> (Vec<(Corner, f64)>, Vector3<f64>) {
    let mut best: (Vec<(Corner, f64)>, Vector3<f64>) = (Vec::new(), Vector3::from_element(f64::INFINITY));
    for chosen in 1_u32..1 << corners.len() {
        let part: Vec<Corner> =
            (0..corners.len()).filter(|i| chosen & (1 << i) != 0).map(|i| corners[i]).collect();
        let Some((rest, point)) = projected(&part) else { continue };
        let first = 1.0 - rest.iter().sum::<f64>();
        let weights = std::iter::once(first).chain(rest);
        let weighted: Vec<(Corner, f64)> = part.into_iter().zip(weights).collect();
        let inside = weighted.iter().all(|(_, weight)| *weight >= 0.0);
        if inside && point.norm_squared() < best.1.norm_squared() {
            best = (weighted, point);
        }
    }
    best
}

/// The point next to the origin in the plane (line, space) through the corners, and the weights of all corners but the
/// first; `None` where the corners do not span one.
fn projected(corners: &[Corner]) -> Option<(Vec<f64>, Vector3<f64>)> {
    /// Sine at which edges count as lying in line.
    const FLAT: f64 = 1e-12;
    let origin = corners[0].difference;
    let edges: Vec<Vector3<f64>> = corners[1..].iter().map(|corner| corner.difference - origin).collect();
    match edges[..] {
        [] => Some((Vec::new(), origin)),
        [e] => {
            let square = Some(e.norm_squared()).filter(|square| *square > 0.0)?;
            let t = -origin.dot(&e) / square;
            Some((vec![t], origin + e * t))
        }
        [e, f] => {
            // By the normal: the products of the edges would lose twice the digits where they are nearly in line.
            let normal = e.cross(&f);
            let square = normal.norm_squared();
            if square.sqrt() <= FLAT * e.norm() * f.norm() {
                return None;
            }
            let point = normal * (normal.dot(&origin) / square);
            let inside = point - origin;
            Some((
                vec![inside.cross(&f).dot(&normal) / square, e.cross(&inside).dot(&normal) / square],
                point,
            ))
        }
        [e, f, g] => {
            let span = Matrix3::from_columns(&[e, f, g]);
            if span.determinant().abs() <= FLAT * e.norm() * f.norm() * g.norm() {
                return None;
            }
            let weights = span.try_inverse()? * -origin;
            Some((weights.as_slice().to_vec(), Vector3::zeros()))
        }
        _ => None,
    }
}
