//! What can go wrong while a diagram runs.

use std::fmt::{Display, Formatter, Result};

/// A simulation that could not go on. Rows up to then have been handed to the observer.
#[derive(Debug, Clone, PartialEq)]
pub struct SimError {
    /// A word for the manual: `settings`, `block_failed`, `not_finite`, `step_size`, `chatter`, `algebraic_loop`,
    /// `endless_events`, `time_event`, `no_steady_state`.
    pub code: &'static str,
    /// When, s.
    pub t: f64,
    /// Path of the block that is to blame, if one is.
    pub path: Option<String>,
    /// What happened, in one sentence without period.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

impl SimError {
    pub(crate) fn new(code: &'static str, t: f64, message: impl Into<String>) -> Self {
        Self { code, t, path: None, message: message.into(), help: None }
    }

    pub(crate) fn at(self, path: &str) -> Self {
        Self { path: Some(path.to_owned()), ..self }
    }

    pub(crate) fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

impl Display for SimError {
    fn fmt(&self, f: &mut Formatter) -> Result {
        write!(f, "error[{}] at t = {} s: {}", self.code, self.t, self.message)?;
        self.help.iter().try_for_each(|help| write!(f, "\nhelp: {help}"))
    }
}

impl std::error::Error for SimError {}
