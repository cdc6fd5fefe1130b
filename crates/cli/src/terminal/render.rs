//! Problems as text: in full with the places they are about, in a line, or as JSON.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use blocksim_block::problem::{FileId, Label, Problem, Severity};
use serde_json::{Value, json};

use crate::exit::Exit;
use crate::terminal::clean::clean;
use crate::terminal::places::{Texts, within};
use crate::terminal::prose::wrapped;

/// A problem with the lines of the files it is about, notes and help, for a person. An empty line is behind what has lines.
pub fn full(problem: &Problem, texts: &Texts, colour: bool) -> String {
    let level = match problem.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let title = level.primary_title(clean(&problem.message)).id(problem.code);
    let mut group = Group::with_title(title);
    let mut far = Vec::new();
    for file in files_in_order(&problem.labels) {
        let Some(source) = texts.file(file.0) else { continue };
        let path = clean(&source.path.display().to_string()).into_owned();
        let mut snippet = Snippet::source(&*source.text).path(path);
        let mut shown: Vec<usize> = Vec::new();
        for (n, label) in problem.labels.iter().enumerate().filter(|(_, label)| label.place.file == file) {
            let kind = if n == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
            let span = within(&source.text, &label.place.span);
            if shown.iter().any(|other| are_far_apart(&source.text, *other, span.start)) {
                let place = texts
                    .located(&label.place)
                    .map_or_else(String::new, |(_, line, column)| format!("line {line}, column {column}"));
                far.push(format!("{place}: {}", clean(&label.text)));
                continue;
            }
            shown.push(span.start);
            let text = (!label.text.is_empty()).then(|| clean(&label.text));
            snippet = snippet.annotation(kind.span(span).label(text));
        }
        group = group.element(snippet);
    }
    for note in far {
        group = group.element(Level::NOTE.message(wrapped(&note, LINE)));
    }
    for note in &problem.notes {
        group = group.element(Level::NOTE.message(wrapped(&clean(note), LINE)));
    }
    if let Some(help) = &problem.help {
        group = group.element(Level::HELP.message(wrapped(&clean(help), LINE)));
    }
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    let text = renderer.render(&[group]);
    if problem.labels.is_empty() { without_margin(&text) } else { text + "\n" }
}

/// Whether two places are in one line that is too long to be shown from the one to the other.
fn are_far_apart(text: &str, one: usize, other: usize) -> bool {
    let between = one.min(other)..one.max(other);
    between.len() > WIDE && !text[between].contains('\n')
}

/// A problem without a place needs no margin for the numbers of lines.
fn without_margin(text: &str) -> String {
    let is_margin = |line: &&str| uncoloured(line).trim() == "|";
    let mut lines = text.lines().filter(|line| !is_margin(line));
    let first = lines.next().unwrap_or_default().to_owned();
    lines.fold(first, |text, line| format!("{text}\n {line}"))
}

/// A line without the marks that colour it.
fn uncoloured(line: &str) -> String {
    let mut parts = line.split('\x1b');
    let first = parts.next().unwrap_or_default().to_owned();
    parts.filter_map(|part| part.split_once('m')).fold(first, |text, (_, part)| text + part)
}

/// `file:line:column: error[code]: message`, for editors and `grep`.
pub fn short(problem: &Problem, texts: &Texts) -> String {
    let said = format!("{}[{}]: {}", word(problem.severity), problem.code, clean(&problem.message));
    match problem.labels.first().and_then(|label| texts.located(&label.place)) {
        Some((file, line, column)) => {
            format!("{}:{line}:{column}: {said}", clean(&file.path.display().to_string()))
        }
        None => said,
    }
}

/// The same as data, with the exit code of the program if it ends with this problem. Lines and columns count from 1,
/// columns in characters; spans are bytes.
pub fn json(problem: &Problem, texts: &Texts, exit: Option<Exit>) -> Value {
    let label = |label: &Label| {
        let (file, line, column) = texts.located(&label.place)?;
        let span = &label.place.span;
        Some(json!({
            "file": file.path.display().to_string(),
            "line": line,
            "column": column,
            "start": span.start,
            "end": span.end,
            "text": label.text,
        }))
    };
    json!({
        "v": 1,
        "type": "diagnostic",
        "severity": word(problem.severity),
        "code": problem.code,
        "message": problem.message,
        "labels": problem.labels.iter().filter_map(label).collect::<Vec<_>>(),
        "notes": problem.notes,
        "help": problem.help,
        "exit": exit.map(Exit::code),
        "edit": problem.remedy().and_then(|edit| {
            let (file, line, column) = texts.located(&edit.place)?;
            Some(json!({
                "file": file.path.display().to_string(),
                "line": line,
                "column": column,
                "start": edit.place.span.start,
                "end": edit.place.span.end,
                "old": edit.old,
                "new": edit.new,
            }))
        }),
    })
}

/// Longest line of a note or a help, in characters.
const LINE: usize = 100;
/// Most bytes of a line between two places that are marked in it.
const WIDE: usize = 300;

/// The first of many problems, in their order; the severe ones where there is not room for all.
pub fn first(problems: &[Problem], most: usize) -> Vec<&Problem> {
    let mut order: Vec<usize> = (0..problems.len()).collect();
    order.sort_by_key(|at| problems[*at].severity);
    order.truncate(most);
    order.sort_unstable();
    order.into_iter().map(|at| &problems[at]).collect()
}

/// Number of errors among these problems.
pub fn errors(problems: &[Problem]) -> usize {
    problems.iter().filter(|problem| problem.severity == Severity::Error).count()
}

/// `2 errors, 1 warning`, `1 note`; `no problems`.
pub fn tally(problems: &[Problem]) -> String {
    let count = |severity| problems.iter().filter(|problem| problem.severity == severity).count();
    let parts =
        [Severity::Error, Severity::Warning, Severity::Note].map(|severity| (count(severity), severity));
    let parts = parts.iter().filter(|(n, _)| *n > 0);
    let said: Vec<String> = parts.map(|&(n, severity)| plural(n, word(severity))).collect();
    if said.is_empty() { "no problems".to_owned() } else { said.join(", ") }
}

/// `1 error`, `2 errors`.
pub fn plural(n: usize, name: &str) -> String {
    format!("{n} {name}{}", if n == 1 { "" } else { "s" })
}

fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}

/// Each file once, the most guilty first.
fn files_in_order(labels: &[Label]) -> Vec<FileId> {
    let mut files = Vec::new();
    for label in labels {
        if !files.contains(&label.place.file) {
            files.push(label.place.file);
        }
    }
    files
}

#[cfg(test)]
#[path = "render_tests.rs"]
mod tests;
