//! `blocksim params`: a file for each verb, one for files, one for what is said.

mod check;
mod diff;
mod export;
mod files;
mod import;
mod model;
mod said;

use std::io;

use crate::args::params::ParamsCommand;
use crate::exit::Exit;
use crate::terminal::console::Console;

/// Sets of parameters as workbooks and back.
///
/// # Errors
/// If the standard output cannot be written.
pub fn params(command: &ParamsCommand, console: Console) -> io::Result<Exit> {
    match command {
        ParamsCommand::Export(args) => export::export(args, console),
        ParamsCommand::Import(args) => import::import(args, console),
        ParamsCommand::Diff(args) => diff::diff(args, console),
        ParamsCommand::Check(args) => check::check(args, console),
    }
}
