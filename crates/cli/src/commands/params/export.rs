use std::path::PathBuf;

use super::files::{read_set, set_error};
use crate::args::params::ExportArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Writes the workbook of a set.
pub fn export(args: &ExportArgs, console: Console) -> Outcome {
    let set = read_set(&args.set)?;
    let name = args.set.file_name().unwrap_or_default().to_string_lossy();
    let bytes =
        blocksim_params::export(&set.text, &name).map_err(|error| set_error(&error, &args.set, &set.text))?;
    let beside = || PathBuf::from(args.set.with_extension("xlsx").file_name().unwrap_or_default());
    let out = args.out.clone().unwrap_or_else(beside);
    write_file(&out, &bytes, args.yes)?;
    console.data(&format!("{}: {} in 9 sheets\n", out.display(), plural(set.quantities.len(), "number")))?;
    Ok(Exit::Done)
}
