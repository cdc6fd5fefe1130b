//! Why something is not done.

use blocksim_block::problem::{Place, Problem};
use blocksim_diagram::SourceFile;

/// Why something is not done, and what helps.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// What is in the way, in one sentence without period.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
    /// Whether a file is in the way that others share, which may be changed if that is meant.
    pub is_shared: bool,
}

impl Refusal {
    /// That something is in the way.
    pub fn new(message: impl Into<String>) -> Refusal {
        Refusal { message: message.into(), help: None, is_shared: false }
    }

    /// What to do.
    #[must_use]
    pub fn help(self, help: impl Into<String>) -> Refusal {
        Refusal { help: Some(help.into()), ..self }
    }

    /// That others share a file.
    pub(crate) fn shared(message: impl Into<String>, help: impl Into<String>) -> Refusal {
        Refusal { is_shared: true, ..Refusal::new(message).help(help) }
    }

    /// That the change would bring a problem.
    pub(crate) fn of(problem: &Problem) -> Refusal {
        Refusal { help: problem.help.clone(), ..Refusal::new(problem.message.clone()) }
    }

    /// That a problem has to be solved first.
    pub(crate) fn first(problem: &Problem, files: &[SourceFile]) -> Refusal {
        let place = problem.labels.first().and_then(|label| place(&label.place, files));
        let place = place.map(|place| format!("{place}: ")).unwrap_or_default();
        let refusal = Refusal::new(format!("first correct {place}{}", problem.message));
        Refusal { help: problem.help.clone(), ..refusal }
    }
}

/// `segment.ron:12`.
pub(crate) fn place(place: &Place, files: &[SourceFile]) -> Option<String> {
    let file = files.get(place.file.0 as usize)?;
    Some(line_of(file, place.span.start))
}

/// `segment.ron:12`.
pub(crate) fn line_of(file: &SourceFile, at: usize) -> String {
    let name = file.path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let line = file.text.get(..at).map_or(0, |before| before.matches('\n').count()) + 1;
    format!("{name}:{line}")
}
