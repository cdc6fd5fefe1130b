//! Problems as text: in full with the places they are about, in a line, or as JSON.

use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use blocksim_block::problem::{FileId, Label, Place, Problem, Severity};
use blocksim_diagram::SourceFile;
use serde_json::{Value, json};

use crate::exit::Exit;
use crate::terminal::prose::wrapped;

/// A problem with the lines of the files it is about, notes and help, for a person. An empty line is behind what has lines.
pub fn full(problem: &Problem, files: &[SourceFile], colour: bool) -> String {
    let level = match problem.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let title = level.primary_title(problem.message.as_str()).id(problem.code);
    let mut group = Group::with_title(title);
    for file in files_in_order(&problem.labels) {
        let Some(source) = files.get(file.0 as usize) else { continue };
        let path = source.path.display().to_string();
        let mut snippet = Snippet::source(&*source.text).path(path);
        for (n, label) in problem.labels.iter().enumerate().filter(|(_, label)| label.place.file == file) {
            let kind = if n == 0 { AnnotationKind::Primary } else { AnnotationKind::Context };
            let span = within(&source.text, &label.place.span);
            let text = (!label.text.is_empty()).then_some(label.text.as_str());
            snippet = snippet.annotation(kind.span(span).label(text));
        }
        group = group.element(snippet);
    }
    for note in &problem.notes {
        group = group.element(Level::NOTE.message(wrapped(note, LINE)));
    }
    if let Some(help) = &problem.help {
        group = group.element(Level::HELP.message(wrapped(help, LINE)));
    }
    let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
    let text = renderer.render(&[group]);
    if problem.labels.is_empty() { without_margin(&text) } else { text + "\n" }
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
pub fn short(problem: &Problem, files: &[SourceFile]) -> String {
    let said = format!("{}[{}]: {}", word(problem.severity), problem.code, problem.message);
    match problem.labels.first().and_then(|label| located(&label.place, files)) {
        Some((file, line, column)) => format!("{}:{line}:{column}: {said}", file.path.display()),
        None => said,
    }
}

/// The same as data, with the exit code of the program if it ends with this problem. Lines and columns count from 1,
/// columns in characters; spans are bytes.
pub fn json(problem: &Problem, files: &[SourceFile], exit: Option<Exit>) -> Value {
    let label = |label: &Label| {
        let (file, line, column) = located(&label.place, files)?;
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
            let (file, line, column) = located(&edit.place, files)?;
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

/// Number of errors among these problems.
pub fn errors(problems: &[Problem]) -> usize {
    problems.iter().filter(|problem| problem.severity == Severity::Error).count()
}

/// `2 errors, 1 warning`; `no problems`.
pub fn tally(problems: &[Problem]) -> String {
    let errors = errors(problems);
    let parts = [(errors, "error"), (problems.len() - errors, "warning")];
    let said: Vec<String> = parts.iter().filter(|(n, _)| *n > 0).map(|&(n, name)| plural(n, name)).collect();
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

/// File, line and column of a place.
pub fn located<'a>(place: &Place, files: &'a [SourceFile]) -> Option<(&'a SourceFile, usize, usize)> {
    let file = files.get(place.file.0 as usize)?;
    let before = &file.text[..within(&file.text, &place.span).start];
    let start_of_line = before.rfind('\n').map_or(0, |at| at + 1);
    let line = before.bytes().filter(|&byte| byte == b'\n').count() + 1;
    Some((file, line, before[start_of_line..].chars().count() + 1))
}

/// The span, moved to where the text has whole characters.
fn within(text: &str, span: &Range<usize>) -> Range<usize> {
    let whole = |at: usize| (0..=at.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
    let start = whole(span.start);
    start..whole(span.end).max(start)
}

#[cfg(test)]
#[path = "render_tests.rs"]
mod tests;
