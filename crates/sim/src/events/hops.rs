//! Hops that are lower than the tolerance.
//!
//! A guard with a direction that has fired is on its far side. Where what it has set off leads it back (a ball is thrown up
//! again), it comes back and may fire once more. A hop that is lower than the tolerance may be lost in a step of a method of
//! low order, which is never back, or said to fall as soon as it is: from then on nothing would fire any more, or fire on
//! the way up, and the ball falls through the floor. Such a step is known by a dense output that sets out to the other side
//! than the derivative at its start says, and ends the run with an error.

use blocksim_block::Crossing;
use blocksim_solve::System;

use crate::events::crossings::Cut;
use crate::{SimError, Simulation};

/// Part of the step that is its very start.
const EARLY: f64 = 1.0 / 1024.0;

/// Whether a guard is on the side that it has after it has fired.
fn is_beyond(crossing: Crossing, value: f64) -> bool {
    match crossing {
        Crossing::Rising => value >= 0.0,
        Crossing::Falling => value <= 0.0,
        _ => false,
    }
}

impl Simulation {
    /// Notes the guards that may hop in the step to come.
    pub(crate) fn note_hops(&mut self) {
        let guards = &mut self.guards;
        guards.left.copy_from_slice(&guards.fired);
        for i in 0..guards.hops.len() {
            guards.hops[i] = guards.fired[i] && is_beyond(guards.events[i], guards.start[i]);
        }
    }

    /// Checks that no hop got lost in the step from `t0`, in which `cut` was found.
    pub(crate) fn find_hops(&mut self, t0: f64, cut: Option<Cut>) -> Result<(), SimError> {
        match self.lost_hop(t0, cut) {
            Some((i, t)) if self.is_contradicted(t0, t, i)? => Err(self.lost(i)),
            _ => Ok(()),
        }
    }

    /// A guard that has not come back by the end of the step, or is said to have fired as soon as it began; and a time before.
    fn lost_hop(&self, t0: f64, cut: Option<Cut>) -> Option<(usize, f64)> {
        let guards = &self.guards;
        let early = t0 + EARLY * (self.t - t0);
        let directed = |i: usize| matches!(guards.events[i], Crossing::Rising | Crossing::Falling);
        let mut all = 0..guards.events.len();
        let found = match cut {
            None => (all.find(|&i| guards.hops[i] && is_beyond(guards.events[i], guards.end[i])), early),
            Some(cut) if cut.crossed && cut.t < early => (
                all.find(|&i| guards.fired[i] && directed(i) && guards.is_awaited(i)),
                t0 + 0.25 * (cut.t - t0),
            ),
            Some(_) => (None, early),
        };
        found.0.filter(|_| found.1 > t0 && self.stepper.is_some()).map(|i| (i, found.1))
    }

    /// Whether guard `i` sets out towards the side from which it fires as the derivatives at the start of the step say, and to
    /// the other one as the dense output does at `t`.
    fn is_contradicted(&mut self, t0: f64, t: f64, i: usize) -> Result<bool, SimError> {
        let Self { guards, diagram, kinks, stepper, .. } = self;
        let sign = if guards.events[i] == Crossing::Rising { -1.0 } else { 1.0 };
        // What was found lies in other places of the guards.
        let values = &mut guards.low;
        let mut contradicted = || {
            diagram.derivatives(t0, &kinks.x, &mut kinks.ahead)?;
            diagram.minor(t0, &kinks.x)?;
            diagram.guards(values)?;
            let before = values[i];
            kinks.ahead.iter_mut().zip(&kinks.x).for_each(|(x, x0)| *x = x0 + (t - t0) * *x);
            diagram.minor(t, &kinks.ahead)?;
            diagram.guards(values)?;
            let said = sign * (values[i] - before);
            stepper.iter().for_each(|stepper| stepper.interpolate(t, &mut kinks.ahead));
            diagram.minor(t, &kinks.ahead)?;
            diagram.guards(values)?;
            Ok(said > 0.0 && sign * (values[i] - before) < 0.0)
        };
        let contradicted = contradicted();
        self.held(contradicted)
    }

    fn lost(&self, guard: usize) -> SimError {
        let (path, what) = self.named(Some(guard));
        let message = format!(
            "{what}, and comes back by less than the tolerance resolves, so that the next time cannot be found"
        );
        SimError::new("endless_events", self.t, message).at(path).help(
            "give the law a state of rest, for instance a speed below which an impact ends in contact; or take a smaller \
             `rtol`, or a method of higher order such as Ode45",
        )
    }
}
