//! Problems are gathered, not thrown: one report shows all of them.

use std::collections::hash_map::Entry;

use blocksim_block::UNTRUSTED;
use blocksim_block::problem::{FileId, Place, Problem, Severity};
use blocksim_signal::{closest, surely};
use blocksim_syntax::SyntaxError;
use foldhash::{HashMap, HashSet};

/// The problems found so far. A problem that is found twice (six instances of one file) is kept once.
#[derive(Debug, Clone, Default)]
pub(crate) struct Problems {
    all: Vec<Problem>,
    /// Problems by their message and first place, to find one that is known.
    known: HashMap<(String, Option<Start>), Vec<usize>>,
    /// Whether not all parameters of a diagram could be read: names that are unknown, there or further inside, may be among them.
    unread: bool,
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
    /// Not all parameters of a diagram could be read, which has been told.
    pub(crate) fn parameters_are_unread(&mut self) {
        self.unread = true;
    }

    /// Adds a problem.
    pub(crate) fn push(&mut self, problem: Problem) {
        if self.unread && problem.code == "expression" && problem.message.starts_with("unknown name") {
            return;
        }
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

    /// All, errors first, in the order of files and places; of one cause there is one.
    pub(crate) fn sorted(&self) -> Vec<Problem> {
        let mut all = self.all.clone();
        all.sort_by_key(|problem| (problem.severity, start(problem)));
        one_of_each_cause(all)
    }

    /// Whether a block that is declared by another name was told to be meant by this one.
    pub(crate) fn names(&self, name: &str) -> bool {
        let mut unknown = self.all.iter().filter(|problem| problem.code == "unknown_block_name");
        unknown.any(|problem| problem.remedy().is_some_and(|edit| edit.new == name))
    }

    /// Where there are errors.
    pub(crate) fn error_places(&self) -> Vec<Place> {
        let errors = self.all.iter().filter(|problem| problem.severity == Severity::Error);
        errors.filter_map(|problem| problem.labels.first()).map(|label| label.place.clone()).collect()
    }

    /// Whether any of them stops the run.
    pub(crate) fn any_error(&self) -> bool {
        self.all.iter().any(|problem| problem.severity == Severity::Error)
    }
}

/// Codes of problems whose message names the cause: what is missed has one name wherever it is used.
const NAMED: [&str; 6] = [
    "unknown_block_name",
    "unknown_port",
    "unknown_element",
    "unknown_parameter",
    "missing_parameter",
    "expression",
];

/// Most places of one cause that are shown.
const PLACES: usize = 4;

/// Problems of one cause become one: what a file says wrong for all of its instances, and what is missed in several places of a file.
fn one_of_each_cause(all: Vec<Problem>) -> Vec<Problem> {
    // What a block does not take up is missing in its bus as well.
    let ports: HashSet<String> = all
        .iter()
        .filter(|problem| problem.code == "unknown_port")
        .filter_map(|problem| last_name(&problem.message))
        .collect();
    let follows = |problem: &Problem| {
        problem.code == "unknown_element"
            && last_name(&problem.message).is_some_and(|name| ports.contains(&name))
    };
    let mut kept: Vec<Problem> = Vec::with_capacity(all.len());
    let mut instances: HashMap<(&str, Option<Start>, String), (usize, usize)> = HashMap::default();
    let mut places: HashMap<(&str, FileId, String), (usize, usize)> = HashMap::default();
    for problem in all.into_iter().filter(|problem| !follows(problem)) {
        let at = start(&problem);
        match instances.entry((problem.code, at, without_paths(&problem.message))) {
            Entry::Occupied(mut first) => {
                first.get_mut().1 += 1;
                continue;
            }
            Entry::Vacant(new) => new.insert((kept.len(), 0)),
        };
        if let (true, Some((file, _))) = (NAMED.contains(&problem.code), at) {
            match places.entry((problem.code, file, problem.message.clone())) {
                Entry::Occupied(mut first) => {
                    let (index, more) = first.get_mut();
                    match kept[*index].labels.len() < PLACES {
                        true => kept[*index].labels.extend(problem.labels),
                        false => *more += 1,
                    }
                    continue;
                }
                Entry::Vacant(new) => new.insert((kept.len(), 0)),
            };
        }
        kept.push(problem);
    }
    for (index, more) in instances.into_values().filter(|(_, more)| *more > 0) {
        let noun = if more == 1 { "instance" } else { "instances" };
        kept[index].notes.push(format!("{more} more {noun} of this file have the same"));
    }
    for (index, more) in places.into_values().filter(|(_, more)| *more > 0) {
        let noun = if more == 1 { "place" } else { "places" };
        kept[index].notes.push(format!("and in {more} more {noun} of this file"));
    }
    kept
}

/// The last name in quotes of a message.
fn last_name(message: &str) -> Option<String> {
    message.rsplit('`').nth(1).map(str::to_owned)
}

/// A message whose names of blocks have no path in front, which is what differs between instances of one file.
fn without_paths(message: &str) -> String {
    let name = |(at, part): (usize, &str)| match at % 2 {
        1 => part.rsplit('/').next().unwrap_or_default().to_owned(),
        _ => part.to_owned(),
    };
    message.split('`').enumerate().map(name).collect::<Vec<_>>().join("`")
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

/// A noun with its article. A `u` is read as in `unit`.
pub(crate) fn a(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'A', 'E', 'I', 'O']) { "an" } else { "a" };
    format!("{article} {noun}")
}

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
