//! `blocksim run`: the main job.

mod audit;
mod finish;
mod prepare;
mod simulate;
mod verify;
mod watched;

use blocksim_recording::ResultsError;

use self::prepare::Setup;
use self::simulate::End;
use crate::args::model::RunArgs;
use crate::args::report::ReportArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::running::recorder::Recorder;
use crate::terminal::console::Console;

/// Simulates a model, keeps the results and shows them.
///
/// # Errors
/// What keeps it from running, or its results from being kept.
pub fn run(args: &RunArgs, console: Console) -> Outcome {
    let (setup, simulation) = prepare::prepare(args, console)?;
    let end = setup.schedule.settings.stop_time;
    for (when, set) in args.change.iter().filter(|(when, _)| when.time() >= end) {
        let t = when.time();
        let place = if t > end { "after" } else { "at" };
        console.say(&format!(
            "note: `{set}` is to be set at {t} s, {place} the end of the run at {end} s, and has no effect"
        ));
    }
    match args.live {
        Some(speed) => watched::watch(args, setup, simulation, speed, console),
        None => simulate::simulate(args, setup, simulation, console),
    }
}

/// Keeps a run that has ended, shows it, and makes its page if that is wanted.
///
/// # Errors
/// What keeps its results from being kept.
fn finish(args: &RunArgs, setup: Setup, recorder: Recorder, end: End, console: Console) -> Outcome {
    let simulated = simulate::read_back(args, &setup, recorder, end, console)?;
    let (place, exit) = finish::keep_and_tell(args, setup, simulated, console)?;
    if !args.report {
        return Ok(exit);
    }
    Ok(match super::report::written(&ReportArgs::of(place), console) {
        Ok(page) => {
            console.say(&format!("the page of the run is {}", page.display()));
            exit
        }
        Err(failure) => {
            let unwritten = failure.tell(console);
            if exit == Exit::Done { unwritten } else { exit }
        }
    })
}

/// A failure of the file system that keeps results from being written: place, reason, remedy.
fn unwritten(error: &ResultsError) -> Failure {
    let said = format!("cannot write the results to `{}`: {}", error.place().display(), error.reason());
    Failure::unwritable(said).help(error.remedy())
}
