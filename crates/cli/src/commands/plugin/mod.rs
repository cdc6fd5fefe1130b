//! `blocksim plugin`: controllers as dynamic libraries.

mod check;
mod new;
mod show;

pub(super) use self::new::{DEMO, made, make, source};
pub(super) use self::show::data as controller;

use crate::args::plugin::PluginCommand;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;

/// Answers the process that has started this one to keep a plug-in apart.
fn serve() -> Outcome {
    match blocksim_host::serve() {
        Ok(()) => Ok(Exit::Done),
        Err(error) => Err(Failure::usage(format!("there is no program to serve: {error}"))
            .help("this command is for `--isolate`, which calls it")),
    }
}

/// Makes, shows or examines a plug-in.
///
/// # Errors
/// If it cannot be made, or be loaded.
pub fn plugin(command: &PluginCommand, console: Console) -> Outcome {
    match command {
        PluginCommand::New(args) => new::new(args, console),
        PluginCommand::Show(args) => show::show(args, console),
        PluginCommand::Check(args) => check::check(args, console),
        PluginCommand::Serve => serve(),
    }
}
