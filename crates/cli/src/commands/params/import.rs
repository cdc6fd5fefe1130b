use blocksim_params::compare;

use super::changes::{age, changes, unhindered};
use super::files::{read_set, read_workbook};
use super::model::sound;
use crate::args::params::ImportArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Takes what was changed in a workbook into a set, or shows what would change.
pub fn import(args: &ImportArgs, console: Console) -> Outcome {
    let (set, tables) = (read_set(&args.set)?, read_workbook(&args.book)?);
    let found = compare(&tables, &set.texts(), &set.quantities);
    if let Some(said) = age(&found) {
        console.say(&said);
    }
    unhindered(&found, &args.book).map_err(|failure| failure.last("nothing was written"))?;
    let texts = set.edited(&found.edits)?;
    console.data(&changes(&found.edits))?;
    if let Some(model) = set.model(args.model.as_deref()) {
        sound(model, &args.set, &texts, &found.edits, console)
            .map_err(|failure| failure.last("nothing was written"))?;
    }
    let said = format!("{} changed", plural(found.edits.len(), "number"));
    match &args.out {
        Some(out) => write_file(out, set.alone(&texts)?.as_bytes(), args.yes)?,
        None if found.edits.is_empty() => {
            console.data(&format!("{}: no number changes\n", args.set.display()))?;
            return Ok(Exit::Done);
        }
        None if args.yes => {
            for (path, text) in &texts {
                write_file(path, text.as_bytes(), true)?;
            }
        }
        None => {
            let files: Vec<String> = texts.iter().map(|(path, _)| format!("`{}`", path.display())).collect();
            console.say(&format!(
                "{said} in the workbook; nothing was written\n  = help: add --yes to change {}{}",
                files.join(", "),
                if set.alone(&texts).is_ok() { ", or --out FILE to keep it" } else { "" }
            ));
            return Ok(Exit::Failed);
        }
    }
    let target = args.out.as_ref().unwrap_or(&args.set);
    console.data(&format!("{}: {said}\n", target.display()))?;
    Ok(Exit::Done)
}
