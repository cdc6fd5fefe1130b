//! `blocksim plugin`: controllers as dynamic libraries.

mod new;
mod show;

pub(super) use self::new::made;

use std::io;

use crate::args::plugin::PluginCommand;
use crate::exit::Exit;
use crate::terminal::console::Console;

/// Makes or shows a plug-in.
///
/// # Errors
/// If the standard output cannot be written.
pub fn plugin(command: &PluginCommand, console: Console) -> io::Result<Exit> {
    match command {
        PluginCommand::New(args) => new::new(args, console),
        PluginCommand::Show(args) => show::show(args, console),
    }
}
