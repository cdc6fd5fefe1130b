//! How far two solids are from each other.

use blocksim_multibody::Placement;
use nalgebra::Vector3;

use crate::collision::convex::nearest;
use crate::collision::depth::depth;
use crate::collision::solid::{Core, Solid};

/// How far two solids are from each other, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Distance, m; zero or less where they touch: then the least shift that separates them, with a minus.
    pub distance: f64,
    /// The nearest points, of the first and of the second solid; where they overlap, those that lie deepest in the other.
    pub points: [Vector3<f64>; 2],
}

/// Distance of two solids at their placements.
///
/// Exact to rounding for spheres, capsules and half-spaces, otherwise to about 1e-12 relative, 1e-10 m at least. The depth
/// of solids that overlap is found by a search, to about 1e-6 of their size; it is never too small.
pub fn distance(a: &Solid, at: &Placement, b: &Solid, bt: &Placement) -> Distance {
    match (a.core, b.core) {
        (Core::HalfSpace, Core::HalfSpace) => {
            Distance { distance: 0.0, points: [at.translation, bt.translation] }
        }
        (Core::HalfSpace, _) => above(at, b, bt).reversed(),
        (_, Core::HalfSpace) => above(bt, a, at),
        _ => between(a, at, b, bt),
    }
}

/// How far two solids are apart along a direction of length 1 from the second to the first, m: never more than their distance,
/// and the same where the direction is that of their nearest points. Minus infinity where nothing is known.
pub(crate) fn separation(a: &Solid, at: &Placement, b: &Solid, bt: &Placement, across: &Vector3<f64>) -> f64 {
    if matches!(a.core, Core::HalfSpace) || matches!(b.core, Core::HalfSpace) || *across == Vector3::zeros() {
        return f64::NEG_INFINITY;
    }
    let between = farthest(a, at, &-across) - farthest(b, bt, across);
    across.dot(&between) - a.margin - b.margin
}

/// The point of the core of a solid that is farthest in a direction.
fn farthest(solid: &Solid, place: &Placement, direction: &Vector3<f64>) -> Vector3<f64> {
    place.point(&solid.core.support(&place.rotation.tr_mul(direction)))
}

impl Distance {
    fn reversed(self) -> Self {
        let [a, b] = self.points;
        Distance { points: [b, a], ..self }
    }
}

/// Height of a solid above a half-space.
fn above(plane: &Placement, solid: &Solid, at: &Placement) -> Distance {
    let normal = plane.direction(&Vector3::z());
    let lowest = at.point(&solid.core.support(&-at.rotation.tr_mul(&normal))) - normal * solid.margin;
    let height = normal.dot(&(lowest - plane.translation));
    Distance { distance: height, points: [lowest, lowest - normal * height] }
}

fn between(a: &Solid, at: &Placement, b: &Solid, bt: &Placement) -> Distance {
    let apart = at.translation - bt.translation;
    let start = if apart.norm() > 0.0 { apart } else { Vector3::x() };
    let cores = nearest(|d| farthest(a, at, d), |d| farthest(b, bt, d), start);
    let Some(([p, q], gap)) = cores else {
        let reach = |n: &Vector3<f64>| farthest(a, at, n) - farthest(b, bt, &-n);
        let (deep, out) = depth(reach, &likely(at, bt));
        let point = |solid: &Solid, place: &Placement, way: Vector3<f64>| {
            farthest(solid, place, &way) + way * solid.margin
        };
        return Distance {
            distance: 0.0 - deep - a.margin - b.margin,
            points: [point(a, at, -out), point(b, bt, out)],
        };
    };
    let length = gap.norm();
    let way = gap / length;
    Distance { distance: length - a.margin - b.margin, points: [p - way * a.margin, q + way * b.margin] }
}

/// Directions in which two overlapping solids are likely to be separated first: the axes of both, those square to an axis of
/// each, and from centre to centre with and without its part along an axis.
fn likely(at: &Placement, bt: &Placement) -> Vec<Vector3<f64>> {
    let axes = |place: &Placement| [0, 1, 2].map(|i| place.rotation.column(i).into_owned());
    let (a, b) = (axes(at), axes(bt));
    let apart = at.translation - bt.translation;
    let crossed = a.iter().flat_map(|a| b.iter().map(move |b| a.cross(b)));
    let beside = [a[2], b[2]].map(|axis| apart - axis * axis.dot(&apart));
    let all = a.into_iter().chain(b).chain(crossed).chain(beside).chain([apart]);
    all.filter_map(|n| n.try_normalize(1e-9)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    fn at(x: f64, y: f64, z: f64) -> Placement {
        Placement::from_translation([x, y, z])
    }

    fn close(found: Distance, expected: f64) {
        assert!((found.distance - expected).abs() < 1e-9, "{found:?} != {expected}");
        if found.distance > 0.0 {
            assert!(((found.points[0] - found.points[1]).norm() - expected).abs() < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn spheres_and_capsules_have_the_distances_of_points_and_lines() {
        let ball = Solid::sphere(0.1);
        close(distance(&ball, &at(0.0, 0.0, 0.0), &ball, &at(0.3, 0.4, 0.0)), 0.3);
        close(distance(&ball, &at(0.0, 0.0, 0.0), &ball, &at(0.15, 0.0, 0.0)), -0.05);
        let rod = Solid::capsule(0.05, 1.0);
        close(distance(&rod, &at(0.0, 0.0, 0.0), &ball, &at(0.3, 0.0, 0.2)), 0.15);
        close(distance(&rod, &at(0.0, 0.0, 0.0), &ball, &at(0.0, 0.0, 1.0)), 0.35);
        // Crossed rods, 0.3 m apart; parallel ones; one behind the other.
        let lying = Placement::from_rpy([0.0, 0.3, 0.1], [0.0, FRAC_PI_2, 0.0]);
        close(distance(&rod, &at(0.0, 0.0, 0.0), &rod, &lying), 0.2);
        close(distance(&rod, &at(0.0, 0.0, 0.0), &rod, &at(0.0, 0.5, 0.4)), 0.4);
        close(distance(&rod, &at(0.0, 0.0, 0.0), &rod, &at(0.0, 0.0, 1.4)), 0.3);
    }

    #[test]
    fn boxes_have_the_distances_of_faces_edges_and_corners() {
        let cube = Solid::cuboid([1.0; 3]);
        close(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &at(1.25, 0.2, 0.1)), 0.25);
        close(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &at(1.3, 1.4, 0.2)), 0.5);
        close(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &at(1.2, 1.3, 1.6)), 0.7);
        // An edge stands before a face.
        let turned = Placement::from_rpy([2.0, 0.0, 0.0], [0.0, 0.0, FRAC_PI_4]);
        close(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &turned), 1.5 - 0.5_f64.sqrt());
        // A corner stands before a face: the diagonal of the cube along x.
        let diagonal = nalgebra::Rotation3::rotation_between(&Vector3::new(1.0, 1.0, 1.0), &Vector3::x());
        let on_tip = Placement {
            rotation: diagonal.expect("not opposite").into_inner(),
            translation: Vector3::new(2.0, 0.1, 0.0),
        };
        close(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &on_tip), 1.5 - 0.75_f64.sqrt());
        assert!(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &at(0.9, 0.9, 0.9)).distance <= 0.0);
        assert!(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &at(0.0, 0.0, 0.0)).distance <= 0.0);
    }

    #[test]
    fn cylinders_and_cones_have_the_distances_of_circles_and_flanks() {
        let drum = Solid::cylinder(0.5, 1.0);
        close(distance(&drum, &at(0.0, 0.0, 0.0), &drum, &at(1.2, 0.9, 0.3)), 0.5);
        close(distance(&drum, &at(0.0, 0.0, 0.0), &drum, &at(0.3, 0.2, 1.25)), 0.25);
        // The rims of a standing and a lying drum: both lie in one plane.
        let lying = Placement::from_rpy([2.0, 0.0, 0.0], [0.0, FRAC_PI_2, 0.0]);
        close(distance(&drum, &at(0.0, 0.0, 0.0), &drum, &lying), 1.0);
        // A sphere before the flank of a cone with slope 45 degrees: its tip at (0, 0, 0.5).
        let cone = Solid::cone(1.0, 0.0, 1.0);
        let ball = Solid::sphere(0.1);
        close(distance(&cone, &at(0.0, 0.0, 0.0), &ball, &at(1.0, 0.0, 0.5)), 0.5_f64.sqrt() - 0.1);
        close(distance(&cone, &at(0.0, 0.0, 0.0), &ball, &at(0.0, 0.0, 1.0)), 0.4);
    }

    #[test]
    fn a_floor_knows_how_high_everything_is() {
        let floor = Solid::half_space();
        let tilted = Placement::from_rpy([0.0, 0.0, 1.0], [0.3, 0.0, 0.0]);
        for (solid, below) in
            [(Solid::sphere(0.2), 0.2), (Solid::capsule(0.1, 1.0), 0.6), (Solid::cuboid([1.0; 3]), 0.5)]
        {
            close(distance(&solid, &at(0.0, 0.0, 2.0), &floor, &at(0.0, 0.0, 0.0)), 2.0 - below);
            close(distance(&floor, &tilted, &solid, &(tilted * at(3.0, 1.0, 2.0))), 2.0 - below);
            close(distance(&solid, &at(0.0, 0.0, 0.1), &floor, &at(0.0, 0.0, 0.0)), 0.1 - below);
        }
    }

    #[test]
    fn overlapping_solids_tell_the_least_shift_that_separates_them() {
        let cube = Solid::cuboid([1.0; 3]);
        close(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &at(0.9, 0.1, 0.3)), -0.1);
        close(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &at(0.0, 0.0, 0.0)), -1.0);
        let turned = Placement::from_rpy([1.1, 0.0, 0.0], [0.0, 0.0, FRAC_PI_4]);
        close(distance(&cube, &at(0.0, 0.0, 0.0), &cube, &turned), 1.1 - 0.5 - 0.5_f64.sqrt());
        let ball = Solid::sphere(0.1);
        close(distance(&ball, &at(0.0, 0.0, 0.45), &cube, &at(0.0, 0.0, 0.0)), -0.15);
        let drum = Solid::cylinder(0.5, 2.0);
        for (x, y, depth) in [(0.8, 0.0, 0.2), (0.48, 0.64, 0.2), (0.1, 0.0, 0.9)] {
            let found = distance(&drum, &at(0.0, 0.0, 0.0), &drum, &at(x, y, 0.3));
            assert!((found.distance + depth).abs() < 1e-6, "{found:?}");
        }
        // crossed rods whose middle lines meet
        let rod = Solid::capsule(0.05, 1.0);
        let lying = Placement::from_rpy([0.0; 3], [0.0, FRAC_PI_2, 0.0]);
        close(distance(&rod, &at(0.0, 0.0, 0.0), &rod, &lying), -0.1);
    }

    /// Random numbers between -1 and 1.
    fn noise(seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Whatever the pair: the nearest points lie on the solids, the gap square to both, and order does not count.
    #[test]
    fn nearest_points_lie_on_both_solids_and_no_other_pair_is_nearer() {
        let solids = [
            Solid::sphere(0.3),
            Solid::capsule(0.2, 0.6),
            Solid::cuboid([0.5, 0.7, 0.3]),
            Solid::cylinder(0.3, 0.5),
            Solid::cone(0.4, 0.1, 0.6),
        ];
        let mut seed = 7;
        let (mut apart, mut touching) = (0, 0);
        for _ in 0..1500 {
            let mut any = || {
                let mut three = || [noise(&mut seed), noise(&mut seed), noise(&mut seed)];
                Placement::from_rpy(three().map(|x| x * 0.8), three().map(|x| x * 3.0))
            };
            let (pa, pb) = (any(), any());
            let pick = |x: f64| solids[((x + 1.0) * 2.5) as usize % 5];
            let (a, b) = (pick(noise(&mut seed)), pick(noise(&mut seed)));
            let found = distance(&a, &pa, &b, &pb);
            let back = distance(&b, &pb, &a, &pa);
            assert!((found.distance > 0.0) == (back.distance > 0.0), "{found:?} {back:?}");
            if found.distance <= 0.0 {
                touching += 1;
                // whatever the direction, a smaller shift does not separate them
                for _ in 0..if touching % 30 == 0 { 10 } else { 0 } {
                    let way = Vector3::new(noise(&mut seed), noise(&mut seed), noise(&mut seed)).normalize();
                    let by = way * -(found.distance * 0.99);
                    let shifted = Placement { translation: pa.translation + by, ..pa };
                    let held = distance(&a, &shifted, &b, &pb).distance;
                    assert!(held <= 1e-9, "{held} after {by}: {found:?}");
                }
                continue;
            }
            apart += 1;
            assert!((found.distance - back.distance).abs() < 1e-9, "{found:?} {back:?}");
            // The plane square to the gap through each point has its solid on one side: then nothing is nearer.
            let way = (found.points[0] - found.points[1]).normalize();
            for (solid, place, point, sign) in [(a, pa, found.points[0], 1.0), (b, pb, found.points[1], -1.0)]
            {
                let outward = -way * sign;
                let extreme = place.point(&solid.core.support(&place.rotation.tr_mul(&outward)))
                    + outward * solid.margin;
                let beyond = outward.dot(&(extreme - point));
                assert!(beyond.abs() < 1e-6, "{solid:?}: {beyond}, {found:?}");
            }
        }
        assert!(apart > 400 && touching > 100, "{apart} apart, {touching} touching");
    }
}
