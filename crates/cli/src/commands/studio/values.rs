//! Parameters of a model, and what was changed in its texts.

use std::path::{Path, PathBuf};

use blocksim_block::{Bound, Requirement};
use blocksim_diagram::{Origin, Sources, Target, WrittenUnit, targets};
use blocksim_edit::TextChange;
use blocksim_recording::{MOST_TEXT, limited_text};
use blocksim_studio::Reply;
use serde_json::{Value, json};

use super::model::place;
use super::sheets::Sheets;
use crate::commands::params::set::edit;
use crate::commands::params::table::{located, shown};
use crate::disk::{Disk, write_file};
use crate::editing::{take_back, write};
use crate::failure::Failure;
use crate::terminal::console::Console;
use crate::terminal::diff::difference;
use crate::terminal::places::Texts;

/// Most changes that can be taken back.
const KEPT: usize = 200;

/// What was written, so that it can be taken back, and what was taken back.
#[derive(Default)]
pub struct Changes {
    done: Vec<Change>,
    undone: Vec<Change>,
}

/// Texts that were written together.
struct Change {
    texts: Vec<TextChange>,
}

/// What a failure says, for the page.
pub fn refusal(failure: Failure) -> Reply {
    let message = failure.message();
    let help = failure.into_problems().into_iter().find_map(|problem| problem.help);
    Reply::refused(message, help.unwrap_or_default())
}

/// All parameters that are written somewhere.
pub fn list(root: &Path, model: &Path, may_edit: bool) -> Value {
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let (all, _) = targets(&sources, &place(root, model));
    let files = sources.all();
    let texts = Texts::of(&files);
    let sheets = Sheets::of(&files, root);
    let is_shown = |target: &&Target| !matches!(target.origin, Origin::Kind(_)) && !target.is_item;
    let data = |target: &Target| {
        let (value, unit, is_written) = shown(target);
        let (Origin::Text(place) | Origin::Declared(place)) = &target.origin else { return json!(null) };
        let (sheet, [source, note, tolerance]) = sheets.at(place);
        let place = located(place, &texts);
        let place =
            Path::new(&place).strip_prefix(root).map_or(place.clone(), |rest| rest.display().to_string());
        let worth = if is_written { String::new() } else { format!("{value} {unit}").trim().to_owned() };
        let lines = target.written.lines().count();
        let written = if lines > 1 { "" } else { unquoted(&target.written) };
        json!({
            "name": target.name, "written": written, "lines": lines, "worth": worth, "place": place, "sharers": target.sharers,
            "sheet": sheet, "unit": unit, "source": source, "note": note, "tolerance": tolerance, "expression": !is_written,
            "range": range(target), "ends": ends(target),
        })
    };
    json!({ "edit": may_edit, "model": model.display().to_string(), "targets": all.iter().filter(is_shown).map(data).collect::<Vec<_>>() })
}

/// Least and largest value that the kind of block allows, each with whether it is allowed itself, in the unit in which this one is
/// written; null where there is no such end, or where a number is written in another way.
fn ends(target: &Target) -> Value {
    let from_si = |si: f64| match &target.written_unit {
        WrittenUnit::Si => Some(si),
        // Without the dust of the conversion.
        WrittenUnit::One(unit) => format!("{:.14e}", unit.from_si(si)).parse().ok(),
        WrittenUnit::Decibels | WrittenUnit::Unclear => None,
    };
    let mut ends = [Value::Null, Value::Null];
    for requirement in target.requires.list {
        let (at, end, is_allowed) = match *requirement {
            Requirement::Above(Bound::Number(end)) => (0, end, false),
            Requirement::AtLeast(Bound::Number(end)) => (0, end, true),
            Requirement::Below(Bound::Number(end)) => (1, end, false),
            Requirement::AtMost(Bound::Number(end)) => (1, end, true),
            _ => continue,
        };
        if let Some(end) = from_si(end).filter(|end: &f64| end.is_finite()) {
            ends[at] = json!([end, is_allowed]);
        }
    }
    json!(ends)
}

/// What the kind of block requires, in words with units, where its [`ends`] are not all of it; else empty.
fn range(target: &Target) -> String {
    let is_end = |requirement: &Requirement| match requirement {
        Requirement::Finite => true,
        Requirement::Above(bound)
        | Requirement::AtLeast(bound)
        | Requirement::Below(bound)
        | Requirement::AtMost(bound) => matches!(bound, Bound::Number(_)),
        _ => false,
    };
    let is_told = matches!(target.written_unit, WrittenUnit::Si | WrittenUnit::One(_))
        && target.requires.list.iter().all(is_end);
    if is_told { String::new() } else { target.requires.range(&target.unit) }
}

/// Without the quotes of a text.
pub fn unquoted(text: &str) -> &str {
    text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text)
}

impl Changes {
    /// Writes another value of a parameter, in the place of the one that was seen there.
    pub fn set(&mut self, model: &Path, body: &Value, console: Console) -> Reply {
        let texts = ["target", "value", "was"].map(|name| body[name].as_str());
        let [Some(target), Some(value), Some(was)] = texts else {
            return Reply::refused("a parameter, its value and the one before are needed", "");
        };
        self.replace(model, (target, value), Some(was), console)
    }

    /// Writes another value of a parameter; where one `was` seen there, only if it is there still.
    pub fn replace(
        &mut self,
        model: &Path,
        (target, value): (&str, &str),
        was: Option<&str>,
        console: Console,
    ) -> Reply {
        // Someone sees how many parts share it, and wants it so.
        let edit = match edit(model, target, value, true, console) {
            Ok(edit) => edit,
            Err(failure) => return refusal(failure),
        };
        if edit.old == edit.new {
            return Reply::Data(json!({ "message": edit.told(), "difference": "" }));
        }
        let written = unquoted(edit.written());
        if let Some(was) = was.filter(|was| *was != written) {
            return Reply::Refused(json!({
                "message": format!("`{target}` has been changed by others meanwhile: it is {written}, and was {was}"),
                "help": format!("what you typed stays; Enter once more writes it in the place of {written}, Esc takes that"),
                "written": written,
            }));
        }
        let told = edit.told();
        self.write(edit.path, edit.old, edit.new, &told)
    }

    /// Writes another text in the place of one that is still there.
    pub fn write(&mut self, path: PathBuf, old: String, new: String, told: &str) -> Reply {
        self.write_all(vec![TextChange { path, old: Some(old), new }], told)
    }

    /// Writes texts, all of them or none, in the place of those that are still there.
    pub fn write_all(&mut self, texts: Vec<TextChange>, told: &str) -> Reply {
        if let Err(failure) = write(&texts) {
            return refusal(failure);
        }
        let done = json!({ "message": told, "difference": differences(&texts) });
        if self.done.len() == KEPT {
            self.done.remove(0);
        }
        self.done.push(Change { texts });
        self.undone.clear();
        Reply::Data(done)
    }

    /// Takes the last change back; what others have changed in other lines since stays.
    pub fn undo(&mut self) -> Reply {
        let Some(mut change) = self.done.pop() else {
            return Reply::refused("nothing was changed here that could be taken back", "");
        };
        // The way back is a change as well: the new texts become the old ones.
        let mut texts = Vec::with_capacity(change.texts.len());
        for text in &change.texts {
            let path = &text.path;
            let now = limited_text(path, MOST_TEXT).ok();
            let Some(way_back) = now.and_then(|now| way_back(text, now)) else {
                let reply = Reply::refused(
                    format!("`{}` has been changed by others since; it stays as it is", path.display()),
                    "take the change back in an editor; as soon as the lines are as they were, it can be taken back here as well",
                );
                self.done.push(change);
                return reply;
            };
            texts.push(way_back);
        }
        change.texts = texts;
        for (n, text) in change.texts.iter().enumerate() {
            if let Err(failure) = take_back(text) {
                // What is half taken back would be another model.
                for text in &change.texts[..n] {
                    drop(write_file(&text.path, text.new.as_bytes(), text.old.is_some()));
                }
                self.done.push(change);
                return refusal(failure);
            }
        }
        let difference: String = change
            .texts
            .iter()
            .map(|TextChange { path, old, new }| difference(path, new, old.as_deref().unwrap_or_default()))
            .collect();
        let were = if change.texts.len() == 1 { "as it was" } else { "as they were" };
        let message = format!("{} {were} before the last change", names(&change.texts));
        self.undone.push(change);
        Reply::Data(json!({ "message": message, "difference": difference }))
    }

    /// Makes the change again that was taken back last.
    pub fn redo(&mut self) -> Reply {
        let Some(change) = self.undone.pop() else {
            return Reply::refused("nothing was taken back that could be done again", "");
        };
        if let Err(failure) = write(&change.texts) {
            self.undone.push(change);
            return refusal(failure);
        }
        let message = format!("{} changed again", names(&change.texts));
        let done = json!({ "message": message, "difference": differences(&change.texts) });
        self.done.push(change);
        Reply::Data(done)
    }
}

/// What leads from the text as it is `now` back to the one before a change: nothing where others have changed it since on both sides of
/// the changed lines, or in them.
fn way_back(change: &TextChange, now: String) -> Option<TextChange> {
    let TextChange { path, old, new } = change;
    if now == *new {
        return Some(TextChange { path: path.clone(), old: old.clone(), new: now });
    }
    let lines = |text: &str| text.split_inclusive('\n').map(str::to_owned).collect::<Vec<String>>();
    let (old, new, present) = (lines(old.as_ref()?), lines(new), lines(&now));
    let before = old.iter().zip(&new).take_while(|(a, b)| a == b).count();
    let rest = old[before..].iter().rev().zip(new[before..].iter().rev());
    let behind = rest.take_while(|(a, b)| a == b).count();
    let until = new.len() - behind;
    // Either all up to the end of what was changed is as it was, or all from its beginning on.
    let (kept, end) = if present.starts_with(&new[..until]) {
        (&present[..before], until)
    } else if present.ends_with(&new[before..]) {
        let begin = present.len() - (new.len() - before);
        (&present[..begin], present.len() - behind)
    } else {
        return None;
    };
    let text = [kept, &old[before..old.len() - behind], &present[end..]].concat().concat();
    Some(TextChange { path: path.clone(), old: Some(text), new: now })
}

/// What changes in texts.
pub fn differences(texts: &[TextChange]) -> String {
    texts
        .iter()
        .map(|text| difference(&text.path, text.old.as_deref().unwrap_or_default(), &text.new))
        .collect()
}

/// `servo.ron is`, `servo.ron and drive.ron are`.
fn names(texts: &[TextChange]) -> String {
    let names: Vec<String> = texts.iter().map(|text| text.path.display().to_string()).collect();
    format!("{} {}", names.join(" and "), if names.len() == 1 { "is" } else { "are" })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back(old: &str, new: &str, now: &str) -> Option<String> {
        let change = TextChange { path: "a.ron".into(), old: Some(old.to_owned()), new: new.to_owned() };
        way_back(&change, now.to_owned()).and_then(|back| back.old)
    }

    #[test]
    fn what_others_have_changed_in_other_lines_stays() {
        let (old, new) = ("a\nb\nc\nd", "a\nB\nc\nd");
        let cases = [
            (new, Some("a\nb\nc\nd")),
            ("a\nB\nc\nd\n// more\n", Some("a\nb\nc\nd\n// more\n")),
            ("a\nB\nc2\nc\nd", Some("a\nb\nc2\nc\nd")),
            ("// first\na\nB\nc\nd", Some("// first\na\nb\nc\nd")),
            ("a\nB2\nc\nd", None),
            ("// first\na\nB\nc\nd\n// last", None),
            (old, None),
            ("", None),
        ];
        for (now, wanted) in cases {
            assert_eq!(back(old, new, now).as_deref(), wanted, "{now:?}");
        }
        // Lines that came, that went, and all of them.
        assert_eq!(back("a\nc", "a\nb\nc", "a\nb\nc\nd").as_deref(), Some("a\nc\nd"));
        assert_eq!(back("a\nc\n", "a\nb\nc\n", "a\nb\nc\nd\n").as_deref(), Some("a\nc\nd\n"));
        assert_eq!(back("a\nb\nc\n", "a\nc\n", "z\na\nc\n").as_deref(), Some("z\na\nb\nc\n"));
        assert_eq!(back("a", "b", "b\n").as_deref(), None);
    }
}
