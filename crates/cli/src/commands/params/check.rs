use std::io;

use blocksim_params::{compare, edited};

use super::files::{read_set, read_workbook, tell_set_error};
use super::model::sound;
use super::said::{age, changes, tell_hindrances};
use crate::args::params::CheckArgs;
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Tells what is wrong in a workbook and what changed since its export.
pub fn check(args: &CheckArgs, console: Console) -> io::Result<Exit> {
    let read = || Ok((read_set(&args.set, console)?, read_workbook(&args.book, console)?));
    let (set, tables) = match read() {
        Ok(both) => both,
        Err(exit) => return Ok(exit),
    };
    let found = compare(&tables, &set.text, &set.quantities);
    if let Some(said) = age(&found) {
        console.say(&said);
    }
    if !found.edits.is_empty() {
        console.data(&format!("changed in the workbook:\n{}", changes(&found.edits)))?;
    }
    if tell_hindrances(&found, console) {
        return Ok(Exit::Model);
    }
    if let Some(model) = &args.model {
        let text = match edited(&set.text, &found.edits) {
            Ok(text) => text,
            Err(error) => {
                tell_set_error(&error, &args.set, &set.text, console);
                return Ok(Exit::Model);
            }
        };
        if let Err(exit) = sound(model, &args.set, &text, &found.edits, console)? {
            return Ok(exit);
        }
    }
    let counted = plural(set.quantities.len(), "number");
    console.data(&format!(
        "{}: no errors; {counted}, {} changed\n",
        args.book.display(),
        found.edits.len()
    ))?;
    Ok(Exit::Done)
}
