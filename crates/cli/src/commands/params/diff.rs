use std::path::Path;

use blocksim_params::{Quantity, difference};
use blocksim_terminal::{Align, Table};

use super::changes::faulty;
use super::files::{is_workbook, read_set, read_workbook};
use crate::args::params::DiffArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;

/// Tells which numbers differ.
pub fn diff(args: &DiffArgs, console: Console) -> Outcome {
    let (old, new) = (read(&args.old)?, read(&args.new)?);
    // A set tells the order; a workbook is read in that of its paths.
    let found = difference(&old, &new);
    let mut table = Table::new(&[
        ("parameter", Align::Left),
        ("old", Align::Right),
        ("new", Align::Right),
        ("unit", Align::Left),
    ]);
    let side = |side: Option<String>| side.unwrap_or_else(|| "-".to_owned());
    for line in found.iter().cloned() {
        table.row([line.path, side(line.old), side(line.new), line.unit]);
    }
    if found.is_empty() {
        return Ok(Exit::Done);
    }
    console.data(&table.render())?;
    Ok(Exit::Failed)
}

fn read(path: &Path) -> Result<Vec<Quantity>, Failure> {
    if !is_workbook(path) {
        return Ok(read_set(path)?.quantities);
    }
    let tables = read_workbook(path)?;
    if !tables.faults.is_empty() {
        return Err(faulty(&tables.faults, path));
    }
    Ok(tables.quantities())
}
