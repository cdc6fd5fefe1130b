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

/// Hits of rays from one start.
const RAYS: usize = 40;

/// The depth, m, and the direction in which the first set has to leave the second.
///
/// `reach` is the point of the difference that is farthest in a direction. `likely` are directions that are tried beside the even ones,
/// such as the normals of faces.
pub(crate) fn depth(
    reach: impl Fn(&Vector3<f64>) -> Vector3<f64>,
    likely: &[Vector3<f64>],
) -> (f64, Vector3<f64>) {
    let height = |n: &Vector3<f64>| n.dot(&reach(n));
    let mut tried: Vec<(f64, Vector3<f64>)> =
        even().into_iter().chain(likely.iter().flat_map(|n| [*n, -*n])).map(|n| (height(&n), n)).collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    tried.truncate(KEPT);
    let refined =
        tried.into_iter().map(|start| descend(&reach, start)).map(|(value, n)| refine(&height, value, n));
    let (value, n) =
        refined.fold((f64::INFINITY, Vector3::z()), |best, next| if next.0 < best.0 { next } else { best });
    // out of the second set is against the direction in which the difference ends
    (value.max(0.0), -n)
}

/// Goes from a direction to that of the face which a ray from the origin hits there, as long as that is lower: a face is never higher than the
/// ray is long, nor the ray longer than the set is high. Ridges, where turning the direction alone gets no lower, are passed so.
fn descend(
    reach: &impl Fn(&Vector3<f64>) -> Vector3<f64>,
    (mut value, mut n): (f64, Vector3<f64>),
) -> (f64, Vector3<f64>) {
    for _ in 0..RAYS {
        let Some(normal) = face(reach, &n) else { break };
        let next = normal.dot(&reach(&normal));
        if next >= value * (1.0 - 1e-9) {
            break;
        }
        (value, n) = (next, normal);
    }
    (value, n)
}

/// The outward normal where a ray from the origin, which is inside, leaves a convex set: three points of the hull whose cone holds the ray are
/// moved outwards until nothing is beyond their plane. Nothing where the points lie in one plane with the origin.
///
/// Source: G. Snethen, XenoCollide: Complex Collision Made Simple, Game Programming Gems 7 (2008), for the idea.
fn face(reach: &impl Fn(&Vector3<f64>) -> Vector3<f64>, ray: &Vector3<f64>) -> Option<Vector3<f64>> {
    const ROUNDS: usize = 60;
    let outward = |cross: Vector3<f64>| cross.try_normalize(1e-14);
    let first = reach(ray);
    let second = reach(&outward(first.cross(ray))?);
    let mut cone = [first, second, Vector3::zeros()];
    // The ray is to the inner side of each two of the three, seen from the origin.
    let inner = |a: &Vector3<f64>, b: &Vector3<f64>| a.cross(b).dot(ray);
    if inner(&cone[0], &cone[1]) < 0.0 {
        cone.swap(0, 1);
    }
    for _ in 0..ROUNDS {
        cone[2] = reach(&outward(cone[0].cross(&cone[1]))?);
        if inner(&cone[1], &cone[2]) < 0.0 {
            cone[0] = cone[2];
        } else if inner(&cone[2], &cone[0]) < 0.0 {
            cone[1] = cone[2];
        } else {
            break;
        }
    }
    let [a, b, c] = &cone;
    if [inner(a, b), inner(b, c), inner(c, a)].iter().any(|side| *side < 0.0) {
        return None;
    }
    let mut normal = None;
    for _ in 0..ROUNDS {
        let [a, b, c] = cone;
        let plane = outward((b - a).cross(&(c - a)))?;
        normal = Some(plane);
        let beyond = reach(&plane);
        let gain = plane.dot(&(beyond - a));
        if gain <= 1e-12 * plane.dot(&beyond).abs() {
            break;
        }
        // Of the three cones with the new point the one that holds the ray.
        let [at_a, at_b, at_c] = [a, b, c].map(|corner| inner(&corner, &beyond));
        cone = match () {
            () if at_b >= 0.0 && at_a <= 0.0 => [a, b, beyond],
            () if at_c >= 0.0 && at_b <= 0.0 => [b, c, beyond],
            () if at_a >= 0.0 && at_c <= 0.0 => [c, a, beyond],
            () => break,
        };
    }
    normal
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The hull of points, and its depth by the planes through each three of them.
    fn by_planes(points: &[Vector3<f64>]) -> f64 {
        let mut least = f64::INFINITY;
        for (i, a) in points.iter().enumerate() {
            for (j, b) in points[..i].iter().enumerate() {
                for c in &points[..j] {
                    let Some(n) = (b - a).cross(&(c - a)).try_normalize(1e-9) else { continue };
                    for n in [n, -n] {
                        if points.iter().all(|p| n.dot(&(p - a)) <= 1e-12) {
                            least = least.min(n.dot(a));
                        }
                    }
                }
            }
        }
        least
    }

    /// Numbers between -1 and 1.
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    #[test]
    fn the_depth_within_random_hulls_is_that_of_their_nearest_face() {
        let mut state = 7;
        let mut found = 0;
        for size in [[1.0, 1.0, 1.0], [1.0, 0.3, 0.1], [1.0, 0.05, 1.0]] {
            for _ in 0..150 {
                let mut point = || Vector3::from_fn(|i, _| size[i] * random(&mut state));
                let points: Vec<Vector3<f64>> = (0..14).map(|_| point()).collect();
                let exact = by_planes(&points);
                if exact <= 0.0 {
                    continue;
                }
                let reach = |n: &Vector3<f64>| {
                    let by_height = |a: &&Vector3<f64>, b: &&Vector3<f64>| a.dot(n).total_cmp(&b.dot(n));
                    points.iter().max_by(by_height).copied().unwrap_or_default()
                };
                let (value, n) = depth(reach, &[]);
                assert!((reach(&-n).dot(&-n) - value).abs() < 1e-12);
                assert!(
                    value >= exact - 1e-9 && value <= exact * (1.0 + 1e-6) + 1e-9,
                    "{value} {exact} {size:?}"
                );
                found += 1;
            }
        }
        assert!(found > 200, "{found}");
    }
}
