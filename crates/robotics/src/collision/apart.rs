//! How far the solids of each pair are apart at least, from pose to pose.

use std::collections::HashMap;
use std::ops::Range;

use blocksim_multibody::Placement;
use nalgebra::Vector3;

use crate::collision::check::Check;
use crate::collision::distance::{Distance, separation};

/// What rounding may make of a distance, m.
const ROUNDING: f64 = 1e-10;

/// Farther than anything, m.
const FAR: f64 = 1e300;

/// How far a body has come in all: what its origin has moved, m, and what its turns add for each metre from there.
#[derive(Debug, Clone, Copy, Default)]
struct Way {
    shift: f64,
    turn: f64,
}

impl Way {
    /// From one pose to another.
    fn between(from: &Placement, to: &Placement) -> Way {
        // A turn by φ moves a point at the distance r by 2 r sin(φ/2); the norm of the difference is √2 times that of r = 1.
        let turn = (to.rotation - from.rotation).norm() / std::f64::consts::SQRT_2;
        Way { shift: (to.translation - from.translation).norm(), turn }
    }

    /// How far any point within `radius` of the origin has come at most since `before`, m.
    fn since(self, before: Way, radius: f64) -> f64 {
        self.shift - before.shift + (self.turn - before.turn) * radius
    }
}

/// Whoever wants to know what is near.
pub(crate) trait Watch {
    /// The distance from which on a pair does not matter, m. It never grows.
    fn enough(&self, pair: usize) -> f64;

    /// A pair was measured in the present pose; it may be farther apart than what is enough.
    fn found(&mut self, pair: usize, distance: Distance);
}

/// The pairs of solids of two bodies.
#[derive(Debug)]
struct Group {
    bodies: [usize; 2],
    /// The largest radius of any of their solids about the origin of the body, m.
    radius: [f64; 2],
    /// Its pairs in the order of all.
    pairs: Range<usize>,
    /// How far its bodies may have come in all before any of them may matter, m.
    due: f64,
}

/// What is known of a pair.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// Its distance is not less, m, where its bodies were at `at`.
    least: f64,
    at: [Way; 2],
    /// The direction from the second solid to the first where they were measured last; zero before.
    across: Vector3<f64>,
}

/// Of each pair a distance is kept that it has at least. From pose to pose this shrinks by what both solids move by at
/// most, so a pair is measured anew only where it may have come near enough to matter. What two bodies have come is the same
/// for all of their pairs, so that one comparison settles each of these in most poses.
#[derive(Debug)]
pub(crate) struct Apart<'c> {
    check: &'c Check,
    /// Of the bodies in the present pose, the world first, and how far each has come.
    poses: Vec<Placement>,
    ways: Vec<Way>,
    /// Of the solids, where they were needed in the present pose, and in which pose that was.
    places: Vec<Placement>,
    placed: Vec<u64>,
    pose: u64,
    /// Of each solid about the origin of its body, m.
    radius: Vec<f64>,
    groups: Vec<Group>,
    /// Pairs, those of each group together, and how far its bodies may have come in all before each may matter, m.
    order: Vec<usize>,
    due: Vec<f64>,
    known: Vec<Known>,
}

impl<'c> Apart<'c> {
    /// Before the first pose nothing is known.
    pub fn new(check: &'c Check) -> Self {
        let body = |item: usize| check.items[item].body.unwrap_or(0);
        // The reach of a floor is infinite, and zero times infinity is not a number.
        let radius = |item: usize| check.items[item].place.translation.norm() + check.reach[item].min(FAR);
        let radius: Vec<f64> = (0..check.items.len()).map(radius).collect();
        let mut of_bodies: HashMap<[usize; 2], usize> = HashMap::new();
        let mut all: Vec<([usize; 2], Vec<usize>)> = Vec::new();
        for (n, pair) in check.pairs.iter().enumerate() {
            let bodies = pair.of.map(body);
            let group = *of_bodies.entry(bodies).or_insert_with(|| {
                all.push((bodies, Vec::new()));
                all.len() - 1
            });
            all[group].1.push(n);
        }
        let (mut groups, mut order) = (Vec::new(), Vec::new());
        for (bodies, pairs) in all {
            let largest =
                |side: usize| pairs.iter().map(|n| radius[check.pairs[*n].of[side]]).fold(0.0, f64::max);
            let own = order.len()..order.len() + pairs.len();
            let radius = [largest(0), largest(1)];
            groups.push(Group { bodies, radius, pairs: own, due: f64::NEG_INFINITY });
            order.extend(pairs);
        }
        let nothing = Known { least: f64::NEG_INFINITY, at: [Way::default(); 2], across: Vector3::zeros() };
        let bodies = check.items.iter().filter_map(|item| item.body).max().map_or(1, |last| last + 1);
        Apart {
            check,
            poses: Vec::new(),
            ways: vec![Way::default(); bodies],
            places: vec![Placement::identity(); check.items.len()],
            placed: vec![0; check.items.len()],
            pose: 0,
            radius,
            groups,
            due: vec![f64::NEG_INFINITY; order.len()],
            order,
            known: vec![nothing; check.pairs.len()],
        }
    }

    /// Goes on to a pose of the bodies, the world first, and measures in it what may matter.
    pub fn step(&mut self, poses: &[Placement], watch: &mut impl Watch) {
        self.go(poses);
        for group in 0..self.groups.len() {
            let Group { bodies, radius, pairs, due } = &self.groups[group];
            let come = self.come(*bodies, [Way::default(); 2], *radius);
            if *due > come {
                continue;
            }
            let pairs = pairs.clone();
            let mut next = pairs.start;
            while let Some(more) = self.due[next..pairs.end].iter().position(|due| *due <= come) {
                let place = next + more;
                let pair = self.order[place];
                if let Some(found) = self.measured(pair, watch.enough(pair)) {
                    watch.found(pair, found);
                }
                self.due[place] = come + (self.least(pair) - watch.enough(pair));
                next = place + 1;
            }
            self.groups[group].due = self.due[pairs].iter().copied().fold(f64::INFINITY, f64::min);
        }
    }

    /// Takes over a pose, and how far the bodies have come to it.
    fn go(&mut self, poses: &[Placement]) {
        self.pose += 1;
        // The world stays where it is.
        for (way, (from, to)) in self.ways.iter_mut().zip(self.poses.iter().zip(poses)).skip(1) {
            let come = Way::between(from, to);
            way.shift += come.shift;
            way.turn += come.turn;
        }
        self.poses.clear();
        self.poses.extend_from_slice(poses);
    }

    /// How far solids of two bodies have come towards each other at most since these were at `at`, m.
    fn come(&self, bodies: [usize; 2], at: [Way; 2], radius: [f64; 2]) -> f64 {
        let come = |side: usize| self.ways[bodies[side]].since(at[side], radius[side]);
        // Sums of many ways are rounded.
        come(0) + come(1) + ROUNDING
    }

    /// The distance that a pair has at least in the present pose, m.
    fn least(&self, pair: usize) -> f64 {
        let of = self.check.pairs[pair].of;
        let bodies = of.map(|item| self.check.items[item].body.unwrap_or(0));
        let known = &self.known[pair];
        known.least - self.come(bodies, known.at, of.map(|item| self.radius[item]))
    }

    /// Where a solid is in the present pose.
    fn place(&mut self, item: usize) -> Placement {
        if self.placed[item] != self.pose {
            self.placed[item] = self.pose;
            self.places[item] = self.check.place(item, &self.poses);
        }
        self.places[item]
    }

    /// The distance of a pair, unless it is known to be `enough` or more.
    fn measured(&mut self, pair: usize, enough: f64) -> Option<Distance> {
        if self.least(pair) >= enough {
            return None;
        }
        let (check, [i, k]) = (self.check, self.check.pairs[pair].of);
        let at = [i, k].map(|item| self.ways[check.items[item].body.unwrap_or(0)]);
        let [pi, pk] = [self.place(i), self.place(k)];
        let Known { least, at: then, across } = &mut self.known[pair];
        *then = at;
        let centres = (pi.translation - pk.translation).norm();
        *least = centres - check.reach[i] - check.reach[k];
        if *least >= enough {
            return None;
        }
        // Along the direction of the last measurement they are nearly as far apart as they are at all.
        let [a, b] = [i, k].map(|n| &check.items[n].solid);
        *least = separation(a, &pi, b, &pk, across) - ROUNDING;
        if *least >= enough {
            return None;
        }
        let found = check.between([i, k], [&pi, &pk]);
        *least = found.distance;
        *across = (found.points[0] - found.points[1]).try_normalize(ROUNDING).unwrap_or_default();
        Some(found)
    }
}

impl Check {
    /// How far any point of a solid comes at most from one pose to another, m.
    pub fn moved(&self, from: &[Placement], to: &[Placement]) -> f64 {
        let (from, to) = (self.places(from), self.places(to));
        (0..from.len()).map(|i| self.came(i, &from[i], &to[i])).fold(0.0, f64::max)
    }

    /// How far the points of a solid come at most from one place to another, m.
    fn came(&self, item: usize, from: &Placement, to: &Placement) -> f64 {
        match self.items[item].body {
            None | Some(0) => 0.0,
            // a turn by φ moves a point at the distance r by 2 r sin(φ/2); the norm of the difference is √2 times that of r = 1
            Some(_) => {
                let turned = (to.rotation - from.rotation).norm() / std::f64::consts::SQRT_2;
                (to.translation - from.translation).norm() + turned * self.reach[item]
            }
        }
    }
}
