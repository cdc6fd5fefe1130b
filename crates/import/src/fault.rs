//! What is wrong with a file: where, why, and what helps.

use std::fmt;
use std::path::{Path, PathBuf};

/// Something that keeps a file from being imported.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// The file.
    pub file: PathBuf,
    /// Line, from 1; `None` where the file as a whole is meant.
    pub line: Option<u32>,
    /// What is wrong.
    pub reason: String,
    /// What to do about it.
    pub remedy: String,
}

impl Fault {
    /// A fault of a file as a whole.
    pub fn new(file: &Path, reason: impl Into<String>, remedy: impl Into<String>) -> Fault {
        Fault { file: file.to_owned(), line: None, reason: reason.into(), remedy: remedy.into() }
    }

    /// The same fault at a line.
    pub fn at(mut self, line: u32) -> Fault {
        self.line = Some(line);
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}\n  = help: {}", self.reason, self.remedy)
    }
}

impl std::error::Error for Fault {}

/// A text of a file as it is shown in a message: one line, not too long.
pub(crate) fn shown(text: &str) -> String {
    const LONGEST: usize = 60;
    let mut line: String = text.chars().take(LONGEST).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        line.push('…');
    }
    line
}

/// Keeps the value of a result, or its fault for later, so that all faults of a file are told at once.
pub(crate) fn keep<T>(result: Result<T, Fault>, faults: &mut Vec<Fault>) -> Option<T> {
    // Nobody reads more than a screen of faults.
    const MOST: usize = 50;
    match result {
        Ok(value) => Some(value),
        Err(fault) => {
            if faults.len() < MOST {
                faults.push(fault);
            }
            None
        }
    }
}
