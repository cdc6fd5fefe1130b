//! `blocksim run`: the main job.

mod audit;
mod finish;
mod prepare;
mod simulate;

use blocksim_results::ResultsError;

use crate::args::model::RunArgs;
use crate::args::report::ReportArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;

/// Simulates a model, keeps the results and shows them.
///
/// # Errors
/// What keeps it from running, or its results from being kept.
pub fn run(args: &RunArgs, console: Console) -> Outcome {
    let mut prepared = prepare::prepare(args, console)?;
    let simulated = simulate::simulate(args, &mut prepared, console)?;
    let (place, exit) = finish::keep_and_tell(args, prepared, simulated, console)?;
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
