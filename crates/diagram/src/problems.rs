//! Problems are gathered, not thrown: one report shows all of them.

use blocksim_block::problem::{Problem, Severity};

/// The problems found so far. A problem that is found twice (six instances of one file) is kept once.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Problems(Vec<Problem>);

impl Problems {
    /// Adds a problem.
    pub fn push(&mut self, problem: Problem) {
        let same = |other: &Problem| {
            other.code == problem.code && other.labels == problem.labels && other.message == problem.message
        };
        if !self.0.iter().any(same) {
            self.0.push(problem);
        }
    }

    /// Adds problems.
    pub fn extend(&mut self, more: impl IntoIterator<Item = Problem>) {
        more.into_iter().for_each(|problem| self.push(problem));
    }

    /// All, errors first, in the order of files and places.
    pub fn sorted(&self) -> Vec<Problem> {
        let mut all = self.0.clone();
        all.sort_by_key(|problem| {
            let place = problem.labels.first().map(|label| (label.place.file, label.place.span.start));
            (problem.severity == Severity::Warning, place)
        });
        all
    }

    /// Whether any of them stops the run.
    pub fn any_error(&self) -> bool {
        self.0.iter().any(|problem| problem.severity == Severity::Error)
    }
}

/// Words in a row for people: `a`, `b` and `c`.
pub(crate) fn list<S: AsRef<str>>(words: &[S]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("`{}`", word.as_ref())).collect();
    match quoted.as_slice() {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [head @ .., last] => format!("{} and {last}", head.join(", ")),
    }
}
