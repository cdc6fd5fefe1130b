//! `blocksim params`: a file for each verb, one for files, one for what is said.

mod changes;
mod check;
mod diff;
#[cfg(feature = "xlsx")]
mod export;
mod files;
mod get;
mod import;
mod list;
mod model;
pub mod set;
pub mod table;

use crate::args::params::ParamsCommand;
use crate::failure::Outcome;
use crate::terminal::console::Console;

/// Parameters of models one by one, and sets of them as workbooks and back.
///
/// # Errors
/// What cannot be read, understood or written.
pub fn params(command: &ParamsCommand, console: Console) -> Outcome {
    match command {
        ParamsCommand::List(args) => list::list(args, console),
        ParamsCommand::Get(args) => get::get(args, console),
        ParamsCommand::Set(args) => set::set(args, console),
        #[cfg(feature = "xlsx")]
        ParamsCommand::Export(args) => export::export(args, console),
        #[cfg(not(feature = "xlsx"))]
        ParamsCommand::Export(args) => {
            let asked = format!("cannot export `{}`", args.set.display());
            Err(crate::left_out::failure(&asked, "workbooks", "xlsx"))
        }
        ParamsCommand::Import(args) => import::import(args, console),
        ParamsCommand::Diff(args) => diff::diff(args, console),
        ParamsCommand::Check(args) => check::check(args, console),
    }
}
