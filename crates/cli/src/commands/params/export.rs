use std::path::PathBuf;

use super::files::{read_set, set_error};
use crate::args::params::ExportArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Writes the workbook of a set or a model.
pub fn export(args: &ExportArgs, console: Console) -> Outcome {
    let set = read_set(&args.set)?;
    let name = args.set.file_name().unwrap_or_default().to_string_lossy();
    if set.quantities.is_empty() {
        return Err(Failure::usage(format!("`{}` has no numbers to export", args.set.display()))
            .help("name a model or a set of parameters in which numbers are written"));
    }
    let sheets = set.arrangement()?;
    let bytes = blocksim_params::export(&set.texts(), &name, &set.quantities, &sheets)
        .map_err(|error| set_error(&error, &args.set, &set.files[0].text))?;
    let beside = || PathBuf::from(args.set.with_extension("xlsx").file_name().unwrap_or_default());
    let out = args.out.clone().unwrap_or_else(beside);
    write_file(&out, &bytes, args.yes)?;
    console.data(&format!(
        "{}: {} in {}\n",
        out.display(),
        plural(set.quantities.len(), "number"),
        plural(sheets.sheets.len(), "sheet")
    ))?;
    Ok(Exit::Done)
}
