//! Measurements: tables of other programs, with what their columns are: signals of a run, in which units.

use std::path::{Path, PathBuf};

use blocksim_analysis::{Series, lag};
use blocksim_block::in_unit;
use blocksim_diagram::{Sources, parameter};
use blocksim_picture::pretty_unit;
use blocksim_recording::{ALWAYS, Column, read_foreign_file};
use blocksim_report::Overlay;
use blocksim_signal::{Unit, closest};
use serde::Deserialize;

use super::traces::Book;
use crate::disk::Disk;
use crate::failure::Failure;

/// Most signals whose correlation is taken.
const ALIGNED_BY: usize = 6;

/// What the columns of a table are, as a file has it:
///
/// ```text
/// (
///     file: Text("../data/a1.csv"), time: Text("t"), time_unit: Text("ms"), shift: "120 ms",
///     columns: [(column: Text("A1"), signal: Text("angle.actual"), unit: Text("deg"), scale: 1)],
/// )
/// ```
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Assignment {
    /// The table, as seen from the folder of the file.
    pub file: String,
    /// The column with the time; empty for one that is called so.
    #[serde(default)]
    pub time: String,
    /// Its unit; empty for that of the table, or s.
    #[serde(default)]
    pub time_unit: String,
    /// What is added to the times, s.
    #[serde(default, deserialize_with = "in_unit::time")]
    pub shift: f64,
    /// The columns that are used.
    pub columns: Vec<Assigned>,
}

/// A column that is a signal.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Assigned {
    /// Its name in the table.
    pub column: String,
    /// Path of the signal.
    pub signal: String,
    /// Its unit; empty for that of the table, or else for that in which the signal is shown.
    #[serde(default)]
    pub unit: String,
    /// What its numbers are multiplied by.
    #[serde(default = "one")]
    pub scale: f64,
}

fn one() -> f64 {
    1.0
}

/// What is wrong, and where: `file`, `time`, `time_unit`, `shift`, `columns`, or `columns.2.unit` of the third column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trouble {
    /// Where.
    pub field: String,
    /// What.
    pub message: String,
    /// What helps.
    pub help: String,
}

impl Trouble {
    /// Something that is wrong.
    pub fn at(field: impl Into<String>, message: impl Into<String>, help: impl Into<String>) -> Trouble {
        Trouble { field: field.into(), message: message.into(), help: help.into() }
    }
}

/// Measured signals.
#[derive(Debug, Clone, Default)]
pub struct Measurement {
    /// What it is called.
    pub name: String,
    /// Times, s, shifted.
    pub time: Vec<f64>,
    /// Its signals.
    pub signals: Vec<Measured>,
}

/// A measured signal.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Which of the columns of the assignment.
    at: usize,
    /// Path of the signal that it is.
    pub path: String,
    /// Its unit, if one is known.
    pub unit: Option<Unit>,
    /// Its values: in SI where the unit is known.
    pub values: Vec<f64>,
}

impl Assignment {
    /// Reads the measurement; `folder` is that from which the table is seen.
    ///
    /// # Errors
    /// All that is wrong.
    pub fn read(&self, folder: &Path, name: &str) -> Result<Measurement, Vec<Trouble>> {
        let named: Vec<&str> = Some(self.time.as_str()).filter(|name| !name.is_empty()).into_iter().collect();
        let table = read_foreign_file(&folder.join(&self.file), &named).map_err(|error| {
            vec![Trouble::at("file", error.reason(), "export the table again, as CSV in UTF-8")]
        })?;
        let mut troubles = Vec::new();
        if !self.time.is_empty() && table.time_name != self.time {
            let known = table.columns.iter().map(|column| column.name.as_str());
            troubles.push(no_column("time", &self.time, known));
        }
        let unit = if self.time_unit.is_empty() {
            table.time_unit.as_deref().unwrap_or("s")
        } else {
            &self.time_unit
        };
        let second = Unit::parse("s").ok();
        let unit = match parsed(unit) {
            Ok(unit) if second.is_some_and(|second| second.dimension == unit.dimension) => Some(unit),
            Ok(unit) => {
                troubles.push(Trouble::at(
                    "time_unit",
                    format!("{unit} is not a unit of time"),
                    "s, ms and min are",
                ));
                None
            }
            Err(reason) => {
                troubles.push(Trouble::at("time_unit", reason, "s, ms and min are units of time"));
                None
            }
        };
        if !self.shift.is_finite() {
            troubles.push(Trouble::at("shift", "the shift is not a finite time", "0 s shifts nothing"));
        }
        if self.columns.is_empty() {
            troubles.push(Trouble::at(
                "columns",
                "no column is a signal",
                "choose the signal of at least one column",
            ));
        }
        let mut signals: Vec<Measured> = Vec::new();
        for (at, assigned) in self.columns.iter().enumerate() {
            let field = |name: &str| format!("columns.{at}.{name}");
            if signals.iter().any(|known| known.path == assigned.signal) {
                let message = format!("`{}` is another column already", assigned.signal);
                troubles.push(Trouble::at(field("signal"), message, "choose another signal, or none"));
            }
            if !(assigned.scale.is_finite() && assigned.scale != 0.0) {
                let message = format!("{} is not a scale", assigned.scale);
                troubles.push(Trouble::at(
                    field("scale"),
                    message,
                    "a scale is a number other than 0; 1 leaves values as they are",
                ));
            }
            let Some(column) = table.columns.iter().find(|column| column.name == assigned.column) else {
                let known = table.columns.iter().map(|column| column.name.as_str());
                troubles.push(no_column(&field("column"), &assigned.column, known));
                continue;
            };
            let said =
                if assigned.unit.is_empty() { column.unit.as_deref() } else { Some(assigned.unit.as_str()) };
            let unit = match said.map(parsed).transpose() {
                Ok(unit) => unit,
                Err(reason) => {
                    troubles.push(Trouble::at(field("unit"), reason, "write it as `deg`, `N*m` or `m/s^2`"));
                    continue;
                }
            };
            let scaled = column.values.iter().map(|value| assigned.scale * value);
            let values = scaled.map(|value| unit.as_ref().map_or(value, |unit| unit.to_si(value))).collect();
            signals.push(Measured { at, path: assigned.signal.clone(), unit, values });
        }
        match unit {
            Some(unit) if troubles.is_empty() => {
                let time = table.time.iter().map(|&t| unit.to_si(t) + self.shift).collect();
                Ok(Measurement { name: name.to_owned(), time, signals })
            }
            _ => Err(troubles),
        }
    }

    /// As a file has it.
    pub fn text(&self) -> String {
        let word = |name: &str, text: &str| match text {
            "" => String::new(),
            text => format!(" {name}: Text({text:?}),"),
        };
        let columns: String = self
            .columns
            .iter()
            .map(|one| {
                format!(
                    "        (column: Text({:?}), signal: Text({:?}),{} scale: {:?}),\n",
                    one.column,
                    one.signal,
                    word("unit", &one.unit),
                    one.scale
                )
            })
            .collect();
        let time = [word("time", &self.time), word("time_unit", &self.time_unit)].concat();
        format!(
            "// A measurement: which columns of the table are which signals. `blocksim report RUN --overlay` takes this file.\n\
             (\n    file: Text({:?}),\n   {time} shift: \"{:?} s\",\n    columns: [\n{columns}    ],\n)\n",
            self.file, self.shift
        )
    }
}

/// The assignment in a file, and the folder from which it names its table.
///
/// # Errors
/// Why it cannot be read.
pub fn assignment(file: &Path) -> Result<(Assignment, PathBuf), Failure> {
    let disk = Disk::default();
    let read = parameter(&Sources::new(&disk), file, &[], "measurement").map_err(|problems| {
        let reason = problems.first().map_or_else(String::new, |problem| problem.message.clone());
        Failure::unreadable(format!("`{}` is not a measurement: {reason}", file.display()))
            .help("the page Results of `blocksim studio` makes one; see docs/studio.md")
    })?;
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Ok((read, folder.to_owned()))
}

impl Measurement {
    /// Its values as a run shows its signals, and what of it does not fit the run.
    pub fn beside(&self, book: &Book) -> (Overlay, Vec<Trouble>) {
        let mut columns = Vec::new();
        let mut troubles = Vec::new();
        for measured in &self.signals {
            let Some(trace) = book.find(&measured.path).map(|at| &book.traces[at]) else {
                let known = book.traces.iter().map(|trace| trace.path.as_str());
                let help = closest(&measured.path, known).map(|near| format!("did you mean `{near}`?"));
                troubles.push(Trouble::at(
                    format!("columns.{}.signal", measured.at),
                    format!("`{}` has no signal `{}`", book.name, measured.path),
                    help.unwrap_or_else(|| "choose a signal that the run has recorded".to_owned()),
                ));
                continue;
            };
            let values = match &measured.unit {
                Some(unit) if trace.has_unit && !unit.dimension.compatible(trace.unit.dimension) => {
                    troubles.push(Trouble::at(
                        format!("columns.{}.unit", measured.at),
                        format!("the column is in {unit}, and `{}` in {}", measured.path, trace.unit),
                        "give the unit in which it was measured, or choose another signal",
                    ));
                    continue;
                }
                Some(_) if trace.has_unit => measured.values.iter().map(|&x| trace.unit.from_si(x)).collect(),
                _ => measured.values.clone(),
            };
            columns.push((measured.path.clone(), pretty_unit(&trace.unit.to_string()), values));
        }
        (Overlay { name: self.name.clone(), time: self.time.clone(), columns }, troubles)
    }

    /// What has to be added to its times so that it agrees best with a run, s.
    ///
    /// # Errors
    /// That nothing can be compared.
    pub fn lag(&self, book: &Book) -> Result<f64, Failure> {
        let mut columns: Vec<(Column, Column)> = Vec::new();
        for measured in &self.signals {
            let Some(at) = book.find(&measured.path) else { continue };
            let trace = &book.traces[at];
            let here = book.read(at, &ALWAYS)?;
            // What has no unit is in that in which the signal is shown.
            let is_bare = measured.unit.is_none() && trace.has_unit;
            let values =
                measured.values.iter().map(|&x| if is_bare { trace.unit.to_si(x) } else { x }).collect();
            let varies = here.values.iter().any(|value| *value != here.values[0]);
            if varies && columns.len() < ALIGNED_BY {
                columns.push((here, Column { time: self.time.clone(), values }));
            }
        }
        let pairs: Vec<(Series, Series)> = columns
            .iter()
            .map(|(a, b)| (Series::new(&a.time, &a.values), Series::new(&b.time, &b.values)))
            .collect();
        lag(&pairs).ok_or_else(|| {
            Failure::usage(
                "the signals are constant, or have nothing in common, so their shift cannot be found",
            )
            .help("choose the signals first, or give the shift")
        })
    }
}

fn no_column<'a>(field: &str, name: &str, known: impl Iterator<Item = &'a str> + Clone) -> Trouble {
    let help = match closest(name, known.clone()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!(
            "its columns are {}",
            known.take(12).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
        ),
    };
    Trouble::at(field, format!("there is no column `{name}`"), help)
}

/// A unit as other programs write it.
fn parsed(text: &str) -> Result<Unit, String> {
    let plain = text.replace('·', "*").replace('²', "^2").replace('³', "^3");
    Unit::parse(&plain).map_err(|error| format!("the unit is not known: {}", error.message))
}
