use std::io;
use std::path::PathBuf;

use super::files::{read_set, tell_set_error};
use crate::args::params::ExportArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Writes the workbook of a set.
pub fn export(args: &ExportArgs, console: Console) -> io::Result<Exit> {
    let set = match read_set(&args.set, console) {
        Ok(set) => set,
        Err(exit) => return Ok(exit),
    };
    let name = args.set.file_name().unwrap_or_default().to_string_lossy();
    let bytes = match blocksim_params::export(&set.text, &name) {
        Ok(bytes) => bytes,
        Err(error) => {
            tell_set_error(&error, &args.set, &set.text, console);
            return Ok(Exit::Model);
        }
    };
    let beside = || PathBuf::from(args.set.with_extension("xlsx").file_name().unwrap_or_default());
    let out = args.out.clone().unwrap_or_else(beside);
    if let Err(exit) = write_file(&out, &bytes, args.yes, console) {
        return Ok(exit);
    }
    console.data(&format!("{}: {} in 9 sheets\n", out.display(), plural(set.quantities.len(), "number")))?;
    Ok(Exit::Done)
}
