//! Elastic parts between two parts that turn or slide: the deflection is a state, and a law says what it transmits.

use std::fmt::Debug;

use blocksim_block::prelude::*;

use super::quantities::Quantities;

/// What a deflection and its speed transmit. Units are those of rotation; in translation m, m/s and N.
pub trait ElasticLaw: Debug + Send + Sync + 'static {
    /// Torque from `r` to `c`.
    fn load(&self, deflection: f64, speed: f64) -> Torque;

    /// Energy that is stored, and what becomes heat.
    fn energy(&self, deflection: f64, speed: f64) -> Energy;

    /// Adds the events where the law has kinks.
    fn events(&self, part: Part) -> Part;

    /// How far these are.
    fn guards(&self, deflection: f64, speed: f64, g: &mut [f64]);
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
        tau[0] = self.law.load(c.x[0], c.speed[0]);
    }

    fn guards_of_state(&self, c: &Moving, g: &mut [f64]) {
        self.law.guards(c.x[0], c.speed[0], g);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }

    fn energy(&self, c: &Flowing) -> Energy {
        self.law.energy(c.x[0], c.speed[0])
    }
}
