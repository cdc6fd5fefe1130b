use blocksim_params::compare;

use super::changes::{age, changes, unhindered};
use super::files::{read_set, read_workbook};
use super::model::sound;
use crate::args::params::CheckArgs;
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Tells what is wrong in a workbook and what changed since its export.
pub fn check(args: &CheckArgs, console: Console) -> Outcome {
    let (set, tables) = (read_set(&args.set)?, read_workbook(&args.book)?);
    let found = compare(&tables, &set.texts(), &set.quantities);
    if let Some(said) = age(&found) {
        console.say(&said);
    }
    if !found.edits.is_empty() {
        console.data(&format!("changed in the workbook:\n{}", changes(&found.edits)))?;
    }
    unhindered(&found, &args.book)?;
    if let Some(model) = set.model(args.model.as_deref()) {
        sound(model, &args.set, &set.edited(&found.edits)?, &found.edits, console)?;
    }
    let counted = plural(set.quantities.len(), "number");
    console.data(&format!(
        "{}: no errors; {counted}, {} changed\n",
        args.book.display(),
        found.edits.len()
    ))?;
    Ok(Exit::Done)
}
