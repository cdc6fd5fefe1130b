//! Why a command ends without what it was asked for: made where it is found, told in one place.

use std::io;

use blocksim_block::ParamError;
use blocksim_block::problem::Problem;
use blocksim_diagram::SourceFile;
use blocksim_recording::ResultsError;

use crate::commands::tell_with;
use crate::exit::Exit;
use crate::terminal::console::Console;

/// What a command returns: how it ended, or why it could not.
pub type Outcome = Result<Exit, Failure>;

/// Why a command cannot do what it was asked for.
#[derive(Debug)]
pub struct Failure(Box<Content>);

#[derive(Debug)]
enum Content {
    /// What is told.
    Told {
        exit: Exit,
        problems: Vec<Problem>,
        /// Texts that the places of the problems refer to.
        files: Vec<SourceFile>,
        /// A line behind the problems: what was not done for them.
        last: Option<String>,
    },
    /// The standard output cannot be written.
    Output(io::Error),
}

impl Failure {
    /// Problems with the texts that they are about.
    pub fn of(exit: Exit, problems: Vec<Problem>, files: Vec<SourceFile>) -> Failure {
        Failure(Box::new(Content::Told { exit, problems, files, last: None }))
    }

    /// A single problem without a place in a text.
    pub fn new(exit: Exit, code: &'static str, message: impl Into<String>) -> Failure {
        Failure::of(exit, vec![Problem::error(code, message)], Vec::new())
    }

    /// The command line makes no sense.
    pub fn usage(message: impl Into<String>) -> Failure {
        Failure::new(Exit::Usage, "usage", message)
    }

    /// A file or folder cannot be read, or holds nothing that could be used.
    pub fn unreadable(message: impl Into<String>) -> Failure {
        Failure::new(Exit::Files, "unreadable", message)
    }

    /// A file or folder cannot be written.
    pub fn unwritable(message: impl Into<String>) -> Failure {
        Failure::new(Exit::Files, "unwritable", message)
    }

    /// No problem: Ctrl-C, and what was not done therefore.
    pub fn interrupted(undone: &str) -> Failure {
        Failure::of(Exit::Interrupted, Vec::new(), Vec::new()).last(format!("interrupted; {undone}"))
    }

    /// Everything has been told.
    pub fn told(exit: Exit) -> Failure {
        Failure::of(exit, Vec::new(), Vec::new())
    }

    /// What a parameter of a description lacks.
    pub fn parameter(error: &ParamError) -> Failure {
        let said = Failure::new(Exit::Model, "parameter", format!("{} (`{}`)", error.message, error.param));
        said.perhaps_help(error.help.as_ref())
    }

    /// A run cannot be read.
    pub fn of_run(error: &ResultsError) -> Failure {
        let said = format!("cannot read `{}`: {}", error.place().display(), error.reason());
        Failure::unreadable(said).help(error.remedy())
    }

    /// Adds advice to the problem.
    pub fn help(self, help: impl Into<String>) -> Failure {
        self.change(|problem| problem.help = Some(help.into()))
    }

    /// Adds advice, where there is any.
    pub fn perhaps_help(self, help: Option<impl Into<String>>) -> Failure {
        match help {
            Some(help) => self.help(help),
            None => self,
        }
    }

    /// Adds a fact to the problem.
    pub fn note(self, note: impl Into<String>) -> Failure {
        self.change(|problem| problem.notes.push(note.into()))
    }

    fn change(mut self, change: impl FnOnce(&mut Problem)) -> Failure {
        if let Content::Told { problems, .. } = &mut *self.0
            && let Some(problem) = problems.last_mut()
        {
            change(problem);
        }
        self
    }

    /// Sets the line behind the problems: what was not done for them.
    pub fn last(mut self, line: impl Into<String>) -> Failure {
        if let Content::Told { last, .. } = &mut *self.0 {
            *last = Some(line.into());
        }
        self
    }

    /// The problems alone, for those who tell them later.
    pub fn into_problems(self) -> Vec<Problem> {
        match *self.0 {
            Content::Told { problems, .. } => problems,
            Content::Output(_) => Vec::new(),
        }
    }

    /// What is wrong, in one line.
    pub fn message(&self) -> String {
        match &*self.0 {
            Content::Told { problems, last, .. } => {
                let first = problems.first().map(|problem| problem.message.clone());
                first.or_else(|| last.clone()).unwrap_or_default()
            }
            Content::Output(error) => error.to_string(),
        }
    }

    /// Message and help, for tests.
    #[cfg(test)]
    pub fn text(&self) -> String {
        let Content::Told { problems, .. } = &*self.0 else { return self.message() };
        let helps = problems.iter().filter_map(|problem| problem.help.as_ref());
        helps.fold(self.message(), |text, help| format!("{text}\n  = help: {help}"))
    }

    /// Tells it; how the program is to end.
    pub fn tell(&self, console: Console) -> Exit {
        match &*self.0 {
            Content::Output(error) => tell_output(error, console),
            Content::Told { exit, problems, files, last } => {
                if let Err(error) = tell_with(problems, files, Some(*exit), console) {
                    return tell_output(&error, console);
                }
                last.iter().for_each(|line| console.say(line));
                *exit
            }
        }
    }
}

/// Tells that the standard output cannot be written.
fn tell_output(error: &io::Error, console: Console) -> Exit {
    // Whoever reads only the first lines, such as `head`, has what they want.
    if error.kind() == io::ErrorKind::BrokenPipe {
        return Exit::Done;
    }
    console.say(&format!("error: cannot write to the standard output: {error}"));
    Exit::Files
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Failure {
        Failure(Box::new(Content::Output(error)))
    }
}
