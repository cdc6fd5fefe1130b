//! Parameters of a model, and what was changed in its texts.

use std::path::{Path, PathBuf};

use blocksim_diagram::{Origin, Sources, Target, targets};
use blocksim_recording::{MOST_TEXT, limited_text};
use blocksim_studio::Reply;
use serde_json::{Value, json};

use super::model::place;
use crate::commands::params::set::edit;
use crate::commands::params::table::{located, shown};
use crate::disk::{Disk, write_file};
use crate::failure::Failure;
use crate::terminal::console::Console;
use crate::terminal::diff::difference;
use crate::terminal::places::Texts;

/// Most changes that can be taken back.
const KEPT: usize = 200;

/// What was written, so that it can be taken back.
#[derive(Default)]
pub struct Changes(Vec<Change>);

struct Change {
    path: PathBuf,
    old: String,
    new: String,
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
    let is_shown = |target: &&Target| !matches!(target.origin, Origin::Kind(_)) && !target.is_item;
    let data = |target: &Target| {
        let (value, unit, is_written) = shown(target);
        let (Origin::Text(place) | Origin::Declared(place)) = &target.origin else { return json!(null) };
        let place = located(place, &texts);
        let place =
            Path::new(&place).strip_prefix(root).map_or(place.clone(), |rest| rest.display().to_string());
        let worth = if is_written { String::new() } else { format!("{value} {unit}").trim().to_owned() };
        let lines = target.written.lines().count();
        let written = if lines > 1 { "" } else { unquoted(&target.written) };
        json!({
            "name": target.name, "written": written, "lines": lines, "worth": worth, "place": place, "sharers": target.sharers,
        })
    };
    json!({ "edit": may_edit, "targets": all.iter().filter(is_shown).map(data).collect::<Vec<_>>() })
}

fn unquoted(text: &str) -> &str {
    text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text)
}

impl Changes {
    /// Writes another value of a parameter.
    pub fn set(&mut self, model: &Path, body: &Value, console: Console) -> Reply {
        let (Some(target), Some(value)) = (body["target"].as_str(), body["value"].as_str()) else {
            return Reply::refused("a parameter and its value are needed", "");
        };
        // Someone sees how many parts share it, and wants it so.
        let edit = match edit(model, target, value, true, console) {
            Ok(edit) => edit,
            Err(failure) => return refusal(failure),
        };
        if edit.old == edit.new {
            return Reply::Data(json!({ "message": edit.told(), "difference": "" }));
        }
        let told = edit.told();
        self.write(edit.path, edit.old, edit.new, &told)
    }

    /// Writes another text in the place of one that is still there.
    pub fn write(&mut self, path: PathBuf, old: String, new: String, told: &str) -> Reply {
        if limited_text(&path, MOST_TEXT).ok().as_deref() != Some(&old) {
            let message = format!("`{}` has been changed meanwhile", path.display());
            return Reply::refused(message, "look at it as it is now");
        }
        if let Err(failure) = write_file(&path, new.as_bytes(), true) {
            return refusal(failure);
        }
        let done = json!({ "message": told, "difference": difference(&path, &old, &new) });
        if self.0.len() == KEPT {
            self.0.remove(0);
        }
        self.0.push(Change { path, old, new });
        Reply::Data(done)
    }

    /// Takes the last change back, unless somebody else has changed the file since.
    pub fn undo(&mut self) -> Reply {
        let Some(Change { path, old, new }) = self.0.pop() else {
            return Reply::refused("nothing was changed here that could be taken back", "");
        };
        let name = path.display();
        if limited_text(&path, MOST_TEXT).ok().as_deref() != Some(&new) {
            return Reply::refused(
                format!("`{name}` has been changed by others since; it stays as it is"),
                "take the change back in an editor",
            );
        }
        match write_file(&path, old.as_bytes(), true) {
            Ok(()) => Reply::Data(json!({
                "message": format!("{name} is as it was before the last change"),
                "difference": difference(&path, &new, &old),
            })),
            Err(failure) => refusal(failure),
        }
    }
}
