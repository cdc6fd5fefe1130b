//! Elastic parts between two parts that turn or slide: the deflection is a state, and a law says what it transmits.

use std::fmt::Debug;

use blocksim_block::prelude::*;

use super::quantities::Quantities;
use crate::multibody::joint_limit::{guard_of_side, settle};

/// What a deflection and its speed transmit. Units are those of rotation; in translation m, m/s and N.
///
/// Where the torque jumps as two sides meet, it is a discrete state of each side whether it touches, 1, or not, 0: steps then see
/// one side of the jump alone. Elsewhere `touches` is empty.
pub trait ElasticLaw: Debug + Send + Sync + 'static {
    /// Torque from `r` to `c`.
    fn load(&self, deflection: f64, speed: f64, touches: &[f64]) -> Torque;

    /// Energy that is stored, and what becomes heat.
    fn energy(&self, deflection: f64, speed: f64, touches: &[f64]) -> Energy;

    /// Adds the events where the law has kinks or jumps.
    fn events(&self, part: Part) -> Part;

    /// How far these are: those of the sides first, negative where they press.
    fn distances(&self, deflection: f64, speed: f64, g: &mut [f64]);

    /// The guards: distances, and for a side that is known to touch how deep it is.
    fn guards(&self, deflection: f64, speed: f64, touches: &[f64], g: &mut [f64]) {
        self.distances(deflection, speed, g);
        g.iter_mut().zip(touches).for_each(|(g, touches)| *g = guard_of_side(Some(touches), *g));
    }

    /// Finds which sides touch; returns whether any has changed.
    fn settle(&self, deflection: f64, speed: f64, touches: &mut [f64]) -> bool {
        let mut changed = false;
        if let [lower, upper] = touches {
            let mut apart = [0.0; 2];
            self.distances(deflection, speed, &mut apart);
            for (touches, apart) in [lower, upper].into_iter().zip(apart) {
                changed |= settle(touches, apart);
            }
        }
        changed
    }
}

/// An elastic part.
#[derive(Debug)]
pub struct Elastic<L> {
    pub(crate) law: L,
    pub(crate) quantities: &'static Quantities,
    /// Deflection at the start.
    pub(crate) start: f64,
}

impl<L: ElasticLaw> Component for Elastic<L> {
    fn part(&self, _given: &Given) -> Part {
        self.law.events(self.quantities.elastic(self.start)).guards_of_state()
    }

    fn torques(&self, c: &Flowing, tau: &mut [Torque]) {
        tau[0] = self.law.load(c.x[0], c.speed[0], c.d);
    }

    fn jump(&self, c: &Flowing, _x: &mut [f64], d: &mut [f64]) -> bool {
        self.law.settle(c.x[0], c.speed[0], d)
    }

    fn guards_of_state(&self, c: &Moving, g: &mut [f64]) {
        self.law.guards(c.x[0], c.speed[0], c.d, g);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }

    fn energy(&self, c: &Flowing) -> Energy {
        self.law.energy(c.x[0], c.speed[0], c.d)
    }
}
