//! Problems of a model: what, where, and what to do. Names and pictures come at the edge.

use std::ops::Range;

/// A file of the model, numbered as it was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FileId(pub u32);

/// A place in a file, in bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: FileId,
    /// Start and end in bytes.
    pub span: Range<usize>,
}

/// A place with what is to be seen there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub place: Place,
    /// What is to be seen there; may be empty.
    pub text: String,
    /// The change there that mends the problem, where no other one is likely.
    pub edit: Option<Edit>,
}

/// A change of a text that mends a problem.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edit {
    /// What is replaced; nothing is where the span is empty.
    pub place: Place,
    /// What stands there. Where something else does, the edit means nothing.
    pub old: String,
    /// What is to stand there.
    pub new: String,
}

/// Whether a problem stops the run; the most severe first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The model cannot run.
    Error,
    /// The model runs, but look here.
    Warning,
    /// The model runs, and this is how.
    Note,
}

/// One problem of a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Error, warning or note.
    pub severity: Severity,
    /// A word for the manual: `unknown_port`, `unit_mismatch` ...
    pub code: &'static str,
    /// The fact, in one sentence without period.
    pub message: String,
    /// Where it shows, most guilty first.
    pub labels: Vec<Label>,
    /// What to do.
    pub help: Option<String>,
    /// Further facts, such as the hops of an algebraic loop.
    pub notes: Vec<String>,
}

impl Problem {
    /// An error without place.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            message: message.into(),
            labels: Vec::new(),
            help: None,
            notes: Vec::new(),
        }
    }

    /// A warning without place.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }

    /// A note without place.
    pub fn information(code: &'static str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Note, ..Self::error(code, message) }
    }

    /// Adds a place.
    pub fn at(mut self, place: &Place, text: impl Into<String>) -> Self {
        self.labels.push(Label { place: place.clone(), text: text.into(), edit: None });
        self
    }

    /// Adds advice.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds the change that mends it to its first place.
    pub fn edit(mut self, place: Place, old: impl Into<String>, new: impl Into<String>) -> Self {
        if let Some(label) = self.labels.first_mut() {
            label.edit = Some(Edit { place, old: old.into(), new: new.into() });
        }
        self
    }

    /// The change of the text that mends it, if no other one is likely.
    pub fn remedy(&self) -> Option<&Edit> {
        self.remedies().next()
    }

    /// The changes of all its places.
    pub fn remedies(&self) -> impl Iterator<Item = &Edit> {
        self.labels.iter().filter_map(|label| label.edit.as_ref())
    }

    /// Adds a further fact.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
}
