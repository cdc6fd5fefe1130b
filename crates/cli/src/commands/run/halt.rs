//! Ways out of a run before its end. What there was to say has been said then.

use std::io;

use blocksim_results::ResultsError;

use crate::exit::Exit;
use crate::terminal::console::Console;

/// Why a run ends here.
#[derive(Debug)]
pub enum Halt {
    /// It cannot go on.
    Exit(Exit),
    /// The standard output cannot be written.
    Output(io::Error),
}

impl From<io::Error> for Halt {
    fn from(error: io::Error) -> Halt {
        Halt::Output(error)
    }
}

/// What the program is to do.
///
/// # Errors
/// If the standard output cannot be written.
pub fn or_exit(outcome: Result<Exit, Halt>) -> io::Result<Exit> {
    match outcome {
        Ok(exit) | Err(Halt::Exit(exit)) => Ok(exit),
        Err(Halt::Output(error)) => Err(error),
    }
}

/// Says a mistake of the command line.
pub fn usage(mistake: &str, console: Console) -> Halt {
    console.say(&format!("error: {mistake}"));
    Halt::Exit(Exit::Usage)
}

/// Says a failure of the file system: place, reason, remedy.
pub fn refused(error: &ResultsError, console: Console) -> Halt {
    console.say(&format!(
        "error: cannot write the results to `{}`: {}\n  = help: {}",
        error.place().display(),
        error.reason(),
        error.remedy()
    ));
    Halt::Exit(Exit::Files)
}
