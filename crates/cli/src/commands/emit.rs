use std::io;

use super::{load, tell};
use crate::args::{EmitArgs, Format};
use crate::console::Console;
use crate::exit::Exit;
use crate::render;

/// Prints what a step of the compiler makes of a model, also of one with errors if the step was reached.
///
/// # Errors
/// If the standard output cannot be written.
pub fn emit(args: &EmitArgs, console: Console) -> io::Result<Exit> {
    let Some(loaded) = load(&args.model, console) else { return Ok(Exit::Files) };
    let problems = &loaded.compiled.problems;
    tell(problems, &loaded.files, Format::Full, console)?;
    match loaded.compiled.stages.emit(args.stage.into()) {
        Some(text) => console.data(&text)?,
        None => console.say(&format!("{}; this step was not reached", render::tally(problems))),
    }
    Ok(if render::errors(problems) == 0 { Exit::Done } else { Exit::Model })
}
