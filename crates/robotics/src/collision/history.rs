//! What touches when on a way, and how near the others come.

use std::collections::HashMap;

use blocksim_multibody::Placement;

use crate::collision::apart::{Apart, Watch};
use crate::collision::check::Check;
use crate::collision::distance::Distance;

/// Two parts that touch each other for a while.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Names of both, the same as in [`crate::collision::Item::name`].
    pub names: [String; 2],
    /// The first time at which they touch, s.
    pub from: f64,
    /// The last one before they are apart again, s.
    pub to: f64,
    /// When they are deepest in each other.
    pub deepest: Nearest,
}

/// Two parts where they are nearest to each other, or deepest in each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// When, s.
    pub time: f64,
    /// How far they are from each other and where, in the world.
    pub distance: Distance,
}

/// What happened on a way.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct History {
    /// What touched, by time.
    pub contacts: Vec<Contact>,
    /// Each pair of names that never touched, and where they were nearest; the nearest pair first. Pairs that are close by
    /// construction have no distance that says anything, and are not listed.
    pub nearest: Vec<([String; 2], Nearest)>,
    /// Poses that were looked at.
    pub poses: usize,
}

/// All pairs of solids with one pair of names.
#[derive(Debug, Clone, Default)]
struct Group {
    names: [String; 2],
    least: Option<Nearest>,
    /// The contact that lasts, among those of the history.
    open: Option<usize>,
    /// The deepest of the present pose.
    now: Option<Distance>,
}

/// What is found of each pair of names.
///
/// A pair of solids is measured where it may touch, or may be nearer than its names were before.
#[derive(Debug)]
struct Follow<'c> {
    check: &'c Check,
    groups: Vec<Group>,
    /// The group of each pair.
    of_pair: Vec<usize>,
    time: f64,
    history: History,
}

impl Check {
    /// What touches when and how near all others come while the bodies go through `way`: times that never fall, s, and the
    /// placements of the bodies, the world first.
    pub fn history<P: AsRef<[Placement]>>(&self, way: impl IntoIterator<Item = (f64, P)>) -> History {
        let (mut follow, mut apart) = (Follow::new(self), Apart::new(self));
        for (time, poses) in way {
            follow.time = time;
            apart.step(poses.as_ref(), &mut follow);
            follow.note();
        }
        follow.told()
    }
}

impl<'c> Follow<'c> {
    fn new(check: &'c Check) -> Self {
        let mut groups: Vec<Group> = Vec::new();
        let mut known: HashMap<[&str; 2], usize> = HashMap::new();
        let mut of_pair = Vec::with_capacity(check.pairs.len());
        for pair in &check.pairs {
            let [a, b] = pair.of.map(|i| check.items[i].name.as_str());
            let group = *known.get(&[a, b]).or_else(|| known.get(&[b, a])).unwrap_or(&groups.len());
            if group == groups.len() {
                known.insert([a, b], group);
                groups.push(Group { names: [a.to_owned(), b.to_owned()], ..Group::default() });
            }
            of_pair.push(group);
        }
        Follow { check, groups, of_pair, time: 0.0, history: History::default() }
    }

    /// A pose is done.
    fn note(&mut self) {
        self.history.poses += 1;
        for group in &mut self.groups {
            group.note(self.time, &mut self.history.contacts);
        }
    }

    fn told(self) -> History {
        let mut history = self.history;
        let nearest = |group: Group| Some((group.names, group.least?));
        history.nearest = self.groups.into_iter().filter_map(nearest).collect();
        history.nearest.retain(|(_, least)| least.distance.distance > 0.0);
        history.nearest.sort_by(|(_, a), (_, b)| a.distance.distance.total_cmp(&b.distance.distance));
        history
    }
}

impl Watch for Follow<'_> {
    fn enough(&self, pair: usize) -> f64 {
        // What touches is measured however deep it was before.
        self.check.pairs[pair].bound(self.groups[self.of_pair[pair]].least().max(f64::MIN_POSITIVE))
    }

    fn found(&mut self, pair: usize, mut found: Distance) {
        let group = &mut self.groups[self.of_pair[pair]];
        let pair = &self.check.pairs[pair];
        if self.check.items[pair.of[0]].name != group.names[0] {
            found.points.reverse();
        }
        if found.distance <= 0.0 && group.now.is_none_or(|now| found.distance < now.distance) {
            group.now = Some(found);
        }
        if found.distance < pair.bound(group.least()) {
            group.least = Some(Nearest { time: self.time, distance: found });
        }
    }
}

impl Group {
    /// The least distance so far, m; infinite before any was measured.
    fn least(&self) -> f64 {
        self.least.map_or(f64::INFINITY, |least| least.distance.distance)
    }

    /// Begins, goes on with or ends a contact.
    fn note(&mut self, time: f64, contacts: &mut Vec<Contact>) {
        let Some(distance) = self.now.take() else {
            self.open = None;
            return;
        };
        let now = Nearest { time, distance };
        match self.open.and_then(|open| contacts.get_mut(open)) {
            Some(contact) => {
                contact.to = time;
                if distance.distance < contact.deepest.distance.distance {
                    contact.deepest = now;
                }
            }
            None => {
                self.open = Some(contacts.len());
                contacts.push(Contact { names: self.names.clone(), from: time, to: time, deepest: now });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::check::{Item, Rules};
    use crate::collision::solid::Solid;

    fn item(name: &str, body: Option<usize>, solid: Solid, x: f64) -> Item {
        Item { name: name.to_owned(), body, solid, place: Placement::from_translation([x, 0.0, 0.0]) }
    }

    /// A ball of 0.1 m that slides along x between two walls, and a mast beside it.
    fn between_walls() -> Check {
        let items = vec![
            item("ball", Some(1), Solid::sphere(0.1), 0.0),
            item("left", None, Solid::cuboid([0.2, 1.0, 1.0]), -1.0),
            item("right", None, Solid::cuboid([0.2, 1.0, 1.0]), 1.0),
            Item {
                place: Placement::from_translation([0.0, 0.5, 0.0]),
                ..item("mast", None, Solid::cylinder(0.05, 2.0), 0.0)
            },
        ];
        Check::new(items, &[None, Some(0)], &[Placement::identity(); 2], &Rules::default())
    }

    #[test]
    fn every_contact_has_its_times_its_depth_and_its_place() {
        // x = sin t: the walls begin at ±0.9 m, so they are touched from |sin t| = 0.8 on, 0.2 m deep at most.
        let way = (0..=6283)
            .map(|k| f64::from(k) * 1e-3)
            .map(|t| (t, [Placement::identity(), Placement::from_translation([t.sin(), 0.0, 0.0])]));
        let history = between_walls().history(way);
        let names: Vec<&str> =
            history.contacts.iter().flat_map(|contact| contact.names.iter().map(String::as_str)).collect();
        assert_eq!(names, ["ball", "right", "ball", "left"], "{history:?}");
        let begin = 0.8_f64.asin();
        for (contact, around, x) in [(&history.contacts[0], 0.0, 1.0), (&history.contacts[1], 1.0, -1.0)] {
            let pi = std::f64::consts::PI;
            assert!((contact.from - (begin + around * pi)).abs() < 1.1e-3, "{contact:?}");
            assert!((contact.to - (pi - begin + around * pi)).abs() < 1.1e-3, "{contact:?}");
            assert!((contact.deepest.distance.distance + 0.2).abs() < 1e-6, "{contact:?}");
            assert!((contact.deepest.time - pi * (0.5 + around)).abs() < 2e-3, "{contact:?}");
            assert!((contact.deepest.distance.points[0].x - 1.1 * x).abs() < 1e-5, "{contact:?}");
        }
        // The mast is 0.5 m beside the middle.
        let [(names, nearest)] = &history.nearest[..] else { panic!("{history:?}") };
        assert_eq!(names, &["ball", "mast"]);
        assert!((nearest.distance.distance - 0.35).abs() < 1e-9 && nearest.time == 0.0, "{nearest:?}");
        assert_eq!(history.poses, 6284);
    }

    /// The same as when each pose is measured by itself.
    #[test]
    fn leaving_pairs_out_changes_nothing() {
        let items = vec![
            item("post", None, Solid::cylinder(0.1, 2.0), 0.2),
            item("floor", None, Solid::half_space(), 0.0),
            item("arm", Some(1), Solid::cuboid([0.6, 0.1, 0.2]), 0.3),
            item("arm", Some(1), Solid::sphere(0.15), 0.6),
            item("hand", Some(2), Solid::capsule(0.05, 0.3), 0.1),
        ];
        let rest: Vec<Placement> =
            (0..3).map(|i| Placement::from_translation([0.0, 0.0, 2.0 * f64::from(i)])).collect();
        let check = Check::new(items, &[None, Some(0), Some(0)], &rest, &Rules::default());
        let poses = |t: f64| {
            let at = |k: f64| {
                let (sin, cos) = (k * t).sin_cos();
                Placement::from_rpy([sin, 0.9 * cos - 0.3 * k, 0.6 + 0.9 * cos * sin], [t, k * sin, t * k])
            };
            vec![Placement::identity(), at(1.0), at(1.7)]
        };
        let times = || (0..4000).map(|row| f64::from(row) * 2e-3);
        let history = check.history(times().map(|t| (t, poses(t))));
        assert!(history.contacts.len() > 3, "{}", history.contacts.len());
        for t in times() {
            let touching = check.touches(&poses(t));
            let told: Vec<&Contact> =
                history.contacts.iter().filter(|contact| contact.from <= t && t <= contact.to).collect();
            assert_eq!(touching.is_some(), !told.is_empty(), "{t}");
            if let Some(touching) = touching {
                let deepest = told.iter().map(|contact| contact.deepest.distance.distance);
                assert!(deepest.fold(0.0, f64::min) <= touching.distance.distance + 1e-12, "{t}");
            }
        }
        let least = times().map(|t| check.clearance(&poses(t)).expect("pairs").distance.distance);
        let least = least.fold(f64::INFINITY, f64::min);
        let deepest = history.contacts.iter().map(|contact| contact.deepest.distance.distance);
        assert!((deepest.fold(0.0, f64::min) - least).abs() < 1e-9);
    }
}
