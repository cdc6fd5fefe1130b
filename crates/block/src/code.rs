//! Code of others that a diagram names, and who decides what becomes of it.

use std::fmt::Debug;
use std::path::Path;

use crate::LoadError;

/// What becomes of code that a diagram names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Decision {
    /// It may be built and loaded.
    Load,
    /// It is not run. What it offered when it was loaded last is known, in the words of whoever loads such code.
    Recall {
        /// What it offered.
        offer: String,
        /// What people should know about that, for the parameter that names the code.
        warning: Option<LoadError>,
        /// Why it is not run, where what is known does not suffice.
        refusal: LoadError,
    },
    /// It is not run, and nothing is known of it.
    Refuse(LoadError),
}

/// Decides whether code that diagrams name is built and loaded: reading a diagram must not run what somebody has put beside it.
pub trait CodePolicy: Debug {
    /// What becomes of the code `named` by a diagram in `folder`, a path relative to that folder.
    fn decide(&self, folder: &Path, named: &str) -> Decision;

    /// Keeps what loaded code offers, for a later [`Decision::Recall`].
    fn remember(&self, _folder: &Path, _named: &str, _offer: &str) {}
}

/// Runs nothing: what holds unless a program decides otherwise.
#[derive(Debug, Clone, Copy)]
pub struct NoCode;

impl CodePolicy for NoCode {
    fn decide(&self, _folder: &Path, named: &str) -> Decision {
        Decision::Refuse(untrusted(named))
    }
}

/// Runs whatever a diagram names, for programs that are about to run the diagram itself.
#[derive(Debug, Clone, Copy)]
pub struct AnyCode;

impl CodePolicy for AnyCode {
    fn decide(&self, _folder: &Path, _named: &str) -> Decision {
        Decision::Load
    }
}

/// That code is not loaded because nobody has consented.
pub fn untrusted(named: &str) -> LoadError {
    LoadError {
        param: "library",
        code: UNTRUSTED,
        message: format!("the plug-in `{named}` is not trusted, so it was not built or loaded"),
        help: None,
    }
}

/// Code of the problem that something is not trusted.
pub const UNTRUSTED: &str = "plugin_untrusted";
