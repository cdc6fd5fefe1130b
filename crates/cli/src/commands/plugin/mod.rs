//! `blocksim plugin`: controllers as dynamic libraries.

mod new;
mod show;

pub(super) use self::new::{made, source};

use crate::args::plugin::PluginCommand;
use crate::failure::Outcome;
use crate::terminal::console::Console;

/// Makes or shows a plug-in.
///
/// # Errors
/// If it cannot be made, or be loaded.
pub fn plugin(command: &PluginCommand, console: Console) -> Outcome {
    match command {
        PluginCommand::New(args) => new::new(args, console),
        PluginCommand::Show(args) => show::show(args, console),
    }
}
