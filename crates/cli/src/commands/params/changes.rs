//! Changes and faults as text.

use std::path::Path;

use blocksim_block::problem::Problem;
use blocksim_params::{Change, Comparison, Conflict, Fault, Known, Since, Spot};
use blocksim_terminal::{Align, Table};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::terminal::render::plural;

fn place(cell: Option<&Spot>) -> String {
    cell.map_or(String::new(), Spot::to_string)
}

fn number(number: Option<f64>) -> String {
    number.map_or("-".to_owned(), blocksim_params::written)
}

fn old_and_new() -> Table {
    Table::new(&[
        ("cell", Align::Left),
        ("parameter", Align::Left),
        ("old", Align::Right),
        ("new", Align::Right),
        ("unit", Align::Left),
    ])
}

/// A table of changes, or nothing.
pub fn changes(changes: &[Change]) -> String {
    if changes.is_empty() {
        return String::new();
    }
    let mut table = old_and_new();
    for change in changes {
        table.row([
            place(change.cell.as_ref()),
            change.path.clone(),
            number(change.old),
            number(change.new),
            change.unit.clone(),
        ]);
    }
    table.render()
}

/// A side that may have nothing.
fn side(text: Option<&String>) -> String {
    text.cloned().unwrap_or_else(|| "-".to_owned())
}

/// A table of what was changed in the set alone.
fn kept(all: &[Since]) -> String {
    let mut table = old_and_new();
    for Since { cell, difference } in all {
        table.row([
            place(cell.as_ref()),
            difference.path.clone(),
            side(difference.old.as_ref()),
            side(difference.new.as_ref()),
            difference.unit.clone(),
        ]);
    }
    table.render()
}

/// A table of what was changed on both sides.
fn conflicts(conflicts: &[Conflict]) -> String {
    let columns = [
        ("cell", Align::Left),
        ("parameter", Align::Left),
        ("exported", Align::Right),
        ("set", Align::Right),
        ("workbook", Align::Right),
        ("unit", Align::Left),
    ];
    let mut table = Table::new(&columns);
    for conflict in conflicts {
        table.row([
            place(Some(&conflict.cell)),
            conflict.path.clone(),
            side(conflict.exported.as_ref()),
            conflict.set.clone(),
            conflict.sheet.clone(),
            conflict.unit.clone(),
        ]);
    }
    table.render()
}

fn problem(fault: &Fault, book: &Path) -> Problem {
    Problem::error("workbook", format!("{}: {}: {}", book.display(), fault.place(), fault.message))
        .help(fault.help.clone())
}

/// What is wrong in a workbook.
pub fn faulty(faults: &[Fault], book: &Path) -> Failure {
    let problems = faults.iter().map(|fault| problem(fault, book)).collect();
    Failure::of(Exit::Model, problems, Vec::new()).last(plural(faults.len(), "error"))
}

/// Whether nothing hinders an import.
///
/// # Errors
/// What does.
pub fn unhindered(found: &Comparison, book: &Path) -> Result<(), Failure> {
    let mut problems: Vec<Problem> = found.faults.iter().map(|fault| problem(fault, book)).collect();
    if !found.conflicts.is_empty() {
        let said = "numbers were changed in the workbook and in the set since the export";
        problems.push(
            Problem::error("workbook", said)
                .note(conflicts(&found.conflicts).trim_end())
                .help("write what shall hold into the cell or into the set, so that both agree"),
        );
    }
    match found.faults.len() + found.conflicts.len() {
        0 => Ok(()),
        count => Err(Failure::of(Exit::Model, problems, Vec::new()).last(plural(count, "error"))),
    }
}

/// What is to be said of the age of a workbook.
pub fn age(found: &Comparison) -> Option<String> {
    let said = match found.known {
        Known::Current => return None,
        Known::Nothing => "note: the workbook does not remember its export; its cells are compared with the set as it is now".to_owned(),
        Known::Stale if !found.conflicts.is_empty() && found.since.is_empty() => return None,
        Known::Stale if found.since.is_empty() => {
            "note: the text of the set has changed since the export, but no number of the workbook is out of date".to_owned()
        }
        Known::Stale => format!(
            "warning: the set has changed since the export; these numbers stay as they are in the set:\n{}",
            kept(&found.since).trim_end()
        ),
    };
    Some(said)
}
