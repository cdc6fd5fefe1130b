use std::io;

use blocksim_params::{compare, edited};

use super::files::{read_set, read_workbook, tell_set_error};
use super::model::sound;
use super::said::{age, changes, tell_hindrances};
use crate::args::params::ImportArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Takes what was changed in a workbook into a set, or shows what would change.
pub fn import(args: &ImportArgs, console: Console) -> io::Result<Exit> {
    let read = || Ok((read_set(&args.set, console)?, read_workbook(&args.book, console)?));
    let (set, tables) = match read() {
        Ok(both) => both,
        Err(exit) => return Ok(exit),
    };
    let found = compare(&tables, &set.text, &set.quantities);
    if let Some(said) = age(&found) {
        console.say(&said);
    }
    if tell_hindrances(&found, console) {
        console.say("nothing was written");
        return Ok(Exit::Model);
    }
    let text = match edited(&set.text, &found.edits) {
        Ok(text) => text,
        Err(error) => {
            tell_set_error(&error, &args.set, &set.text, console);
            return Ok(Exit::Model);
        }
    };
    console.data(&changes(&found.edits))?;
    if let Some(model) = &args.model
        && let Err(exit) = sound(model, &args.set, &text, &found.edits, console)?
    {
        console.say("nothing was written");
        return Ok(exit);
    }
    let said = format!("{} changed", plural(found.edits.len(), "number"));
    let (target, replace) = match &args.out {
        Some(out) => (out, args.yes),
        None if found.edits.is_empty() => {
            console.data(&format!("{}: no number changes\n", args.set.display()))?;
            return Ok(Exit::Done);
        }
        None if args.yes => (&args.set, true),
        None => {
            console.say(&format!("{said} in the workbook; nothing was written\n  = help: add --yes to change `{}`, or --out FILE to keep it", args.set.display()));
            return Ok(Exit::Failed);
        }
    };
    if let Err(exit) = write_file(target, text.as_bytes(), replace, console) {
        return Ok(exit);
    }
    console.data(&format!("{}: {said}\n", target.display()))?;
    Ok(Exit::Done)
}
