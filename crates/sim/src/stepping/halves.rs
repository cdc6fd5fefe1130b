//! Whether steps of fixed size are short enough: now and then, the more rarely the longer a run is, a step is compared with its two
//! halves, from the states at hand and with the modes as they are.
//!
//! A method of fixed step has no estimate of its error. Beyond its limit of stability it goes on, and where a limiter, a diode or friction
//! bounds what grows, its results even look sound; each step is then far from its halves.

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{FixedMethod, Solver};
use blocksim_solve::{FixedStep, Stepper};

use crate::evaluation::evaluate::Diagram;
use crate::stepping::methods::fixed;
use crate::{Simulation, diagnose};

/// Steps before the first look, and which part of the steps so far lies between two.
const FIRST: u64 = 4;
const SHARE: u64 = 8;
/// Where one has found something, so many of the steps that follow are looked at as well.
const MORE: u32 = 4;
/// What a step may be shorter than the longest one of late, which is forgotten so slowly, to be looked at.
const SHORTER: f64 = 0.5;
const FORGETS: f64 = 0.9;
/// Error of a step, as a part of the greatest size of a state, that is told.
const TOLD: f64 = 1e-3;
/// So many looks must have found it: an event within a step or the begin of a transient is no more than one.
const OFTEN: u32 = 3;
/// What is late counts from this part of its size on, this part of a step before its end.
const LATE: f64 = 0.02;
const BEFORE: f64 = 1e-6;
/// States smaller than this part of the largest one are noise.
const NOISE: f64 = 1e-12;

/// What looks have found.
pub(crate) struct Halves {
    method: FixedMethod,
    step: f64,
    stepper: FixedStep,
    /// Number of steps at which the next look is due, and how many of the next ones are looked at before.
    next: u64,
    more: u32,
    /// Length of the longest step of late, s: events and hits may cut all of them.
    longest: f64,
    /// States after a step, and after two of half its size.
    whole: Vec<f64>,
    halved: Vec<f64>,
    of_states: Vec<OfState>,
    late: Late,
}

/// What is remembered between two calls.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Memory {
    next: u64,
    more: u32,
    longest: f64,
    of_states: Vec<OfState>,
    late: Late,
}

/// What has changed late.
#[derive(Debug, Clone, Default, PartialEq)]
struct Late {
    /// How many looks have found so.
    found: u32,
    /// How far it was beyond at most, and the greatest size of it.
    beyond: f64,
    size: f64,
    what: String,
}

/// What is known of a state.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct OfState {
    /// The greatest value so far, and the greatest error of a step.
    size: f64,
    error: f64,
    /// How many looks have found the error too large for the size of that time, and when the first did, s.
    found: u32,
    since: f64,
}

impl Halves {
    /// Nothing for a method that chooses its steps.
    pub(crate) fn new(solver: Solver, states: usize) -> Option<Self> {
        let Solver::Fixed { method, step } = solver else { return None };
        (states > 0).then(|| Self {
            method,
            step,
            stepper: fixed(method, states, step),
            next: FIRST,
            more: 0,
            longest: 0.0,
            whole: vec![0.0; states],
            halved: vec![0.0; states],
            of_states: vec![OfState::default(); states],
            late: Late::default(),
        })
    }

    /// What is remembered of the run.
    pub(crate) fn memory(&self) -> Memory {
        Memory {
            next: self.next,
            more: self.more,
            longest: self.longest,
            of_states: self.of_states.clone(),
            late: self.late.clone(),
        }
    }

    pub(crate) fn recall(&mut self, memory: &Memory) {
        (self.next, self.more, self.longest) = (memory.next, memory.more, memory.longest);
        self.of_states.clone_from(&memory.of_states);
        self.late.clone_from(&memory.late);
    }

    /// Compares the step from (`t`, `x`) to `end` with its halves. Where one of them cannot be made, there is nothing to be seen.
    fn look(&mut self, system: &mut Diagram, t: f64, x: &[f64], end: f64) {
        self.more = self.more.saturating_sub(1);
        let Self { stepper, whole, halved, .. } = self;
        let mut go = |x: &mut [f64], ends: &[f64]| {
            let mut t = t;
            ends.iter().all(|end| stepper.step(system, &mut t, x, *end).is_ok())
        };
        whole.copy_from_slice(x);
        halved.copy_from_slice(x);
        if !(go(whole, &[end]) && go(halved, &[t + 0.5 * (end - t), end])) {
            return;
        }
        // Just before what is due at the end.
        let late = system.continuous(end - BEFORE * (end - t), whole).ok().and_then(|()| system.lateness());
        if let Some((beyond, size, what)) = late {
            self.late.found += u32::from(beyond > LATE * size);
            self.late.size = self.late.size.max(size);
            if beyond > self.late.beyond {
                self.late.beyond = beyond;
                self.late.what.clear();
                self.late.what.push_str(what);
            }
        }
        let largest = x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let mut is_news = false;
        for (((state, x), whole), halved) in self.of_states.iter_mut().zip(x).zip(whole).zip(halved) {
            let off = (*whole - *halved).abs();
            state.size = state.size.max(x.abs());
            state.error = state.error.max(off);
            if off > TOLD * state.size.max(NOISE * largest) {
                is_news |= state.found == 0;
                state.found += 1;
                state.since = if state.found == 1 { t } else { state.since };
            }
        }
        self.more = if is_news { MORE } else { self.more };
    }

    /// The state that steps are too long for, and by how much of its size one is off.
    fn worst(&self) -> Option<(usize, f64)> {
        let largest = self.of_states.iter().fold(0.0_f64, |most, state| most.max(state.size));
        let share = |state: &OfState| state.error / state.size.max(NOISE * largest);
        let found = self.of_states.iter().enumerate().filter(|(_, state)| state.found >= OFTEN);
        let told = found.map(|(index, state)| (index, share(state))).filter(|(_, share)| *share > TOLD);
        told.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

impl Simulation {
    /// Looks whether steps are short enough, if it is time to; the step at hand ends at `end`.
    pub(crate) fn look_at_halves(&mut self, end: f64) {
        let is_due = self.steps_to_look() == 0;
        let steps = self.grid.as_ref().map_or(0, |grid| grid.next());
        let Some(halves) = &mut self.halves else { return };
        let length = (end - self.t).min(halves.step);
        halves.longest = length.max(FORGETS * halves.longest);
        // What is left up to an event says little.
        if is_due && length >= SHORTER * halves.longest {
            halves.next = steps + (steps / SHARE).max(FIRST);
            self.compare_with_halves(end);
        }
    }

    /// How many steps are to be made before the next look.
    pub(crate) fn steps_to_look(&self) -> u64 {
        let steps = self.grid.as_ref().map_or(0, |grid| grid.next());
        let due = |halves: &Halves| if halves.more > 0 { 0 } else { halves.next.saturating_sub(steps) };
        self.halves.as_ref().map_or(u64::MAX, due)
    }

    fn compare_with_halves(&mut self, end: f64) {
        let Some(halves) = &mut self.halves else { return };
        halves.look(&mut self.diagram, self.t, &self.x, end.min(self.t + halves.step));
        self.forget_look();
    }

    /// Puts the signals back to the present states.
    fn forget_look(&mut self) {
        self.diagram.failure = None;
        self.diagram.forget();
        // What fails here fails in the step itself, which says why.
        _ = self.diagram.continuous(self.t, &self.x);
    }

    /// A warning where fixed steps are too long for a state.
    pub(crate) fn too_long_for(&mut self) -> Option<Problem> {
        // What grows has grown since the last look, or has begun to.
        let (mut t, mut x) = (self.t, self.x.clone());
        for _ in 0..OFTEN {
            let halves = self.halves.as_mut()?;
            let end = t + if halves.longest > 0.0 { halves.longest } else { halves.step };
            halves.look(&mut self.diagram, t, &x, end);
            x.clone_from(&halves.whole);
            t = end;
        }
        self.forget_look();
        let halves = self.halves.as_ref()?;
        let help = "take shorter steps until results stay as they are (`--verify` compares with half the step), or a method that chooses its \
             steps, such as `Auto`";
        let Late { found, beyond, size, what } = &halves.late;
        if *found >= OFTEN && *beyond > LATE * size {
            let message = format!(
                "a fixed step of {} s is too long for the valves of `{what}`, which change at the ends of steps alone: they conduct up to {:.0} % \
                 of the largest current backward by then",
                halves.step,
                100.0 * beyond / size
            );
            return Some(Problem::warning("coarse_step", message).help(help));
        }
        let (state, share) = halves.worst()?;
        let name = diagnose::state_names(&self.schedule).swap_remove(state);
        let message = format!(
            "a fixed step of {} s is too long for `{name}`: `{:?}` is off by {:.1e} of its size in a single step, first at {:.3e} s",
            halves.step, halves.method, share, halves.of_states[state].since,
        );
        Some(Problem::warning("coarse_step", message).help(help))
    }
}
