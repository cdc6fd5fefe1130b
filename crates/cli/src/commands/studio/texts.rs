//! The text of a model beside its picture: read, checked while somebody writes, completed, saved.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use blocksim_block::problem::{Problem, Severity};
use blocksim_diagram::{Options, SourceFile, Sources, compile_and_keep};
use blocksim_edit::{Completion, CompletionKind, Learned, TextChange, complete};
use blocksim_recording::{MOST_TEXT, limited_text};
use blocksim_studio::Reply;
use blocksim_syntax::{TokenKind, Tokens};
use serde_json::{Value, json};

use super::values::{Changes, refusal};
use crate::disk::{Disk, Overlaid};
use crate::failure::Failure;
use crate::terminal::diff::difference;
use crate::terminal::prose::prose;
use crate::trust::{Plugins, is_about_trust};

/// Most problems and most completions that are shown.
const PROBLEMS: usize = 100;
const COMPLETIONS: usize = 400;

/// The texts of a model: those of its files that are diagrams or values.
pub fn files(root: &Path, files: &[PathBuf]) -> Vec<String> {
    let is_text = |path: &&PathBuf| path.extension().is_some_and(|ending| ending == "ron");
    files.iter().filter(is_text).map(|path| shown(root, path)).collect()
}

/// A file of a project as the page names it.
fn shown(root: &Path, path: &Path) -> String {
    path.strip_prefix(root).unwrap_or(path).display().to_string()
}

/// The file that the page names, if it is one of the model.
fn known(root: &Path, files: &[PathBuf], name: &str) -> Option<PathBuf> {
    files.iter().find(|path| shown(root, path) == name).cloned()
}

fn unknown(name: &str) -> Reply {
    Reply::refused(format!("`{name}` is not a file of this model"), "choose another one of the list")
}

/// The text of a file.
pub fn text(root: &Path, all: &[PathBuf], body: &Value) -> Reply {
    let name = body["file"].as_str().filter(|name| !name.is_empty()).map(str::to_owned);
    let Some(name) = name.or_else(|| files(root, all).into_iter().next()) else {
        return Reply::refused("the model has no text that can be read", "look at its problems");
    };
    let Some(path) = known(root, all, &name) else { return unknown(&name) };
    match limited_text(&path, MOST_TEXT) {
        Ok(text) => Reply::Data(
            json!({ "file": name, "files": files(root, all), "text": text, "tokens": tokens(&text) }),
        ),
        Err(error) => {
            refusal(Failure::unreadable(format!("cannot read `{name}`: {}", crate::disk::reason(&error))))
        }
    }
}

/// What is coloured: places of comments, texts, numbers and kinds, in units of UTF-16 as the page counts them.
fn tokens(text: &str) -> Value {
    let mut units = Units::of(text);
    let all: Vec<blocksim_syntax::Token> = Tokens::of_draft(text).collect();
    let mut spans = Vec::new();
    for (n, token) in all.iter().enumerate() {
        let next = all.get(n + 1).map(|next| next.of(text));
        let class = match token.kind {
            TokenKind::LineComment | TokenKind::BlockComment => "c",
            TokenKind::Text | TokenKind::RawText if next == Some(":") => "k",
            TokenKind::Text | TokenKind::RawText | TokenKind::Character => "t",
            TokenKind::Number => "n",
            TokenKind::Word if next == Some(":") => "k",
            TokenKind::Word => "w",
            _ => continue,
        };
        let start = units.at(token.start());
        spans.push(json!([start, units.at(token.end()) - start, class]));
    }
    spans.into()
}

/// Places of a text in units of UTF-16, for bytes that come in order.
struct Units<'t> {
    text: &'t str,
    byte: usize,
    unit: usize,
}

impl<'t> Units<'t> {
    fn of(text: &'t str) -> Units<'t> {
        Units { text, byte: 0, unit: 0 }
    }

    fn at(&mut self, byte: usize) -> usize {
        let byte = byte.min(self.text.len());
        if byte < self.byte {
            (self.byte, self.unit) = (0, 0);
        }
        self.unit += self.text.get(self.byte..byte).unwrap_or_default().encode_utf16().count();
        self.byte = byte;
        self.unit
    }
}

/// The byte of a place in units of UTF-16.
fn byte_at(text: &str, unit: usize) -> usize {
    let mut units = 0;
    for (at, sign) in text.char_indices() {
        if units >= unit {
            return at;
        }
        units += sign.len_utf16();
    }
    text.len()
}

/// What is wrong with a text that somebody is writing, and what is coloured in it.
pub fn draft(
    root: &Path,
    model: &Path,
    all: &[PathBuf],
    body: &Value,
    learned: &std::sync::Mutex<Learned>,
) -> Reply {
    let (Some(name), Some(text)) = (body["file"].as_str(), body["text"].as_str()) else {
        return Reply::refused("a file and its text are needed", "");
    };
    let Some(path) = known(root, all, name) else { return unknown(name) };
    let disk = Overlaid {
        disk: Disk::with(Plugins::looking()),
        texts: BTreeMap::from([(path.clone(), text.to_owned())]),
    };
    let sources = Sources::new(&disk);
    let (top, compiled) = compile_and_keep(&sources, model, &Options::default());
    if let (Some(top), Ok(mut learned)) = (&top, learned.lock()) {
        learned.learn(top, &sources, &compiled);
    }
    let files = sources.all();
    let problems = compiled.problems.iter().filter(|problem| !is_about_trust(problem)).take(PROBLEMS);
    let problems: Vec<Value> = problems.map(|problem| data(problem, &files, root, &path, text)).collect();
    Reply::Data(json!({ "problems": problems, "tokens": tokens(text) }))
}

/// A problem for the text pane: where it is, if it is in this text.
fn data(problem: &Problem, files: &[SourceFile], root: &Path, path: &Path, text: &str) -> Value {
    let severity = match problem.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let place = |label: &blocksim_block::problem::Label| {
        let file = files.get(label.place.file.0 as usize)?;
        Some((file, label.place.span.clone()))
    };
    let first = problem.labels.first().and_then(place);
    let here = problem.labels.iter().filter_map(place).find(|(file, _)| file.path == path);
    let mut data = json!({ "severity": severity, "message": problem.message, "help": problem.help, "code": problem.code });
    if let Some((file, span)) = here.as_ref().or(first.as_ref()) {
        let line = file.text.get(..span.start).map_or(0, |before| before.matches('\n').count()) + 1;
        data["file"] = shown(root, &file.path).into();
        data["line"] = line.into();
    }
    if let Some((_, span)) = here {
        let mut units = Units::of(text);
        data["at"] = json!([units.at(span.start), units.at(span.end)]);
    }
    if let Some(edit) = problem.remedy()
        && files.get(edit.place.file.0 as usize).is_some_and(|file| file.path == path)
        && text.get(edit.place.span.clone()) == Some(edit.old.as_str())
    {
        let mut units = Units::of(text);
        data["fix"] = json!({ "at": [units.at(edit.place.span.start), units.at(edit.place.span.end)], "new": edit.new });
    }
    data
}

/// What may follow at a place of a text.
pub fn completions(
    root: &Path,
    model: &Path,
    all: &[PathBuf],
    body: &Value,
    learned: &std::sync::Mutex<Learned>,
) -> Reply {
    let (Some(name), Some(text), Some(unit)) =
        (body["file"].as_str(), body["text"].as_str(), body["at"].as_u64())
    else {
        return Reply::refused("a file, its text and a place in it are needed", "");
    };
    let Some(path) = known(root, all, name) else { return unknown(name) };
    let Ok(mut learned) = learned.lock() else { return Reply::Data(json!([])) };
    if learned.blocks.is_empty() {
        let disk = Disk::with(Plugins::looking());
        let sources = Sources::new(&disk);
        let (top, compiled) = compile_and_keep(&sources, model, &Options::default());
        if let Some(top) = &top {
            learned.learn(top, &sources, &compiled);
        }
    }
    let at = byte_at(text, usize::try_from(unit).unwrap_or(usize::MAX));
    let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let folder = if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder };
    let all = complete(text, at, learned.blocks.get(&path), &learned.choices, &folder, true, prose);
    let item = |one: &Completion| {
        let kind = match one.kind {
            CompletionKind::Section => "section",
            CompletionKind::Kind => "kind",
            CompletionKind::Member => "member",
            CompletionKind::Word => "word",
            CompletionKind::Name => "name",
            CompletionKind::File => "file",
            CompletionKind::Folder => "folder",
        };
        let doc = one.doc.split("\n\n").next().unwrap_or_default();
        json!({ "label": one.label, "kind": kind, "detail": one.detail, "doc": doc, "insert": one.insert, "places": one.has_places })
    };
    Reply::Data(all.iter().take(COMPLETIONS).map(item).collect())
}

/// Saves a text in the place of the one that it was made from; what others have written since stays, and is shown.
pub fn save(root: &Path, all: &[PathBuf], body: &Value, changes: &mut Changes) -> Reply {
    let (Some(name), Some(base), Some(text)) =
        (body["file"].as_str(), body["base"].as_str(), body["text"].as_str())
    else {
        return Reply::refused("a file, its text and the text before are needed", "");
    };
    let Some(path) = known(root, all, name) else { return unknown(name) };
    // A page has line feeds alone.
    let text = match base.contains("\r\n") {
        true => text.replace("\r\n", "\n").replace('\n', "\r\n"),
        false => text.to_owned(),
    };
    let present = limited_text(&path, MOST_TEXT).unwrap_or_default();
    if present == text {
        return Reply::Data(
            json!({ "message": format!("{name} is so already"), "difference": "", "text": text }),
        );
    }
    if present != base {
        let reason = json!({
            "message": format!("`{name}` has been changed by others since it was read here"),
            "help": "what you wrote is kept here: take theirs, or replace it by yours",
            "theirs": present, "difference": difference(&path, base, &present),
        });
        return Reply::Refused(reason);
    }
    let change = TextChange { path, old: Some(present), new: text.clone() };
    match changes.write_all(vec![change], &format!("{name} is saved")) {
        Reply::Data(mut done) => {
            done["text"] = text.into();
            Reply::Data(done)
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_counted_as_the_page_does() {
        let text = "π = \"𝛑\", // 𝛑\nx";
        let mut units = Units::of(text);
        let quote = text.find('"').unwrap();
        assert_eq!((units.at(quote), units.at(text.len()), units.at(quote)), (4, 17, 4));
        assert_eq!((byte_at(text, 4), byte_at(text, 17), byte_at(text, 99)), (quote, text.len(), text.len()));
        assert_eq!(tokens("a: \"π\" // x"), json!([[0, 1, "k"], [3, 3, "t"], [7, 4, "c"]]));
    }
}
