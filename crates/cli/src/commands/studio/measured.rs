//! Measurements of a project: tables of other programs, looked at, assigned to signals, kept as small files.

use std::path::{Path, PathBuf};

use blocksim_recording::{ResultsError, beginning};
use blocksim_studio::Reply;
use serde_json::{Value, json};

use super::desk::run_folder;
use super::motion::is_name;
use super::plugins::relative;
use super::values::refusal;
use crate::args::values::moment;
use crate::disk::{files_of, write_file};
use crate::failure::Failure;
use crate::signals::measured::{Assigned, Assignment, Trouble, assignment};
use crate::signals::traces::Book;

/// Where measurements are kept, in the folder of the project.
const FOLDER: &str = "measured";
/// Endings of tables.
const TABLES: [&str; 4] = ["csv", "tsv", "txt", "CSV"];
/// Tables that are listed.
const MOST: usize = 200;
/// Lines that are shown of a table.
const LINES: usize = 6;

/// The tables of a project, and its measurements.
pub fn list(root: &Path, may_edit: bool) -> Value {
    let tables: Vec<String> = tables(root).iter().map(|file| shown(root, file)).collect();
    let kept: Vec<Value> = kept(root)
        .into_iter()
        .map(|name| {
            let file = path_of(root, &name);
            let read = assignment(&file).map_err(|failure| failure.message());
            let columns = |one: &Assigned| json!({ "column": one.column, "signal": one.signal, "unit": one.unit, "scale": one.scale.to_string() });
            match read {
                Ok((read, folder)) => json!({
                    "name": name, "file": plain(&shown(root, &folder.join(&read.file))), "time": read.time, "time_unit": read.time_unit,
                    "shift": format!("{} s", read.shift), "columns": read.columns.iter().map(columns).collect::<Vec<_>>(),
                }),
                Err(problem) => json!({ "name": name, "problem": problem }),
            }
        })
        .collect();
    json!({ "tables": tables, "kept": kept, "edit": may_edit })
}

/// Names of the measurements that are kept.
fn kept(root: &Path) -> Vec<String> {
    let files = files_of(&root.join(FOLDER), &["ron"]).unwrap_or_default();
    let name = |file: PathBuf| Some(file.file_stem()?.to_str()?.to_owned());
    files.into_iter().filter(|file| file.parent() == Some(&root.join(FOLDER))).filter_map(name).collect()
}

/// The file of a measurement; the name is one of [`kept`] or [`is_name`].
fn path_of(root: &Path, name: &str) -> PathBuf {
    root.join(FOLDER).join(format!("{name}.ron"))
}

/// Files of measurements by their names.
///
/// # Errors
/// The name that none has.
pub fn files(root: &Path, names: &[&str]) -> Result<Vec<PathBuf>, Reply> {
    let known = kept(root);
    let file = |name: &&str| {
        let refused = || Reply::refused(format!("there is no measurement `{name}`"), "look at the list anew");
        known.iter().any(|known| known == name).then(|| path_of(root, name)).ok_or_else(refused)
    };
    names.iter().map(file).collect()
}

fn tables(root: &Path) -> Vec<PathBuf> {
    let mut files = files_of(root, &TABLES).unwrap_or_default();
    files.truncate(MOST);
    files
}

/// A file as seen from the project.
fn shown(root: &Path, file: &Path) -> String {
    file.strip_prefix(root).unwrap_or(file).display().to_string()
}

/// A path without detours: `measured/../data/a.csv` is `data/a.csv`.
fn plain(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match (part, parts.last()) {
            ("..", Some(last)) if *last != ".." => drop(parts.pop()),
            (".", _) => {}
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

/// What somebody has typed, as an assignment seen from the root of the project.
fn typed(body: &Value) -> (Assignment, Vec<Trouble>) {
    let mut troubles = Vec::new();
    let text = |value: &Value| value.as_str().unwrap_or_default().trim().to_owned();
    let shift = text(&body["shift"]).replace(',', ".");
    let shift = match if shift.is_empty() { Ok(0.0) } else { moment(&shift) } {
        Ok(shift) => shift,
        Err(reason) => {
            troubles.push(Trouble::at("shift", reason, "write it as `0.12 s` or `-120 ms`"));
            0.0
        }
    };
    let mut columns = Vec::new();
    for column in body["columns"].as_array().into_iter().flatten() {
        let signal = text(&column["signal"]);
        if signal.is_empty() {
            continue;
        }
        let scale = text(&column["scale"]).replace(',', ".").replace('−', "-");
        let scale = match if scale.is_empty() { Ok(1.0) } else { scale.parse::<f64>() } {
            Ok(scale) => scale,
            Err(_) => {
                let said = format!("{} is not a number", text(&column["scale"]));
                troubles.push(Trouble::at(
                    format!("columns.{}.scale", columns.len()),
                    said,
                    "1 leaves values as they are",
                ));
                1.0
            }
        };
        columns.push(Assigned {
            column: text(&column["column"]),
            signal,
            unit: text(&column["unit"]),
            scale,
        });
    }
    let [file, time, time_unit] = ["file", "time", "time_unit"].map(|name| text(&body[name]));
    (Assignment { file, time, time_unit, shift, columns }, troubles)
}

/// Looks at a table and at what its columns are to be. Problems name the columns as they were given, those without a signal left out.
pub fn look(root: &Path, body: &Value) -> Reply {
    let (mut wanted, mut troubles) = typed(body);
    let Some(file) = tables(root).into_iter().find(|file| shown(root, file) == wanted.file) else {
        return Reply::refused(
            format!("the project has no table `{}`", wanted.file),
            "choose one of the list",
        );
    };
    let begin = match beginning(&file, LINES) {
        Ok(begin) => begin,
        Err(error) => return Reply::Data(json!({ "problems": problems(&[of_table(&error)]) })),
    };
    let headings: Vec<Value> =
        begin.headings.iter().map(|(name, unit)| json!({ "name": name, "unit": unit })).collect();
    if wanted.time.is_empty() {
        let likely = begin.headings.get(begin.time.unwrap_or(0));
        wanted.time = likely.map(|heading| heading.0.clone()).unwrap_or_default();
    }
    let book = match body["run"].as_str().filter(|name| !name.is_empty()).map(run_folder) {
        None => None,
        Some(None) => return Reply::Missing,
        Some(Some(folder)) => match Book::open(&folder, &[]) {
            Ok(book) => Some(book),
            Err(failure) => return refusal(failure),
        },
    };
    let signals: Vec<Value> = book
        .iter()
        .flat_map(|book| &book.traces)
        .map(|trace| json!({ "path": trace.path, "unit": trace.unit.to_string() }))
        .collect();
    let mut data = json!({
        "delimiter": begin.delimiter.to_string(), "decimal": begin.decimal.map(String::from), "headings": headings, "lines": begin.lines,
        "time": wanted.time, "signals": signals,
    });
    // From here on it counts whether all of the table can be read.
    let read = wanted.read(root, "");
    match &read {
        Err(found) => troubles.extend(found.iter().cloned()),
        Ok(measurement) => {
            data["rows"] = measurement.time.len().into();
            data["span"] = json!([measurement.time.first(), measurement.time.last()]);
            if let Some(book) = &book {
                troubles.extend(measurement.beside(book).1);
            }
        }
    }
    if body["align"] == true {
        let aligned = match (&read, &book) {
            (Ok(measurement), Some(book)) => measurement.lag(book).map_err(|failure| failure.message()),
            (_, None) => Err("there is no run to align with; choose one".to_owned()),
            (Err(_), _) => Err("correct what is wrong first, then align".to_owned()),
        };
        match aligned {
            // As near as a table can be read: a microsecond.
            Ok(more) => data["shift"] = format!("{} s", ((wanted.shift + more) * 1e6).round() / 1e6).into(),
            Err(reason) => troubles.push(Trouble::at("shift", reason, "or type the shift")),
        }
    }
    data["problems"] = problems(&troubles);
    Reply::Data(data)
}

fn of_table(error: &ResultsError) -> Trouble {
    Trouble::at("file", error.reason(), "export the table again, as CSV in UTF-8")
}

fn problems(troubles: &[Trouble]) -> Value {
    troubles
        .iter()
        .map(|one| json!({ "field": one.field, "message": one.message, "help": one.help }))
        .collect()
}

/// Keeps a measurement as a file of the project.
pub fn keep(root: &Path, body: &Value) -> Reply {
    let Some(name) = body["name"].as_str().map(str::trim).filter(|name| is_name(name)) else {
        return Reply::refused("the name of a measurement is a word", "letters, digits, - and _ make one");
    };
    let (mut wanted, mut troubles) = typed(body);
    if !tables(root).iter().any(|file| shown(root, file) == wanted.file) {
        return Reply::refused(
            format!("the project has no table `{}`", wanted.file),
            "choose one of the list",
        );
    }
    troubles.extend(wanted.read(root, name).err().into_iter().flatten());
    if let Some(first) = troubles.first() {
        return Reply::Refused(
            json!({ "message": first.message, "help": first.help, "problems": problems(&troubles) }),
        );
    }
    let folder = root.join(FOLDER);
    let file = path_of(root, name);
    if file.exists() && body["replace"] != true {
        return Reply::refused(
            format!("there is a measurement `{name}` already"),
            "choose another name, or tick `replace`",
        );
    }
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    wanted.file = relative(&absolute(&folder), &absolute(&root.join(&wanted.file)));
    let written = std::fs::create_dir_all(&folder)
        .map_err(|error| Failure::unwritable(format!("cannot make `{}`: {error}", folder.display())))
        .and_then(|()| {
            let text = wanted.text();
            let text = blocksim_syntax::format(&text).unwrap_or(text);
            write_file(&file, text.as_bytes(), body["replace"] == true)
        });
    match written {
        Ok(()) => Reply::Data(json!({ "file": shown(root, &file), "name": name })),
        Err(failure) => refusal(failure),
    }
}

/// Takes a table from elsewhere into the project.
pub fn take(root: &Path, body: &Value) -> Reply {
    let (Some(name), Some(text)) = (body["name"].as_str(), body["text"].as_str()) else {
        return Reply::refused("a table has a name and a text", "");
    };
    // What the file was called elsewhere, as far as that makes a name here.
    let stem = Path::new(name).file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    let stem: String = stem
        .chars()
        .map(|sign| if sign.is_alphanumeric() || "-_".contains(sign) { sign } else { '_' })
        .take(60)
        .collect();
    if stem.is_empty() {
        return Reply::refused(format!("`{name}` is not the name of a file"), "rename it");
    }
    let folder = root.join(FOLDER);
    let file = folder.join(format!("{stem}.csv"));
    let written = std::fs::create_dir_all(&folder)
        .map_err(|error| Failure::unwritable(format!("cannot make `{}`: {error}", folder.display())))
        .and_then(|()| write_file(&file, text.as_bytes(), false));
    match written {
        Ok(()) => Reply::Data(json!({ "file": shown(root, &file) })),
        // The same file again is no new one.
        Err(_) if std::fs::read(&file).is_ok_and(|there| there == text.as_bytes()) => {
            Reply::Data(json!({ "file": shown(root, &file) }))
        }
        Err(failure) => refusal(failure),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_shown_without_detours() {
        assert_eq!(plain("measured/../data/a.csv"), "data/a.csv");
        assert_eq!(plain("measured/a.csv"), "measured/a.csv");
        assert_eq!(plain("measured/../../a.csv"), "../a.csv");
    }
}
