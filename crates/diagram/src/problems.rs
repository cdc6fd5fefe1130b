//! Problems are gathered, not thrown: one report shows all of them.

use blocksim_block::UNTRUSTED;
use blocksim_block::problem::{FileId, Place, Problem, Severity};
use blocksim_signal::{closest, surely};
use blocksim_syntax::SyntaxError;
use foldhash::HashMap;

/// The problems found so far. A problem that is found twice (six instances of one file) is kept once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Problems {
    all: Vec<Problem>,
    /// Problems by their message and first place, to find one that is known.
    known: HashMap<(String, Option<Start>), Vec<usize>>,
}

/// What is wrong with the text of a file that is not RON.
pub fn not_ron(error: SyntaxError, file: FileId) -> Problem {
    let mut problem = Problem::error("syntax", error.message).at(&Place { file, span: error.span }, "");
    problem.help = error.help;
    if let Some((span, seen)) = error.beside {
        problem = problem.at(&Place { file, span }, seen);
    }
    match error.remedy {
        Some(remedy) => problem.edit(Place { file, span: remedy.span }, remedy.old, remedy.new),
        None => problem,
    }
}

/// File and byte.
type Start = (FileId, usize);

fn start(problem: &Problem) -> Option<Start> {
    problem.labels.first().map(|label| (label.place.file, label.place.span.start))
}

impl Problems {
    /// Adds a problem.
    pub(crate) fn push(&mut self, problem: Problem) {
        // That a plug-in is not trusted is one cause, however many blocks it has: the advice names the plug-in.
        let is_about_trust = problem.code == UNTRUSTED;
        let same = |other: &usize| {
            let other = &self.all[*other];
            let is_same =
                if is_about_trust { other.help == problem.help } else { other.labels == problem.labels };
            other.code == problem.code && is_same
        };
        let place = if is_about_trust { None } else { start(&problem) };
        let known = self.known.entry((problem.message.clone(), place)).or_default();
        if !known.iter().any(same) {
            known.push(self.all.len());
            self.all.push(problem);
        }
    }

    /// Adds problems.
    pub(crate) fn extend(&mut self, more: impl IntoIterator<Item = Problem>) {
        more.into_iter().for_each(|problem| self.push(problem));
    }

    /// All, errors first, in the order of files and places.
    pub(crate) fn sorted(&self) -> Vec<Problem> {
        let mut all = self.all.clone();
        all.sort_by_key(|problem| (problem.severity, start(problem)));
        all
    }

    /// Whether a block that is declared by another name was told to be meant by this one.
    pub(crate) fn names(&self, name: &str) -> bool {
        let mut unknown = self.all.iter().filter(|problem| problem.code == "unknown_block_name");
        unknown.any(|problem| problem.remedy().is_some_and(|edit| edit.new == name))
    }

    /// Whether any of them stops the run.
    pub(crate) fn any_error(&self) -> bool {
        self.all.iter().any(|problem| problem.severity == Severity::Error)
    }
}

/// Adds the edit that writes the known word which is meant beyond doubt by the one at a place; the word may stand in
/// quotes there.
pub(crate) fn mended<'a>(
    problem: Problem,
    place: Place,
    word: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Problem {
    match surely(word, known) {
        Some(meant) => mended_to(problem, place, word, meant),
        None => problem,
    }
}

/// Adds the edit that writes another word for the one at a place, which may stand in quotes there.
pub(crate) fn mended_to(problem: Problem, place: Place, word: &str, meant: &str) -> Problem {
    let span = match place.span.len().checked_sub(word.len()) {
        Some(0) => place.span.clone(),
        Some(2) => place.span.start + 1..place.span.end - 1,
        _ => return problem,
    };
    problem.edit(Place { span, ..place }, word, meant)
}

/// A member of a set at `place` is none of the known ones. What stands `within` begins the message.
pub(crate) fn unknown_member(within: &str, word: &str, place: Place, known: &[&str]) -> Problem {
    let all = list(known);
    let problem = Problem::error("parameter", format!("{within}`{word}` is not known here")).at(&place, "");
    let problem = mended(problem, place, word, known.iter().copied());
    match closest(word, known.iter().copied()) {
        _ if known.is_empty() => problem.help("remove it: these parentheses are empty"),
        Some(meant) => problem.help(format!("did you mean `{meant}`? Known here: {all}")),
        None => problem.help(format!("known here: {all}")),
    }
}

/// So many unknown names are compared with the known ones; nobody reads the advice on more.
pub(crate) const GUESSES: usize = 100;

/// Most words in a row.
const WORDS: usize = 40;

/// Words in a row for people: `a`, `b` and `c`; of very many the first.
pub(crate) fn list<S: AsRef<str>>(words: &[S]) -> String {
    let quoted: Vec<String> = words.iter().take(WORDS).map(|word| format!("`{}`", word.as_ref())).collect();
    match quoted.as_slice() {
        [] => "none".to_owned(),
        [one] => one.clone(),
        all if words.len() > WORDS => format!("{} and {} more", all.join(", "), words.len() - WORDS),
        [head @ .., last] => format!("{} and {last}", head.join(", ")),
    }
}
