//! Steps at which nothing is due but their own end: no sample is hit, no time event comes, no guard is watched, nobody remembers.
//! Of all that [`advance`](Simulation::advance) looks at nothing can be there, so the step is made and the instant at its end
//! evaluated, as far as somebody asks for it, and no more. The sizes of states are not noted: a method of fixed step has no tolerance
//! that could ignore one.

use blocksim_block::schedule::{Schedule, Solver};

use crate::program::plan::Plan;
use crate::rows::record::are_finite;
use crate::simulation::PATIENCE;
use crate::stepping::major::Arrival;
use crate::{Observer, SimError, Simulation, diagnose};

/// Whether steps of a diagram may be plain: nobody looks between their ends, and what is due next is known beforehand.
pub(crate) fn are_plain(schedule: &Schedule, plan: &Plan) -> bool {
    let is_fixed = matches!(schedule.settings.solver, Solver::Fixed { .. });
    let acting = [&plan.remembering, &plan.accepting, &plan.holding, &plan.jumping, &plan.subdividing];
    // Who reads nothing has no other plans for the time until its event than before, unless its discrete states change.
    let is_set = |block: &usize| {
        let block = &schedule.blocks[*block];
        block.gather.is_empty() && block.interface.states.is_empty()
    };
    is_fixed && schedule.states > 0 && acting.into_iter().all(Vec::is_empty) && plan.timed.iter().all(is_set)
}

/// Why steps in a row come to an end.
enum End {
    /// Something is due, or the next step is not of this sort.
    Due,
    /// A law has no value.
    Unmet,
    /// A value to be recorded is not finite.
    NotFinite,
    /// A mode has changed.
    Changed,
}

impl Simulation {
    /// Goes on as long as steps are plain, until the observer is to be asked at the latest. Events that are due, and hits, must be
    /// known as of the present instant, and their updates done. Returns whether there was any such step.
    pub(crate) fn go_plainly(&mut self, end: f64, observer: &mut dyn Observer) -> Result<bool, SimError> {
        let Some(grid) = self.grid.as_ref().filter(|_| self.diagram.plan.plain) else { return Ok(false) };
        let mut next = grid.time();
        let due = self.hits.times().iter().chain(&self.event_times).copied().fold(end, f64::min);
        let since = self.t;
        // What is meant to be one instant is left to those who know how.
        while next + self.resolution.same(next) < due {
            if self.dash(due, observer)? {
                break;
            }
            next = self.grid.as_ref().map_or(due, |grid| grid.time());
            if next + self.resolution.same(next) >= due {
                break;
            }
            self.step(next)?;
            let is_major = self.t >= next || self.diagram.plan.every_step || self.rows.grid.is_none();
            if self.rows.grid.is_some() {
                self.record_within(if is_major { self.t - self.same() } else { self.t }, observer)?;
            }
            if is_major {
                self.plain_instant(observer)?;
            }
            let is_over = self.diagram.settle.changed || self.diagram.now.fault.ends();
            let is_over = is_over || self.steps_to_look() == 0;
            if is_over || self.unasked >= PATIENCE || observer.is_waiting(self.t) {
                break;
            }
            self.unasked += 1;
            next = self.grid.as_ref().map_or(due, |grid| grid.time());
        }
        if self.t > since {
            // Whoever is next may ask for everything.
            self.complete()?;
        }
        Ok(self.t > since)
    }

    /// Steps that the diagram makes by itself, one after the other, as long as all is as it should be; the first one that is not is
    /// left to [`step`](Self::step). Returns whether others are to be heard before the next one.
    fn dash(&mut self, due: f64, observer: &mut dyn Observer) -> Result<bool, SimError> {
        let to_look = self.steps_to_look();
        let Self { diagram, stepper, grid: Some(grid), rows, hits, .. } = self else { return Ok(false) };
        let Some(single) = stepper.as_ref().and_then(|stepper| stepper.single()) else { return Ok(false) };
        if rows.grid.is_some() || !diagram.dashes() {
            return Ok(false);
        }
        diagram.forget();
        diagram.settle.changed = false;
        // From here on the outputs at the end of each step leave them there.
        diagram.plan.fused.place(self.t, &self.x, &mut diagram.signals);
        hits.due.fill(false);
        let (mut steps, mut before, mut is_over) = (0, self.t, false);
        let end = loop {
            let next = grid.time();
            let h = next - self.t;
            let is_plain = next + self.resolution.same(next) < due && 0.0 < h && h <= single;
            if !is_plain || is_over || !diagram.step_on(self.t, next, h, &mut self.x) {
                break End::Due;
            }
            (steps, before, self.t) = (steps + 1, self.t, next);
            let Some(changed) = diagram.outputs_plainly(self.t, &self.x) else { break End::Unmet };
            self.majors += 1;
            if !rows.take(&diagram.signals) {
                break End::NotFinite;
            }
            if changed {
                diagram.settle.changed = true;
                break End::Changed;
            }
            observer.row(self.t, &rows.values);
            _ = grid.pass(self.t);
            is_over = self.unasked >= PATIENCE || steps >= to_look || observer.is_waiting(self.t);
            self.unasked += u32::from(!is_over);
        };
        self.stepper.iter_mut().for_each(|stepper| stepper.made(steps, before, self.t));
        match end {
            End::Due => return Ok(is_over),
            End::Unmet => self.major(Arrival::default(), observer)?,
            End::NotFinite => {
                self.complete()?;
                return Err(diagnose::not_finite(&self.schedule, &self.diagram, &self.x));
            }
            End::Changed => {
                self.report_modes(false, observer);
                observer.row(self.t, &self.rows.values);
                self.grid.iter_mut().for_each(|grid| _ = grid.pass(self.t));
            }
        }
        Ok(true)
    }

    /// A major step at which nothing is due.
    fn plain_instant(&mut self, observer: &mut dyn Observer) -> Result<(), SimError> {
        self.diagram.settle.changed = false;
        self.floors.note(self.t, &self.x);
        let passed = self.diagram.pass_plainly(self.t, &self.x);
        if !self.held(passed)? {
            return self.major(Arrival::default(), observer);
        }
        self.majors += 1;
        self.hits.due.fill(false);
        let finite = self.rows.take(&self.diagram.signals) && are_finite(&self.x);
        if !finite {
            self.complete()?;
            return Err(diagnose::not_finite(&self.schedule, &self.diagram, &self.x));
        }
        self.report_modes(false, observer);
        if self.rows.are_due(self.t) {
            observer.row(self.t, &self.rows.values);
        }
        self.grid.iter_mut().for_each(|grid| _ = grid.pass(self.t));
        Ok(())
    }

    /// Evaluates the signals that plain steps have left out.
    fn complete(&mut self) -> Result<(), SimError> {
        let evaluated = self.diagram.continuous(self.t, &self.x);
        self.held(evaluated)
    }
}
