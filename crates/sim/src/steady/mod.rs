//! A steady state: where nothing moves, and if asked, where signals have given values (a *trim*).
//!
//! Sought are continuous states, sampled states, what memories give, and the values of constants that are free; found they are
//! where all derivatives are zero, the next sample changes nothing, memories are full of what comes in, and held
//! signals have their values. Time stands still meanwhile: what changes with time alone is what it is at that instant.
//!
//! Newton's method with steps of least norm leads there (`newton`, over the equations of `conditions`); blocks choose their
//! modes anew after each step. Where it does not get on (a brake that still slips, a controller at its limit), the model is
//! first let go for a while with growing implicit steps, as if time went on: pseudo-transient continuation, C. T. Kelley and
//! D. E. Keyes, SIAM J. Numer. Anal. 35 (1998) 508-523.

mod algebra;
mod conditions;
mod failure;
mod newton;

use std::sync::Arc;

use blocksim_block::schedule::{Schedule, Start, Steady};

use self::conditions::Conditions;
use self::newton::{Failure, Search};
use crate::variation::frozen::Nobody;
use crate::{SimError, Simulation, diagnose};

/// How far a state may be from where it was, as a multiple of its size or of 1, without being looked at again.
const FAR: f64 = 1e6;

/// Searches at most, the later ones with states that have been brought together.
const ROUNDS: usize = 4;

/// A steady state that was found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rest {
    /// States that go on moving all the same, as nothing depends on them, with what they move by in a second.
    pub adrift: Vec<(String, f64)>,
    /// Unknowns that the conditions do not determine (integrators without feedback); they are as near as can be to where
    /// the search began.
    pub undetermined: Vec<String>,
    /// Values of the constants that were free, in SI units, in the order of `Steady::free`.
    pub found: Vec<f64>,
    /// Evaluations of the model that the search took.
    pub evaluations: usize,
}

impl Simulation {
    /// Brings a simulation to a steady state near its present one. Without `strict`, any state on which nothing depends may go
    /// on moving, otherwise only those of which blocks say so (`Interface::drifting`). `go` is asked now and
    /// then whether to go on.
    ///
    /// # Errors
    /// `no_steady_state` with what keeps moving, or if `go` says no; see [`SimError::code`].
    pub fn seek_rest(
        &mut self,
        asked: &Steady,
        strict: bool,
        go: &mut dyn FnMut() -> bool,
    ) -> Result<Rest, SimError> {
        // Whether what stands still is enabled at rest would have to be found, too.
        if let Some(held) = self.schedule.blocks.iter().find(|block| block.interface.holds.is_some()) {
            let message = format!(
                "`{}` is inside a conditional subsystem, for which no steady state is sought",
                held.path
            );
            return Err(SimError::new("no_steady_state", self.t, message)
                .at(&held.path)
                .help("begin at given initial values, or remove `enable`, `trigger` and `reset` from the subsystem for the search"));
        }
        if !self.started {
            self.start(&mut Nobody)?;
        }
        for free in &asked.free {
            self.diagram.pinned.push(free.block);
        }
        self.diagram.seek_rest(true, &mut self.x);
        let before = self.x.clone();
        let found = self.search(asked, strict, go);
        self.diagram.seek_rest(false, &mut self.x);
        let evaluated = self.diagram.continuous(self.t, &self.x);
        self.held(evaluated)?;
        let found = found?;
        // What holds states together in a search outweighs all else where they have grown without end: then the rest is looked at without it.
        let is_far = |(before, after): (&f64, &f64)| after.abs() > FAR * before.abs().max(1.0);
        if before.iter().zip(&self.x).any(is_far) {
            let conditions = Conditions::new(self, asked, strict);
            let judged =
                Search::new(conditions, go, &mut None).judge().and_then(|lost| lost.map_or(Ok(()), Err));
            judged.map_err(|failure| self.failed(asked, failure))?;
        }
        Ok(found)
    }

    fn failed(&self, asked: &Steady, failure: Failure) -> SimError {
        match failure {
            Failure::Simulation(error) => error,
            Failure::Interrupted => SimError::new("no_steady_state", self.t, "the search was interrupted"),
            Failure::Restless(lost) => failure::restless(self, asked, &lost),
        }
    }

    /// Searches, and searches again where states had to be brought together.
    fn search(
        &mut self,
        asked: &Steady,
        strict: bool,
        go: &mut dyn FnMut() -> bool,
    ) -> Result<Rest, SimError> {
        let (mut evaluations, mut round, mut begin) = (0, 0, None);
        let names = diagnose::state_names(&self.schedule);
        let mut fitted: Vec<bool> = vec![false; self.x.len()];
        loop {
            round += 1;
            let conditions = Conditions::new(self, asked, strict);
            let mut rest = Search::new(conditions, go, &mut begin)
                .run(round + 1 == ROUNDS)
                .map_err(|failure| self.failed(asked, failure))?;
            evaluations += rest.evaluations;
            let evaluated = self.diagram.continuous(self.t, &self.x);
            self.held(evaluated)?;
            let before = self.x.clone();
            let Some((block, differs)) = self.diagram.fit(&mut self.x) else {
                let is_fitted =
                    |name: &String| names.iter().zip(&fitted).any(|(other, is)| *is && other == name);
                rest.undetermined.retain(|name| !is_fitted(name));
                rest.evaluations = evaluations;
                return Ok(rest);
            };
            fitted
                .iter_mut()
                .zip(before.iter().zip(&self.x))
                .for_each(|(is, (before, after))| *is |= before != after);
            if round == ROUNDS {
                let path = &self.schedule.blocks[block].path;
                let message = format!("no steady state was found: {differs}");
                return Err(SimError::new("no_steady_state", self.t, message).at(path).help(
                    "begin at given initial values; where parts have one current or one voltage in common, put one part in their place",
                ));
            }
        }
    }

    /// A simulation at the start that its settings ask for.
    pub(crate) fn at_start(schedule: Arc<Schedule>) -> Result<Self, SimError> {
        let mut simulation = Self::given(Arc::clone(&schedule))?;
        let Start::Steady(asked) = &schedule.settings.start else { return Ok(simulation) };
        let rest = simulation.seek_rest(asked, true, &mut || true)?;
        // The run itself begins afresh, so that its first instant is like any other.
        let mut fresh = Self::given(Arc::clone(&schedule))?;
        fresh.x.clone_from(&simulation.x);
        fresh.diagram.d.clone_from(&simulation.diagram.d);
        fresh.diagram.signals.clone_from(&simulation.diagram.signals);
        // Where an algebraic loop has several solutions, the run goes on with the one that was found.
        fresh.diagram.loops.anchors.clone_from(&simulation.diagram.loops.anchors);
        fresh.diagram.pinned = simulation.diagram.pinned;
        fresh.rest = Some(rest);
        Ok(fresh)
    }

    /// The steady state that the run began in, if its settings ask for one.
    pub fn rest(&self) -> Option<&Rest> {
        self.rest.as_ref()
    }
}
