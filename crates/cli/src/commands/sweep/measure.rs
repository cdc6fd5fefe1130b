//! One run of a sweep: from the text of the model to a few numbers.

use std::path::PathBuf;
use std::sync::Arc;

use blocksim_analysis::{Metrics, metrics, statistics, without_jumps};
use blocksim_block::problem::Problem;
use blocksim_block::schedule::{Recorded, Schedule};
use blocksim_recording::Ended as How;
use blocksim_sim::{Ended, SimError, Simulation};

use super::rows::{Both, Rows};
use super::runs::Keeping;
use crate::args::model::ModelArgs;
use crate::args::sweep::{Metric, SweepArgs, Wanted};
use crate::failure::Failure;
use crate::loaded::Loaded;
use crate::running::blame::{reason, warnings};
use crate::running::solver;
use crate::signals::display::{Shown, recording, shown, turn};
use crate::signals::naming::{fits, short_names};
use crate::signals::tracking::{Tracking, are_followed, part, trackings};
use crate::terminal::console::Console;

/// One number of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// What it is.
    pub metric: Metric,
    /// Path of the signal that it is of.
    pub path: String,
    /// Name of the signal, as far as it differs from others; empty where there is only one.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The number; none where there is none, as of a step that is never reached.
    pub value: Option<f64>,
}

/// Why a run has no numbers.
#[derive(Debug)]
pub enum Lost {
    /// The command line does not fit the model.
    Usage(Vec<Problem>),
    /// The simulation could not go on.
    Simulation(String),
    /// Ctrl-C.
    Interrupted,
}

impl From<Failure> for Lost {
    fn from(failure: Failure) -> Lost {
        Lost::Usage(failure.into_problems())
    }
}

/// What is measured where nobody says it.
const OF_ONE: [Metric; 5] =
    [Metric::MaximumError, Metric::FinalError, Metric::Overshoot, Metric::Settling, Metric::Iae];

/// Runs a model, keeps the run at `place` if one is given, and measures what is wanted; `told` becomes what blocks say of their
/// approximations.
///
/// # Errors
/// Why there are no numbers.
pub fn measure(
    loaded: &Loaded,
    mut schedule: Schedule,
    args: &SweepArgs,
    model: &ModelArgs,
    place: Option<PathBuf>,
    told: &mut Vec<Problem>,
    console: Console,
) -> Result<Vec<Measured>, Lost> {
    let wanted = &args.metric;
    solver::apply(&args.solver, &mut schedule.settings)?;
    if schedule.recorded.is_empty() {
        let said = Failure::usage("the model records nothing that could be measured");
        return Err(said.help("add a Scope, or `record: [\"...\"]` to the diagram").into());
    }
    let all: Vec<String> = schedule.recorded.iter().map(|recorded| recorded.path.clone()).collect();
    if place.is_none() {
        let mut follow = are_followed(&schedule.recorded).into_iter();
        schedule.recorded.retain(|recorded| is_needed(recorded, follow.next() == Some(true), wanted));
    }
    let schedule = Arc::new(schedule);
    let recorded = &schedule.recorded;
    let failed = |error: &SimError| Lost::Simulation(reason(error));
    let mut simulation = Simulation::new(Arc::clone(&schedule)).map_err(|error| failed(&error))?;
    let begin = |place| Keeping::begin(place, loaded, model, &schedule, console).map_err(Lost::Simulation);
    let mut keeping = place.map(begin).transpose()?;
    let mut both = Both { rows: Rows(recording(recorded)), keeping: keeping.as_mut() };
    let outcome = simulation.run(&mut both);
    *told = warnings(&mut simulation, &schedule);
    let rows = both.rows.0.unfolded(recorded.iter().map(|recorded| recorded.held).collect());
    if let Some(keeping) = keeping {
        let ended = match &outcome {
            Ok(Ended::Finished) => How::Complete,
            Ok(Ended::Stopped) => How::Stopped { reason: simulation.stop_reason().unwrap_or_default() },
            Ok(Ended::Interrupted) => How::Interrupted,
            Err(error) => How::Failed { reason: reason(error) },
        };
        keeping.end(&schedule, &simulation, &rows, told.clone(), ended).map_err(Lost::Simulation)?;
    }
    if outcome.map_err(|error| failed(&error))? == Ended::Interrupted {
        return Err(Lost::Interrupted);
    }
    let signals = shown(recorded, &rows);
    let found = numbers(&signals, &rows.time, wanted);
    match wanted.iter().find(|wanted| !found.iter().any(|measured| measured.metric == wanted.metric)) {
        Some(without) => Err(no_signal(without, &all).into()),
        None if found.is_empty() => {
            let said = Failure::usage("no scope of the model has a set and an actual value");
            Err(said.help("choose what to measure, such as --metric peak:motor.i").into())
        }
        None => Ok(found),
    }
}

/// Whether a signal, which is one of a pair or not, is needed for anything that is wanted.
fn is_needed(recorded: &Recorded, follows: bool, wanted: &[Wanted]) -> bool {
    let asked = |wanted: &Wanted| match &wanted.pattern {
        _ if wanted.metric.needs_set_value() => follows,
        Some(pattern) => fits(&recorded.path, pattern),
        None => false,
    };
    wanted.is_empty() && follows || wanted.iter().any(asked)
}

/// All numbers that are wanted, in that order.
fn numbers(signals: &[Shown], time: &[f64], wanted: &[Wanted]) -> Vec<Measured> {
    let pairs = trackings(signals);
    let several = pairs.len() > 1;
    let of_pairs = |metric: Metric, pattern: Option<&str>| -> Vec<Measured> {
        let is_meant = |pair: &&Tracking| pattern.is_none_or(|pattern| fits(pair.actual.path, pattern));
        let chosen: Vec<&Tracking> = pairs.iter().filter(is_meant).collect();
        let names = short_names(&chosen.iter().map(|pair| pair.scope).collect::<Vec<_>>());
        let measured = chosen.iter().zip(names).map(|(pair, name)| {
            let unit = &pair.set.unit;
            let values = |shown: &Shown| shown.si.iter().map(|&x| unit.from_si(x)).collect::<Vec<_>>();
            let (mut wanted, mut there) = (values(pair.set), values(pair.actual));
            if let Some(turn) = turn(unit) {
                without_jumps([time; 2], &mut wanted, &mut there, turn);
            }
            let numbers = metrics(time, Some(&wanted), &there);
            let (value, unit) = of_tracking(metric, numbers, &unit.to_string());
            // Of a scope with several pairs each has its own name, and a column of its own.
            let is_only = pairs.iter().filter(|other| other.scope == pair.scope).count() == 1;
            let (path, name) = match (several, is_only) {
                (false, _) => (pair.scope.to_owned(), String::new()),
                (true, true) => (pair.scope.to_owned(), name.to_owned()),
                (true, false) => {
                    (pair.actual.path.to_owned(), format!("{name} {}", part(pair.actual.port())))
                }
            };
            Measured { metric, path, name, unit, value }
        });
        measured.collect()
    };
    let of_signals = |metric: Metric, pattern: &str| -> Vec<Measured> {
        let chosen = signals.iter().filter(|signal| fits(signal.path, pattern));
        let measured = chosen.map(|signal| Measured {
            metric,
            path: signal.path.to_owned(),
            name: signal.path.to_owned(),
            unit: signal.unit.to_string(),
            value: of_signal(metric, time, &signal.values()),
        });
        measured.collect()
    };
    if wanted.is_empty() {
        let metrics = if several { &OF_ONE[..1] } else { &OF_ONE[..] };
        return metrics.iter().flat_map(|metric| of_pairs(*metric, None)).collect();
    }
    let one = |wanted: &Wanted| match (&wanted.pattern, wanted.metric.needs_set_value()) {
        (Some(pattern), false) => of_signals(wanted.metric, pattern),
        (pattern, _) => of_pairs(wanted.metric, pattern.as_deref()),
    };
    wanted.iter().flat_map(one).collect()
}

/// A number of how a set value is followed, and its unit, where the signals are in `unit`.
fn of_tracking(metric: Metric, numbers: Option<Metrics>, unit: &str) -> (Option<f64>, String) {
    let unit_and = |times: &str| if unit == "1" { times.to_owned() } else { format!("{unit}*{times}") };
    let value = numbers.and_then(|m| match metric {
        Metric::Rise => m.rise,
        Metric::Overshoot => m.overshoot.map(|share| 100.0 * share),
        Metric::Settling => m.settling,
        Metric::Iae => Some(m.iae),
        Metric::Ise => Some(m.ise),
        Metric::FinalError => Some(m.steady_state_error),
        _ => Some(m.max_error),
    });
    let unit = match metric {
        Metric::Rise | Metric::Settling => "s".to_owned(),
        Metric::Overshoot => "%".to_owned(),
        Metric::Iae => unit_and("s"),
        Metric::Ise if unit == "1" => "s".to_owned(),
        Metric::Ise => format!("{unit}^2*s"),
        _ => unit.to_owned(),
    };
    (value, unit)
}

/// A number of any signal.
fn of_signal(metric: Metric, time: &[f64], values: &[f64]) -> Option<f64> {
    let numbers = statistics(time, values)?;
    Some(match metric {
        Metric::Min => numbers.min,
        Metric::Max => numbers.max,
        Metric::Peak => numbers.peak(),
        Metric::Mean => numbers.mean,
        Metric::Rms => numbers.rms,
        _ => numbers.last,
    })
}

/// What to say where nothing fits.
fn no_signal(wanted: &Wanted, recorded: &[String]) -> Failure {
    let what = wanted.metric.name();
    let Some(pattern) = &wanted.pattern else {
        let said = format!("no scope of the model has a set and an actual value, of which there is a {what}");
        return Failure::usage(said).help("name the inputs of a Scope `set` and `actual`");
    };
    let some: Vec<&str> = recorded.iter().take(5).map(String::as_str).collect();
    let more = if recorded.len() > some.len() { ", ..." } else { "" };
    let of = if wanted.metric.needs_set_value() {
        "no set and actual value fits"
    } else {
        "no recorded signal fits"
    };
    Failure::usage(format!("{of} `{pattern}` of `{what}:{pattern}`"))
        .help(format!("recorded are {}{more}", some.join(", ")))
}
