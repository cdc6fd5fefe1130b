//! Parameters that change while a run goes on: at times that were named before, or when somebody asks for it.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;

use blocksim_diagram::{SourceFile, Sources, compile};
use blocksim_sim::{Ended, Observer, SimError, Simulation};

use crate::args::model::{ModelArgs, SolverArgs};
use crate::disk::{Disk, Overlaid};
use crate::failure::Failure;
use crate::running::{interrupt, solver};
use crate::trust::{Plugins, Purpose};

/// What came of a parameter that was to change: blocks whose values at the start it changes as well, or why it is refused and what
/// helps.
pub type Came = Result<Vec<String>, (String, Option<String>)>;

/// An observer that wants parameters to change.
pub trait Tunes: Observer {
    /// When something is to be set next, as far as that is known before, s.
    fn planned(&self) -> Option<f64>;

    /// What is to be set now, if anything is.
    fn wanted(&mut self, t: f64) -> Option<String>;

    /// What came of it.
    fn tuned(&mut self, t: f64, set: &str, came: Came);
}

/// Parameters that change at times that are known before.
#[derive(Debug, Default)]
pub struct Planned {
    changes: VecDeque<(f64, String)>,
}

impl Planned {
    /// Changes in the order of their times.
    pub fn new(changes: &[(f64, String)]) -> Planned {
        let mut changes = changes.to_vec();
        changes.sort_by(|a, b| a.0.total_cmp(&b.0));
        Planned { changes: changes.into() }
    }

    /// When the next one is due, s.
    pub fn time(&self) -> Option<f64> {
        self.changes.front().map(|(at, _)| *at)
    }

    /// The next one that is due.
    pub fn next(&mut self, t: f64) -> Option<String> {
        if self.time()? <= t { self.changes.pop_front().map(|(_, set)| set) } else { None }
    }
}

/// What makes the model anew, from the texts of the start.
pub struct Tuner<'a> {
    model: PathBuf,
    /// What is set.
    set: Vec<String>,
    args: &'a ModelArgs,
    solver: &'a SolverArgs,
    /// Texts that the model was made of.
    texts: Vec<SourceFile>,
}

impl<'a> Tuner<'a> {
    /// One for a run of a model.
    pub fn new(args: &'a ModelArgs, solver: &'a SolverArgs, texts: &[SourceFile]) -> Tuner<'a> {
        Tuner { model: args.model.clone(), set: args.set.clone(), args, solver, texts: texts.to_vec() }
    }

    /// Runs to the end, with the changes that the observer wants.
    ///
    /// # Errors
    /// Those of the run.
    pub fn run(&mut self, simulation: &mut Simulation, observer: &mut dyn Tunes) -> Result<Ended, SimError> {
        loop {
            let stop = simulation.schedule().settings.stop_time;
            // A step ends where something is to be set.
            let planned = observer.planned().filter(|at| *at < stop);
            let ended = simulation.run_until(planned.unwrap_or(stop), observer)?;
            let is_asked = ended == Ended::Interrupted && !interrupt::is_requested();
            let is_there = ended == Ended::Finished && planned.is_some();
            if !is_asked && !is_there {
                return Ok(ended);
            }
            let t = simulation.time();
            let mut wanted = false;
            while let Some(set) = observer.wanted(t) {
                wanted = true;
                let came = self.tune(simulation, &set, observer);
                observer.tuned(t, &set, came);
            }
            if !wanted {
                return Ok(ended);
            }
        }
    }

    /// Sets one more parameter.
    fn tune(&mut self, simulation: &mut Simulation, set: &str, observer: &mut dyn Observer) -> Came {
        let mut all = self.set.clone();
        all.push(set.to_owned());
        let disk = Disk::with(Plugins::of(self.args.plugins, Purpose::Run));
        let texts = self.texts.iter().map(|file| (file.path.clone(), file.text.to_string())).collect();
        let reader = Overlaid { disk, texts };
        let mut compiled = compile(&Sources::new(&reader), &self.model, &all);
        let Some(mut schedule) = compiled.schedule.take() else {
            let first = compiled.problems.into_iter().next();
            return Err(first
                .map_or(("it cannot be set".to_owned(), None), |problem| (problem.message, problem.help)));
        };
        solver::apply(self.solver, &mut schedule.settings).map_err(refusal)?;
        let without_effect =
            simulation.tune(Arc::new(schedule), observer).map_err(|error| (error.message, error.help))?;
        self.set = all;
        Ok(without_effect)
    }
}

fn refusal(failure: Failure) -> (String, Option<String>) {
    let message = failure.message();
    (message, failure.into_problems().into_iter().find_map(|problem| problem.help))
}

/// A setting as an event of the parameter that it names: `is set to 9 1/s`, and what of it has no effect.
pub fn event<'s>(set: &'s str, without_effect: &[String]) -> (&'s str, String) {
    let (target, value) = set.split_once('=').unwrap_or((set, ""));
    let lost = match without_effect {
        [] => String::new(),
        blocks => format!(" (values at the start of {} have no effect any more)", blocks.join(", ")),
    };
    (target.trim(), format!("is set to {}{lost}", value.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_come_in_the_order_of_their_times() {
        let mut planned =
            Planned::new(&[(2.0, "b=1".to_owned()), (1.0, "a=1".to_owned()), (2.0, "c=1".to_owned())]);
        assert_eq!((planned.time(), planned.next(0.5)), (Some(1.0), None));
        assert_eq!(planned.next(1.5).as_deref(), Some("a=1"));
        assert_eq!(
            [planned.next(2.0), planned.next(2.0), planned.next(2.0)].map(|set| set.unwrap_or_default()),
            ["b=1", "c=1", ""]
        );
        assert_eq!(event("gain.k = 9 1/s", &[]), ("gain.k", "is set to 9 1/s".to_owned()));
        let (_, what) = event("x.x0=7", &["x".to_owned()]);
        assert_eq!(what, "is set to 7 (values at the start of x have no effect any more)");
    }
}
