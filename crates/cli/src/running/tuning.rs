//! Parameters that change while a run goes on: at times that were named before, or when somebody asks for it.

use std::collections::VecDeque;
use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_diagram::{Options, PanelItem, SourceFile, Sources, compile_with};
use blocksim_sim::{Ended, NUMBERS, Observer, SimError, Simulation, other_model, untunable};

use crate::args::model::RunArgs;
use crate::disk::{Disk, Overlaid};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::loaded::Loaded;
use crate::running::{interrupt, solver};
use crate::trust::{Plugins, Purpose};

/// What came of a parameter that was to change: blocks whose values at the start it changes as well, or why it is refused and what
/// helps.
pub type Came = Result<Vec<String>, (String, Option<String>)>;

/// What is set, from the start on, and what the panel of the model shows of that.
#[derive(Debug, Clone, Default)]
pub struct Setting {
    /// As `--set` takes it.
    pub set: Vec<String>,
    /// The elements of the panel.
    pub panel: Arc<[PanelItem]>,
}

/// An observer that wants parameters to change.
pub trait Tunes: Observer {
    /// When something is to be set next, as far as that is known before, s.
    fn planned(&self) -> Option<f64>;

    /// The run has stopped at the end of a step, for whatever reason.
    fn stopped(&mut self, _simulation: &Simulation, _setting: &Setting) {}

    /// Whether the run goes from a snapshot to a time of its past. What was set where the snapshot was taken is wanted at once then: the
    /// stop for it lies behind.
    fn goes_back(&self) -> bool {
        false
    }

    /// What is to be set now, if anything is.
    fn wanted(&mut self, t: f64) -> Option<String>;

    /// Whether the run goes on where it has stopped; something may have been set there.
    fn goes_on(&self, has_set: bool) -> bool {
        has_set
    }

    /// What came of it, and all that is set now.
    fn tuned(&mut self, t: f64, set: &str, came: Came, setting: &Setting);
}

/// When a parameter changes, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum When {
    /// Then, and a step ends there for that.
    At(f64),
    /// At the end of the step that reaches this time: so no step differs from those of a run in which somebody asked for it there.
    After(f64),
}

impl When {
    /// The time, s.
    pub fn time(self) -> f64 {
        let (When::At(t) | When::After(t)) = self;
        t
    }
}

/// Parameters that change at times that are known before.
#[derive(Debug, Default)]
pub struct Planned {
    changes: VecDeque<(When, String)>,
}

impl Planned {
    /// Changes in the order of their times.
    pub fn new(changes: &[(When, String)]) -> Planned {
        let mut changes = changes.to_vec();
        changes.sort_by(|a, b| a.0.time().total_cmp(&b.0.time()));
        Planned { changes: changes.into() }
    }

    /// When a step has to end for one of them next, s.
    pub fn time(&self) -> Option<f64> {
        self.changes.iter().find_map(|(when, _)| if let When::At(t) = when { Some(*t) } else { None })
    }

    /// Whether one is due.
    pub fn is_due(&self, t: f64) -> bool {
        self.changes.front().is_some_and(|(when, _)| when.time() <= t)
    }

    /// The next one that is due.
    pub fn next(&mut self, t: f64) -> Option<(When, String)> {
        if self.is_due(t) { self.changes.pop_front() } else { None }
    }

    /// Takes more of them.
    pub fn add(&mut self, more: Vec<(When, String)>) {
        let all: Vec<(When, String)> = self.changes.drain(..).chain(more).collect();
        *self = Planned::new(&all);
    }
}

/// A change as `--change` takes it, of something that was set when a step had ended.
pub fn written(t: f64, set: &str) -> String {
    format!("after {t}s:{set}")
}

/// What makes the model anew, from the texts of the start.
pub struct Tuner<'a> {
    setting: Setting,
    args: &'a RunArgs,
    /// Texts that the model was made of.
    texts: Vec<SourceFile>,
}

impl<'a> Tuner<'a> {
    /// One for a run of a model.
    pub fn new(args: &'a RunArgs, loaded: &Loaded) -> Tuner<'a> {
        let panel = loaded.compiled.panel.clone().into();
        let setting = Setting { set: args.model.set.clone(), panel };
        Tuner { setting, args, texts: loaded.on_disk.clone() }
    }

    /// Goes on from where this was set.
    pub fn go_back(&mut self, setting: Setting) {
        self.setting = setting;
    }

    /// Runs to the end, with the changes that the observer wants.
    ///
    /// # Errors
    /// Those of the run.
    pub fn run(&mut self, simulation: &mut Simulation, observer: &mut dyn Tunes) -> Result<Ended, SimError> {
        if observer.goes_back() {
            self.set_wanted(simulation, observer);
        }
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
            observer.stopped(simulation, &self.setting);
            let has_set = self.set_wanted(simulation, observer);
            if !observer.goes_on(has_set) {
                return Ok(ended);
            }
        }
    }

    /// Sets all that is wanted now; whether there was anything.
    fn set_wanted(&mut self, simulation: &mut Simulation, observer: &mut dyn Tunes) -> bool {
        let t = simulation.time();
        let mut has_set = false;
        while let Some(set) = observer.wanted(t) {
            has_set = true;
            let came = self.tune(simulation, &set, observer);
            observer.tuned(t, &set, came, &self.setting);
        }
        has_set
    }

    /// Sets one more parameter.
    fn tune(&mut self, simulation: &mut Simulation, set: &str, observer: &mut dyn Observer) -> Came {
        let mut all = self.setting.set.clone();
        all.push(set.to_owned());
        let (schedule, panel) = self.made(&all)?;
        let without_effect =
            simulation.tune(Arc::new(schedule), observer).map_err(|error| (error.message, error.help))?;
        self.setting = Setting { set: all, panel: panel.into() };
        Ok(without_effect)
    }

    /// Refuses changes of which it is known before the run that they cannot be made.
    ///
    /// # Errors
    /// `tuning` with the first of them.
    pub fn foresee(&self, schedule: &Schedule, changes: &[(When, String)]) -> Result<(), Failure> {
        let mut all = self.setting.set.clone();
        let mut planned = Planned::new(changes);
        while let Some((when, set)) = planned.next(f64::INFINITY) {
            all.push(set.clone());
            let refused = match self.made(&all) {
                Ok((next, _)) => {
                    untunable(schedule, &next).map(|why| (other_model(&why), Some(NUMBERS.to_owned())))
                }
                Err(refused) => Some(refused),
            };
            if let Some((why, help)) = refused {
                let failure = Failure::new(Exit::Failed, "tuning", unset(&set, when.time(), &why));
                return Err(failure.perhaps_help(help.as_ref()).last("nothing was run"));
            }
        }
        Ok(())
    }

    /// The model with all of this set, and its panel.
    fn made(&self, all: &[String]) -> Result<(Schedule, Vec<PanelItem>), (String, Option<String>)> {
        let disk = Disk::with(Plugins::of(self.args.model.plugins, Purpose::Run));
        let texts = self.texts.iter().map(|file| (file.path.clone(), file.text.to_string())).collect();
        let reader = Overlaid { disk, texts };
        let options = Options { overrides: all, recorded: &self.args.record, ..Options::default() };
        let mut compiled = compile_with(&Sources::new(&reader), &self.args.model.model, &options);
        let Some(mut schedule) = compiled.schedule.take() else {
            let first = compiled.problems.into_iter().next();
            return Err(first
                .map_or(("it cannot be set".to_owned(), None), |problem| (problem.message, problem.help)));
        };
        solver::apply(&self.args.solver, &mut schedule.settings).map_err(refusal)?;
        Ok((schedule, compiled.panel))
    }
}

/// Why a parameter cannot be set during a run.
pub fn unset(set: &str, t: f64, why: &str) -> String {
    format!("`{set}` cannot be set at {t} s: {why}")
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
        let set = |name: &str| format!("{name}=1");
        let mut planned = Planned::new(&[
            (When::At(2.0), set("b")),
            (When::After(1.0), set("a")),
            (When::At(2.0), set("c")),
        ]);
        assert_eq!((planned.time(), planned.next(0.5)), (Some(2.0), None));
        assert!(!planned.is_due(0.9) && planned.is_due(1.5));
        assert_eq!(planned.next(1.5), Some((When::After(1.0), set("a"))));
        planned.add(vec![(When::After(1.7), set("d"))]);
        let all = [planned.next(2.0), planned.next(2.0), planned.next(2.0), planned.next(2.0)];
        let names = all.map(|change| change.map_or(String::new(), |(_, set)| set));
        assert_eq!(names, ["d=1", "b=1", "c=1", ""]);
        assert_eq!(event("gain.k = 9 1/s", &[]), ("gain.k", "is set to 9 1/s".to_owned()));
        let (_, what) = event("x.x0=7", &["x".to_owned()]);
        assert_eq!(what, "is set to 7 (values at the start of x have no effect any more)");
    }
}
