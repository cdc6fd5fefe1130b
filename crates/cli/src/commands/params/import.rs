use blocksim_params::{compare, edited};

use super::files::{read_set, read_workbook, set_error};
use super::model::sound;
use super::said::{age, changes, unhindered};
use crate::args::params::ImportArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Takes what was changed in a workbook into a set, or shows what would change.
pub fn import(args: &ImportArgs, console: Console) -> Outcome {
    let (set, tables) = (read_set(&args.set)?, read_workbook(&args.book)?);
    let found = compare(&tables, &set.text, &set.quantities);
    if let Some(said) = age(&found) {
        console.say(&said);
    }
    unhindered(&found, &args.book).map_err(|failure| failure.last("nothing was written"))?;
    let text = edited(&set.text, &found.edits).map_err(|error| set_error(&error, &args.set, &set.text))?;
    console.data(&changes(&found.edits))?;
    if let Some(model) = &args.model {
        sound(model, &args.set, &text, &found.edits, console)
            .map_err(|failure| failure.last("nothing was written"))?;
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
    write_file(target, text.as_bytes(), replace)?;
    console.data(&format!("{}: {said}\n", target.display()))?;
    Ok(Exit::Done)
}
