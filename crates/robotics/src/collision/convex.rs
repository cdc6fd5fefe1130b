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

/// At most four corners, of which every point inside is a mean.
#[derive(Debug, Clone, Copy)]
struct Simplex {
    corners: [Corner; 4],
    /// Of the point next to the origin; they sum to one.
    weights: [f64; 4],
    len: usize,
}

impl Simplex {
    fn of(corner: Corner) -> Self {
        Simplex { corners: [corner; 4], weights: [1.0, 0.0, 0.0, 0.0], len: 1 }
    }

    /// The part of it whose inside is next to the origin, with the weights of that point, and the point; `None` where nothing
    /// of it spans anything.
    fn reduced(&self) -> Option<(Simplex, Vector3<f64>)> {
        let mut best: Option<([f64; 3], Vector3<f64>, u32)> = None;
        for chosen in 1_u32..1 << self.len {
            let mut part = [self.corners[0].difference; 4];
            let len = self.chosen(chosen).zip(&mut part).map(|(corner, to)| *to = corner.difference).count();
            let Some((weights, point)) = projected(&part[..len]) else { continue };
            let nearer = best.is_none_or(|(_, nearest, _)| point.norm_squared() < nearest.norm_squared());
            let rest = &weights[..len - 1];
            if nearer && first_weight(rest) >= 0.0 && rest.iter().all(|weight| *weight >= 0.0) {
                best = Some((weights, point, chosen));
            }
        }
        let (weights, point, chosen) = best?;
        let mut part = Simplex { len: 0, ..*self };
        for corner in self.chosen(chosen) {
            part.corners[part.len] = *corner;
            part.len += 1;
        }
        part.weights[0] = first_weight(&weights[..part.len - 1]);
        part.weights[1..].copy_from_slice(&weights);
        Some((part, point))
    }

    /// The corners whose bits are set.
    fn chosen(&self, bits: u32) -> impl Iterator<Item = &Corner> {
        let corners = self.corners[..self.len].iter().enumerate();
        corners.filter(move |(i, _)| bits & (1 << i) != 0).map(|(_, corner)| corner)
    }

    fn sum(&self, of: fn(&Corner) -> Vector3<f64>) -> Vector3<f64> {
        let weighted = self.corners.iter().zip(self.weights).take(self.len);
        weighted.fold(Vector3::zeros(), |sum, (corner, weight)| sum + of(corner) * weight)
    }
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
    let mut simplex = Simplex::of(corner(&-start));
    let mut v = simplex.corners[0].difference;
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
        let mut wider = simplex;
        wider.corners[simplex.len] = next;
        wider.len += 1;
        let Some((reduced, nearer)) = wider.reduced() else { break };
        if nearer.norm_squared() >= v.norm_squared() {
            // Rounding: this is as near as it gets.
            break;
        }
        (simplex, v) = (reduced, nearer);
        if simplex.len == 4 {
            return None;
        }
    }
    Some(([simplex.sum(|corner| corner.a), simplex.sum(|corner| corner.b)], v))
}

fn first_weight(rest: &[f64]) -> f64 {
    1.0 - rest.iter().sum::<f64>()
}

/// The point next to the origin in the plane (line, space) through the corners, and the weights of all corners but the
/// first; `None` where the corners do not span one.
fn projected(corners: &[Vector3<f64>]) -> Option<([f64; 3], Vector3<f64>)> {
    /// Sine at which edges count as lying in line.
    const FLAT: f64 = 1e-12;
    let origin = corners[0];
    let edge = |i: usize| corners[i] - origin;
    match corners.len() {
        1 => Some(([0.0; 3], origin)),
        2 => {
            let e = edge(1);
            let square = Some(e.norm_squared()).filter(|square| *square > 0.0)?;
            let t = -origin.dot(&e) / square;
            Some(([t, 0.0, 0.0], origin + e * t))
        }
        3 => {
            let (e, f) = (edge(1), edge(2));
            // By the normal: the products of the edges would lose twice the digits where they are nearly in line.
            let normal = e.cross(&f);
            let square = normal.norm_squared();
            if square.sqrt() <= FLAT * e.norm() * f.norm() {
                return None;
            }
            let point = normal * (normal.dot(&origin) / square);
            let inside = point - origin;
            Some((
                [inside.cross(&f).dot(&normal) / square, e.cross(&inside).dot(&normal) / square, 0.0],
                point,
            ))
        }
        4 => {
            let (e, f, g) = (edge(1), edge(2), edge(3));
            let span = Matrix3::from_columns(&[e, f, g]);
            if span.determinant().abs() <= FLAT * e.norm() * f.norm() * g.norm() {
                return None;
            }
            Some(((span.try_inverse()? * -origin).into(), Vector3::zeros()))
        }
        _ => None,
    }
}
