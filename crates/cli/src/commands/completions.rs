use clap::CommandFactory;
use clap_complete::{generate, shells};

use crate::args::Args;
use crate::args::start::{CompletionsArgs, Shell};
use crate::exit::Exit;
use crate::failure::Outcome;
use crate::terminal::console::Console;

/// Prints what makes a shell complete commands, options and their values.
///
/// # Errors
/// If the standard output cannot be written.
pub fn completions(args: &CompletionsArgs, console: Console) -> Outcome {
    let (mut command, name) = (Args::command(), "blocksim");
    let mut script = Vec::new();
    match args.shell {
        Shell::Bash => generate(shells::Bash, &mut command, name, &mut script),
        Shell::Zsh => generate(shells::Zsh, &mut command, name, &mut script),
        Shell::Fish => generate(shells::Fish, &mut command, name, &mut script),
        Shell::Powershell => generate(shells::PowerShell, &mut command, name, &mut script),
    }
    console.data(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Done)
}
