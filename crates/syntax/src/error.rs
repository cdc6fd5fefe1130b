//! What is wrong with a text that is not RON.

use std::ops::Range;

/// Text that is not RON.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SyntaxError {
    /// Where.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// A second place and what is to be seen there.
    pub beside: Option<(Range<usize>, String)>,
    /// The change that repairs it, where no other one is likely.
    pub remedy: Option<Box<Remedy>>,
}

impl SyntaxError {
    pub(crate) fn new(span: Range<usize>, message: impl Into<String>) -> SyntaxError {
        SyntaxError { span, message: message.into(), help: None, beside: None, remedy: None }
    }

    pub(crate) fn help(self, help: impl Into<String>) -> SyntaxError {
        SyntaxError { help: Some(help.into()), ..self }
    }

    pub(crate) fn beside(self, place: Range<usize>, seen: impl Into<String>) -> SyntaxError {
        SyntaxError { beside: Some((place, seen.into())), ..self }
    }

    /// `new` in the place of what stands there.
    pub(crate) fn remedy(self, text: &str, span: Range<usize>, new: impl Into<String>) -> SyntaxError {
        let old = text[span.clone()].to_owned();
        SyntaxError { remedy: Some(Box::new(Remedy { span, old, new: new.into() })), ..self }
    }
}

/// A change that makes RON of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remedy {
    /// Bytes that are replaced.
    pub span: Range<usize>,
    /// What stands there.
    pub old: String,
    /// What is to stand there.
    pub new: String,
}
