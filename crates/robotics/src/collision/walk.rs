//! A mechanism on its way through many poses.

use blocksim_multibody::Placement;

use crate::collision::apart::{Apart, Watch};
use crate::collision::check::{Check, Clearance};
use crate::collision::distance::Distance;

/// What happens on a way.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Passage {
    /// The first pose in which something touches, and what.
    pub first: Option<(usize, Clearance)>,
    /// The pose with the least distance, and of what; where something touches, as deep as it is known.
    pub least: Option<(usize, Clearance)>,
}

/// Goes through poses and finds where solids are nearest, measuring only what may matter: pairs that may have come nearer
/// than the nearest so far.
#[derive(Debug)]
pub struct Walk<'c> {
    apart: Apart<'c>,
    nearest: Nearest<'c>,
}

/// The nearest pair so far.
#[derive(Debug)]
struct Nearest<'c> {
    check: &'c Check,
    /// The least distance so far, m.
    least: f64,
    /// Whether something has touched in an earlier pose.
    has_touched: bool,
    /// The nearest of the present pose, if it is nearer than any before, or touches first.
    best: Option<(usize, Distance)>,
}

impl<'c> Walk<'c> {
    /// Before the first pose.
    pub fn new(check: &'c Check) -> Self {
        let nearest = Nearest { check, least: f64::INFINITY, has_touched: false, best: None };
        Walk { apart: Apart::new(check), nearest }
    }

    /// The same where it is known that a distance in one of the poses to come is not more than `least`, m: larger ones are
    /// not told, but the first touch is.
    pub fn down_to(check: &'c Check, least: f64) -> Self {
        let mut walk = Walk::new(check);
        walk.nearest.least = least.next_up();
        walk
    }

    /// The least distance so far, m; infinite before any was told.
    pub fn least(&self) -> f64 {
        self.nearest.least
    }

    /// The next pose, with the world first: the nearest pair, if it is nearer than any before, or touches first.
    pub fn step(&mut self, poses: &[Placement]) -> Option<Clearance> {
        self.apart.step(poses, &mut self.nearest);
        let nearest = &mut self.nearest;
        let (pair, found) = nearest.best.take()?;
        nearest.has_touched |= found.distance <= 0.0;
        nearest.least = nearest.least.min(found.distance);
        Some(nearest.check.clearance_of(nearest.check.pairs[pair].of, found))
    }
}

impl Watch for Nearest<'_> {
    fn enough(&self, pair: usize) -> f64 {
        let bound = match &self.best {
            Some((_, found)) => found.distance,
            None if self.has_touched => self.least,
            // However deep what is to come lies, the first touch counts.
            None => self.least.max(f64::MIN_POSITIVE),
        };
        self.check.pairs[pair].bound(bound)
    }

    fn found(&mut self, pair: usize, distance: Distance) {
        if distance.distance < self.enough(pair) {
            self.best = Some((pair, distance));
        }
    }
}

impl Check {
    /// First collision and least distance when the bodies go through `poses`, one after another.
    pub fn along<P: AsRef<[Placement]>>(&self, poses: impl IntoIterator<Item = P>) -> Passage {
        let mut course = Passage::default();
        let mut walk = Walk::new(self);
        for (row, poses) in poses.into_iter().enumerate() {
            let Some(found) = walk.step(poses.as_ref()) else { continue };
            if found.distance.distance <= 0.0 && course.first.is_none() {
                course.first = Some((row, found.clone()));
            }
            course.least = Some((row, found));
        }
        course
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::check::{Item, Rules};
    use crate::collision::solid::Solid;

    /// The same as when each pose is measured by itself.
    #[test]
    fn leaving_pairs_out_changes_nothing() {
        let item = |name: &str, body, solid, x: f64| Item {
            name: name.to_owned(),
            body,
            solid,
            place: Placement::from_translation([x, 0.0, 0.0]),
        };
        let items = vec![
            item("post", None, Solid::cylinder(0.1, 2.0), 0.2),
            item("floor", None, Solid::half_space(), 0.0),
            item("upper", Some(1), Solid::cuboid([0.6, 0.1, 0.2]), 0.3),
            item("fore", Some(2), Solid::capsule(0.05, 0.3), 0.1),
            item("hand", Some(3), Solid::sphere(0.1), 0.0),
        ];
        let rest: Vec<Placement> =
            (0..4).map(|i| Placement::from_translation([0.0, 0.0, 2.0 * f64::from(i)])).collect();
        let check = Check::new(items, &[None, Some(0), Some(1), Some(2)], &rest, &Rules::default());
        let poses = |t: f64| -> Vec<Placement> {
            let at = |k: f64| {
                let (sin, cos) = (k * t).sin_cos();
                Placement::from_rpy([sin, 0.9 * cos - 0.3 * k, 0.6 + 0.9 * cos * sin], [t, k * sin, t * k])
            };
            vec![Placement::identity(), at(1.0), at(1.7), at(2.3)]
        };
        let way: Vec<Vec<Placement>> = (0..3000).map(|row| poses(f64::from(row) * 1e-3)).collect();
        let course = check.along(&way);
        let each: Vec<f64> =
            way.iter().map(|poses| check.clearance(poses).expect("pairs").distance.distance).collect();
        let least = each.iter().copied().fold(f64::INFINITY, f64::min);
        let first = each.iter().position(|distance| *distance <= 0.0);
        assert!(first.is_some_and(|row| row > 10), "{first:?}");
        assert_eq!(course.first.as_ref().map(|(row, _)| *row), first);
        assert_eq!(course.least.clone().expect("pairs").1.distance.distance, least);
        // Nor does it to know beforehand how near some of the poses come, however deep that is.
        for every in [7, 100, 1000] {
            let mut coarse = Walk::new(&check);
            way.iter().step_by(every).for_each(|poses| drop(coarse.step(poses)));
            let mut informed = Walk::down_to(&check, coarse.least());
            let found = way.iter().enumerate().filter_map(|(row, poses)| Some((row, informed.step(poses)?)));
            let found: Vec<(usize, Clearance)> = found.collect();
            assert_eq!(found.iter().find(|(_, near)| near.distance.distance <= 0.0), course.first.as_ref());
            assert_eq!(found.last(), course.least.as_ref());
        }
    }

    /// A solid without end on a body that turns: no way of the body bounds how near it comes.
    #[test]
    fn a_plane_that_turns_is_measured_in_each_pose() {
        let item = |name: &str, body, solid, z: f64| Item {
            name: name.to_owned(),
            body,
            solid,
            place: Placement::from_translation([0.0, 0.0, z]),
        };
        let items = vec![
            item("ball", Some(1), Solid::sphere(0.1), 0.5),
            item("rod", Some(1), Solid::capsule(0.1, 0.4), 1.5),
            item("flap", Some(2), Solid::half_space(), -0.3),
        ];
        let parents = [None, Some(0), Some(0)];
        let rest = [Placement::identity(); 3];
        let check = Check::new(items, &parents, &rest, &Rules::default());
        let way = |t: f64| {
            // Still, then away, then turning.
            let flap = Placement::from_rpy([0.0, 0.0, -0.1 * t.sin()], [1.5 * (t - 2.0).max(0.0), 0.0, 0.0]);
            [Placement::identity(), Placement::from_translation([0.0, 0.1 * t, 0.0]), flap]
        };
        let poses: Vec<[Placement; 3]> = (0..400).map(|row| way(f64::from(row) * 1e-2)).collect();
        let each: Vec<f64> =
            poses.iter().map(|poses| check.clearance(poses).expect("pairs").distance.distance).collect();
        let passage = check.along(&poses);
        let least = each.iter().copied().fold(f64::INFINITY, f64::min);
        let first = each.iter().position(|distance| *distance <= 0.0);
        assert!(first.is_some_and(|row| row > 200), "{first:?}");
        assert_eq!(passage.first.map(|(row, _)| row), first);
        assert_eq!(passage.least.expect("pairs").1.distance.distance, least);
    }
}
