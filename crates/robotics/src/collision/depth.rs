//! How deep two convex sets lie in each other, from the supports of their difference.
//!
//! The depth is the least shift that separates them, which is the least support of the difference over all directions:
//! the distance of the origin from its hull. It is searched for from many directions; where the search ends in the
//! second best, the depth is told too large, never too small.

use nalgebra::Vector3;

/// Directions from which the search goes on.
const KEPT: usize = 8;

/// Steps are halved down to this, rad.
const FINEST: f64 = 1e-6;

/// A step that gains less than its square times this is no gain, m.
const GAIN: f64 = 1e-3;

/// The depth, m, and the direction in which the first set has to leave the second.
///
/// `height` is the support of the difference: how far it reaches in a direction. `likely` are directions that are tried
/// beside the even ones, such as the normals of faces.
pub(crate) fn depth(height: impl Fn(&Vector3<f64>) -> f64, likely: &[Vector3<f64>]) -> (f64, Vector3<f64>) {
    let mut tried: Vec<(f64, Vector3<f64>)> =
        even().into_iter().chain(likely.iter().flat_map(|n| [*n, -*n])).map(|n| (height(&n), n)).collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    tried.truncate(KEPT);
    let refined = tried.into_iter().map(|(value, n)| refine(&height, value, n));
    let (value, n) =
        refined.fold((f64::INFINITY, Vector3::z()), |best, next| if next.0 < best.0 { next } else { best });
    // out of the second set is against the direction in which the difference ends
    (value.max(0.0), -n)
}

/// Goes down by turning the direction, about two axes across it and the two between them.
fn refine(
    height: &impl Fn(&Vector3<f64>) -> f64,
    mut value: f64,
    mut n: Vector3<f64>,
) -> (f64, Vector3<f64>) {
    let mut step = 0.3;
    while step > FINEST {
        let across = if n.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() };
        let u = n.cross(&across).normalize();
        let v = n.cross(&u);
        let ways = [u, -u, v, -v, u + v, u - v, v - u, -u - v];
        let next = ways.into_iter().map(|way| (n + way * step).normalize()).map(|n| (height(&n), n));
        let best = next.fold((value, n), |best, next| if next.0 < best.0 { next } else { best });
        if best.0 < value - GAIN * step * step { (value, n) = best } else { step *= 0.5 }
    }
    (value, n)
}

/// The directions to the corners, edges and faces of a cube.
fn even() -> Vec<Vector3<f64>> {
    let ends = [-1.0, 0.0, 1.0];
    let all = ends.iter().flat_map(|x| ends.iter().flat_map(move |y| ends.map(|z| Vector3::new(*x, *y, z))));
    all.filter(|n| n.norm() > 0.0).map(|n| n.normalize()).collect()
}
