//! How far the solids of each pair are apart at least, from pose to pose.

use blocksim_multibody::Placement;
use nalgebra::Vector3;

use crate::collision::check::Check;
use crate::collision::distance::{Distance, separation};

/// What rounding may make of a distance, m.
const ROUNDING: f64 = 1e-10;

/// Of each pair a distance is kept that it has at least. From pose to pose this shrinks by what both solids move by at
/// most, so a pair is measured anew only where it may have come near enough to matter.
#[derive(Debug)]
pub(crate) struct Apart<'c> {
    check: &'c Check,
    /// Of all solids in the present pose.
    places: Vec<Placement>,
    /// How far each solid has come since the pose before, at most, m.
    came: Vec<f64>,
    /// Of each pair, m.
    least: Vec<f64>,
    /// Of each pair, the direction from the second solid to the first where they were measured last; zero before.
    across: Vec<Vector3<f64>>,
}

impl<'c> Apart<'c> {
    /// Before the first pose nothing is known.
    pub fn new(check: &'c Check) -> Self {
        Apart {
            check,
            places: Vec::new(),
            came: vec![0.0; check.items.len()],
            least: vec![f64::NEG_INFINITY; check.pairs.len()],
            across: vec![Vector3::zeros(); check.pairs.len()],
        }
    }

    /// Goes on to a pose of the bodies, the world first.
    pub fn go(&mut self, poses: &[Placement]) {
        let places = self.check.places(poses);
        for (i, (from, to)) in self.places.iter().zip(&places).enumerate() {
            self.came[i] = self.check.came(i, from, to);
        }
        for (least, pair) in self.least.iter_mut().zip(&self.check.pairs) {
            *least -= self.came[pair.of[0]] + self.came[pair.of[1]];
        }
        self.places = places;
    }

    /// The distance of a pair, unless it is known to be `enough` or more. To be asked once in a pose.
    pub fn measured(&mut self, pair: usize, enough: f64) -> Option<Distance> {
        let (check, [i, k]) = (self.check, self.check.pairs[pair].of);
        let least = &mut self.least[pair];
        if *least >= enough {
            return None;
        }
        let centres = (self.places[i].translation - self.places[k].translation).norm();
        let bound = centres - check.reach[i] - check.reach[k];
        if bound >= enough {
            *least = bound;
            return None;
        }
        // Along the direction of the last measurement they are nearly as far apart as they are at all.
        let across = &mut self.across[pair];
        let [a, b] = [i, k].map(|n| &check.items[n].solid);
        let bound = separation(a, &self.places[i], b, &self.places[k], across) - ROUNDING;
        if bound >= enough {
            *least = bound;
            return None;
        }
        let found = check.between(i, k, &self.places);
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
