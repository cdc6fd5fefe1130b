//! `blocksim run`: the main job.

mod audit;
mod finish;
mod halt;
mod prepare;
mod simulate;

use std::io;

use self::halt::Halt;
use crate::args::model::{Format, RunArgs};
use crate::args::report::ReportArgs;
use crate::exit::Exit;
use crate::terminal::console::Console;

/// Simulates a model, keeps the results and shows them.
///
/// # Errors
/// If the standard output cannot be written.
pub fn run(args: &RunArgs, console: Console) -> io::Result<Exit> {
    halt::or_exit(whole(args, console))
}

fn whole(args: &RunArgs, console: Console) -> Result<Exit, Halt> {
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
        Err(message) => {
            console.say(&message);
            if exit == Exit::Done { Exit::Files } else { exit }
        }
    })
}

/// How problems are told.
fn format(args: &RunArgs) -> Format {
    if args.json { Format::Json } else { Format::Full }
}
