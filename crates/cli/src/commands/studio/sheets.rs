//! Parameters in sheets as those of a workbook: which sheet each stands in and where its number comes from; and what a run had.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use blocksim_block::problem::Place;
use blocksim_diagram::{Origin, SourceFile, Sources, Target, targets};
use blocksim_params::{Arrangement, quantities};
use blocksim_recording::{Kept, MOST_TEXT, limited_text};
use blocksim_studio::Reply;
use serde_json::{Value, json};

use super::values::unquoted;
use crate::commands::params::table::shown;
use crate::mechanism::text::text;

/// A number of a set.
struct Entry {
    place: Range<usize>,
    sheet: String,
    provenance: [String; 3],
}

/// Sheets of all files of a model.
pub struct Sheets(Vec<(String, Vec<Entry>)>);

impl Sheets {
    /// The sheets that `NAME.sheets.ron` beside a set lists, as for `blocksim params export`; else a file is one.
    pub fn of(files: &[SourceFile], root: &Path) -> Sheets {
        Sheets(files.iter().map(|file| of_file(file, root)).collect())
    }

    /// The sheet of a value, and its source, note and tolerance, where its text has them.
    pub fn at(&self, place: &Place) -> (&str, [&str; 3]) {
        let Some((name, entries)) = self.0.get(place.file.0 as usize) else { return ("", [""; 3]) };
        let overlaps =
            |entry: &&Entry| entry.place.start < place.span.end && place.span.start < entry.place.end;
        match entries.iter().find(overlaps) {
            Some(entry) => (&entry.sheet, entry.provenance.each_ref().map(String::as_str)),
            None => (name, [""; 3]),
        }
    }
}

fn of_file(file: &SourceFile, root: &Path) -> (String, Vec<Entry>) {
    let name = file.path.strip_prefix(root).unwrap_or(&file.path).display().to_string();
    // A diagram is no set: its values stand in the sheet of the file.
    let Ok(numbers) = quantities(&file.text) else { return (name, Vec::new()) };
    let arranged = limited_text(&file.path.with_extension("sheets.ron"), MOST_TEXT).ok();
    let arranged = arranged.and_then(|text| Arrangement::read(&text, &numbers).ok());
    let entry = |(n, quantity): (usize, &blocksim_params::Quantity)| Entry {
        place: quantity.place.clone(),
        sheet: arranged.as_ref().and_then(|all| all.sheet_of(n)).unwrap_or(&name).to_owned(),
        provenance: quantity.provenance.clone(),
    };
    let entries = numbers.iter().enumerate().map(entry).collect();
    (name, entries)
}

/// The parameters that a run had, by their names, as they were written; what was set for it counts.
pub fn of_run(run: &Kept) -> Reply {
    let Some(manifest) = &run.manifest else {
        return Reply::refused(format!("nothing is known of the run `{}`", run.name), "choose another run");
    };
    let text = match text(&run.path, manifest) {
        Ok(Some(text)) if text.is_kept => text,
        Ok(_) => {
            let message = format!("the run `{}` has not kept the texts of its model", run.name);
            return Reply::refused(message, "choose a run that was made since");
        }
        Err(message) => return Reply::refused(message, "choose another run"),
    };
    let sources = Sources::new(&*text.reader);
    let (all, _) = targets(&sources, &text.root);
    let is_shown = |target: &&Target| !matches!(target.origin, Origin::Kind(_)) && !target.is_item;
    let mut values: BTreeMap<String, Value> = all
        .iter()
        .filter(is_shown)
        .map(|target| {
            let (value, unit, _) = shown(target);
            let written = if target.written.lines().count() > 1 { "" } else { unquoted(&target.written) };
            let worth = format!("{value} {unit}").trim().to_owned();
            (target.name.clone(), json!({ "written": written, "worth": worth }))
        })
        .collect();
    for set in &text.overrides {
        if let Some((name, value)) = set.split_once('=') {
            let value = unquoted(value.trim());
            values.insert(name.trim().to_owned(), json!({ "written": value, "worth": value, "set": true }));
        }
    }
    Reply::Data(json!({ "run": run.name, "values": values }))
}
