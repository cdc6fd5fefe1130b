//! What the program tells the shell.

use std::process::ExitCode;

/// How a command ended. A bug ends the program with 101, which is Rust's code for a panic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// All went well.
    Done,
    /// The simulation could not go on.
    Failed,
    /// The command line makes no sense; `clap` uses the same number.
    Usage,
    /// The model has errors.
    Model,
    /// A file or folder cannot be read or written.
    Files,
    /// Ctrl-C: 128 + 2, the number of the signal.
    Interrupted,
}

impl Exit {
    /// The number that the shell sees.
    pub fn code(self) -> u8 {
        match self {
            Exit::Done => 0,
            Exit::Failed => 1,
            Exit::Usage => 2,
            Exit::Model => 3,
            Exit::Files => 4,
            Exit::Interrupted => 130,
        }
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes_are_those_of_the_manual() {
        let all = [Exit::Done, Exit::Failed, Exit::Usage, Exit::Model, Exit::Files, Exit::Interrupted];
        assert_eq!(all.map(Exit::code), [0, 1, 2, 3, 4, 130]);
    }
}
