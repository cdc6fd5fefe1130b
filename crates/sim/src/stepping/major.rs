//! What happens at one instant: hits, outputs, jumps, record; and the updates that end it.

use std::sync::Arc;

use blocksim_block::schedule::Instance;
use blocksim_solve::Failed;

use crate::{Observer, SimError, Simulation, diagnose};

/// Repetitions of an instant, because something jumps, that are taken for chatter.
const JUMPS: u32 = 1000;

/// Why there is a major step.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Arrival {
    /// A guard has crossed zero or a time event has come: outputs may change by a jump, and a row is due.
    pub event: bool,
    /// The step of the solver was cut short.
    pub cut: bool,
    /// The simulation ends here.
    pub end: bool,
}

/// Reports the jump of a block, unless others have the words for it.
pub(crate) fn report_jump(block: &Instance, t: f64, observer: &mut dyn Observer) {
    let phrase = block.interface.jump_phrase.0;
    if !phrase.is_empty() {
        observer.event(t, &block.path, phrase);
    }
}

impl Simulation {
    /// The first major step, which evaluates constants as well.
    pub(crate) fn start(&mut self, observer: &mut dyn Observer) -> Result<(), SimError> {
        self.started = true;
        self.instant(Arrival { end: true, ..Arrival::default() }, true, observer)?;
        self.sizes.begin(&self.x);
        self.floors.begin(self.t, &self.x);
        Ok(())
    }

    /// A major step.
    pub(crate) fn major(&mut self, why: Arrival, observer: &mut dyn Observer) -> Result<(), SimError> {
        self.instant(why, false, observer)
    }

    fn instant(&mut self, why: Arrival, first: bool, observer: &mut dyn Observer) -> Result<(), SimError> {
        self.majors += 1;
        self.hit_count += self.hits.strike(self.t);
        self.diagram.settle.changed = false;
        self.diagram.hold_steps();
        let reset = self.jump_early(first, observer)?;
        self.pass(first)?;
        // At the start there is no before.
        let mut told = first;
        if let Some(before) = self.rows.jumped_from() {
            observer.row(self.t, before);
            told = true;
        }
        let jumped = self.jump(told, observer)? || reset;
        self.diagram.hold_outputs();
        self.report_modes(first, observer);
        let ends = self.diagram.now.fault.ends();
        if self.rows.are_due(self.t) || why.event || why.end || jumped || ends {
            observer.row(self.t, &self.rows.values);
        }
        if let Some(grid) = &mut self.grid {
            grid.pass(self.t);
        }
        self.guards.known = false;
        let busy = self.hits.due.iter().zip(&self.diagram.plan.busy).any(|(&due, &busy)| due && busy);
        if why.event || why.cut || jumped || self.diagram.settle.changed || busy {
            self.past.fresh = true;
        }
        if why.event || why.cut || jumped || self.diagram.settle.changed {
            self.guards.turns.forget();
        }
        let is_other = why.event || why.cut || jumped || self.is_discontinuous();
        // What blocks note at a step stands in their guards from there.
        if is_other || !self.diagram.plan.accepting.is_empty() {
            self.guards.turns.forget_slopes();
        }
        if is_other {
            self.stepper.iter_mut().for_each(|stepper| stepper.restart());
        }
        self.relearnt = false;
        Ok(())
    }

    /// The present instant once more, with other states or signals: modes are chosen and outputs evaluated anew, but the rates
    /// that are hit stay hit. Returns whether anything jumped.
    pub(crate) fn repeat_instant(&mut self, observer: &mut dyn Observer) -> Result<bool, SimError> {
        self.diagram.settle.changed = false;
        self.diagram.hold_steps();
        let reset = self.jump_early(false, observer)?;
        self.rows.forget_before();
        self.pass(false)?;
        let jumped = self.jump(true, observer)?;
        self.guards.known = false;
        self.guards.turns.forget();
        self.guards.turns.forget_slopes();
        self.past.fresh = true;
        self.relearnt = false;
        self.stepper.iter_mut().for_each(|stepper| stepper.restart());
        Ok(jumped || reset)
    }

    /// The present instant with other parameters: everything is evaluated, constants as well, and what jumps by that has a row on both
    /// sides, of which the one before has been recorded.
    pub(crate) fn begin_anew(&mut self, observer: &mut dyn Observer) -> Result<(), SimError> {
        self.diagram.settle.changed = false;
        self.pass(true)?;
        // A delay with another length has passed other jumps.
        self.reach()?;
        self.diagram.hold_steps();
        self.jump_early(false, observer)?;
        self.rows.forget_before();
        self.pass(true)?;
        self.jump(true, observer)?;
        self.diagram.hold_outputs();
        self.report_modes(false, observer);
        observer.row(self.t, &self.rows.values);
        let between = self.diagram.update_between(self.t + self.same());
        self.held(between)?;
        self.guards.known = false;
        self.guards.turns.forget();
        self.guards.turns.forget_slopes();
        self.past.fresh = true;
        self.relearnt = false;
        Ok(())
    }

    /// Whether derivatives just behind this instant may differ from those just before it.
    fn is_discontinuous(&self) -> bool {
        let plan = &self.diagram.plan;
        let mut rates = self.hits.due.iter().zip(&plan.bending);
        self.diagram.settle.changed
            || self.diagram.has_stepped()
            || self.relearnt
            || rates.any(|(&due, &bends)| due && bends)
    }

    /// Evaluates the whole diagram and takes the row.
    fn pass(&mut self, first: bool) -> Result<(), SimError> {
        let evaluated = self.diagram.major(self.t, &self.x, &self.hits.due, first);
        self.held(evaluated)?;
        let finite = self.rows.take(&self.diagram.signals) && self.x.iter().all(|x| x.is_finite());
        if finite { Ok(()) } else { Err(diagnose::not_finite(&self.schedule, &self.diagram, &self.x)) }
    }

    /// Repeats the instant while something jumps; the row before the first jump is recorded unless one of before this instant has
    /// been `told`: what stands between the jump of an input and that of the modes which answer it is nobody's state. Returns
    /// whether any did.
    fn jump(&mut self, told: bool, observer: &mut dyn Observer) -> Result<bool, SimError> {
        if self.diagram.plan.jumping.is_empty() {
            return Ok(false);
        }
        let (schedule, t) = (Arc::clone(&self.schedule), self.t);
        for round in 0..=JUMPS {
            let mut last = None;
            let jumps = self.diagram.jump(&mut self.x, |block| {
                last = Some(block);
                if round == 0 {
                    report_jump(&schedule.blocks[block], t, observer);
                }
            });
            self.held(jumps)?;
            match last {
                None => return Ok(round > 0),
                Some(block) if round == JUMPS => {
                    let path = &schedule.blocks[block].path;
                    return Err(SimError::new("chatter", t, format!("`{path}` jumps without end"))
                        .at(path)
                        .help(format!(
                            "it has jumped {JUMPS} times at one instant; a jump must end its own cause"
                        )));
                }
                Some(_) if round == 0 && !told => observer.row(t, &self.rows.values),
                Some(_) => {}
            }
            self.pass(false)?;
        }
        Ok(true)
    }

    /// Advances the blocks whose rates are hit, and those that update between their hits, with the signals of this instant.
    pub(crate) fn update(&mut self) -> Result<(), SimError> {
        // At a hit a block is through with what lay before it.
        let between = self.diagram.update_between(self.t + self.same());
        self.held(between)?;
        let updated = self.diagram.update(&self.hits.due);
        self.held(updated)
    }

    /// Turns a failure of a block into an error.
    #[inline]
    pub(crate) fn held<T>(&mut self, result: Result<T, Failed>) -> Result<T, SimError> {
        result.map_err(|_| diagnose::failed(&self.schedule, &mut self.diagram))
    }
}
