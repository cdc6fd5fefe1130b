//! What changed in a workbook and what in its set since the export.

use std::collections::BTreeSet;

use blocksim_diagram::fingerprint;
use blocksim_signal::{Unit, closest};

use crate::Fault;
use crate::cell::{Address, Spot};
use crate::difference::{Difference, equal, shown};
use crate::numeral::{self, rounded, same};
use crate::quantity::{Content, Quantity};
use crate::table::{Reading, Tables, Value};

/// A number that was changed in the workbook; all numbers in the unit of the set.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// Path in the set.
    pub path: String,
    /// Where it stands in the workbook.
    pub cell: Option<Spot>,
    /// Before.
    pub old: Option<f64>,
    /// Now.
    pub new: Option<f64>,
    /// As written in the set.
    pub unit: String,
}

/// What was changed in the set alone since the export.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Since {
    /// Where it stands in the workbook, if it has a cell there.
    pub cell: Option<Spot>,
    /// At the export, and in the set as it is now.
    pub difference: Difference,
}

/// What was changed in the workbook and, to something else, in the set; each side as written, with its unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Conflict {
    /// Path in the set.
    pub path: String,
    /// Where it stands in the workbook.
    pub cell: Spot,
    /// When it was exported; nothing if the set did not have it then.
    pub exported: Option<String>,
    /// In the set.
    pub set: String,
    /// In the workbook.
    pub sheet: String,
    /// Unit of all; empty where they differ in it.
    pub unit: String,
}

/// What is known of the age of a workbook.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Known {
    /// It was exported from this text.
    Current,
    /// The text was changed since.
    Stale,
    /// It does not remember.
    #[default]
    Nothing,
}

/// A workbook beside a set.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Comparison {
    /// Changed in the workbook: what an import takes over.
    pub edits: Vec<Change>,
    /// Changed in the set since the export: what an import leaves alone.
    pub since: Vec<Since>,
    /// Changed in both.
    pub conflicts: Vec<Conflict>,
    /// What is wrong in the workbook.
    pub faults: Vec<Fault>,
    /// Whether the set is still the one that was exported.
    pub known: Known,
}

/// Compares a workbook with the set or model of these texts and quantities.
pub fn compare(tables: &Tables, texts: &[&str], quantities: &[Quantity]) -> Comparison {
    let mut found = Comparison { faults: tables.faults.clone(), ..Comparison::default() };
    found.known = match &tables.fingerprint {
        _ if tables.remembered.is_none() => Known::Nothing,
        Some(known) if *known == fingerprint(texts.concat().as_bytes()) => Known::Current,
        _ => Known::Stale,
    };
    for quantity in quantities {
        beside(tables, quantity, &mut found);
    }
    unknown(tables, quantities, &mut found);
    found
}

fn fault(reading: &Reading, cell: Address, message: String, help: impl Into<String>) -> Fault {
    Fault { sheet: reading.spot.sheet.clone(), cell: Some(cell), message, help: help.into() }
}

/// What was remembered of a quantity.
fn content((number, text): &(Option<f64>, String)) -> Content {
    match number {
        Some(value) => Content::Number { value: *value, unit: text.clone(), numeral: 0..0 },
        None => Content::Expression(text.clone()),
    }
}

impl Reading {
    /// Whether the cell has what this content is exported as, be it in another unit.
    fn holds(&self, content: &Content) -> bool {
        match (content, &self.value) {
            (Content::Expression(written), Some(Value::Text(text, _))) => text.trim() == written.trim(),
            // With a decimal comma, `1,5` is a text in a set and a number in a cell.
            (Content::Expression(written), Some(Value::Number(number))) => {
                numeral::read(written).is_ok_and(|written| same(written, *number))
            }
            // Nothing is written for an empty text.
            (Content::Expression(written), None) => written.trim().is_empty(),
            (Content::Number { value, unit, .. }, Some(Value::Number(number))) => {
                converted(*number, &self.unit, unit).is_ok_and(|number| same(number, *value))
            }
            (Content::Number { .. }, _) => false,
        }
    }

    /// Whether the row has a unit; expressions are exported without one.
    fn has_unit(&self) -> bool {
        !matches!(self.unit.as_str(), "" | "1")
    }

    /// Whether the row has all that this content is exported as.
    fn is_untouched(&self, content: &Content) -> bool {
        self.holds(content) && (matches!(content, Content::Number { .. }) || !self.has_unit())
    }
}

/// A quantity of the set beside its cell: what changed on one side alone is taken over or stays, what changed on both must agree.
fn beside(tables: &Tables, quantity: &Quantity, found: &mut Comparison) {
    let set = &quantity.content;
    // Without a memory the set is what was exported.
    let base = match &tables.remembered {
        Some(remembered) => remembered.get(&quantity.path).map(content),
        None => Some(set.clone()),
    };
    let is_kept = base.as_ref().is_some_and(|base| equal(base, set));
    let Some(reading) = tables.readings.get(&quantity.path) else {
        return match base {
            Some(_) => missing(tables, quantity, found),
            None => found.since.push(since(&quantity.path, None, None, Some(set))),
        };
    };
    let untouched = base.as_ref().filter(|base| reading.holds(base));
    match (untouched, &reading.value) {
        (Some(_), _) if is_kept => {}
        (Some(base), _) => {
            found.since.push(since(&quantity.path, Some(reading), Some(base), Some(set)));
        }
        _ if reading.holds(set) => {}
        (None, None) if base.is_none() => {
            found.since.push(since(&quantity.path, None, None, Some(set)));
        }
        _ => changed(reading, quantity, base.as_ref(), is_kept, found),
    }
    let is_expression = untouched.is_some() || matches!(reading.value, Some(Value::Text(..)));
    let was_expression = matches!(base, Some(Content::Expression(_))) && tables.remembered.is_some();
    if is_expression && was_expression && reading.has_unit() {
        no_unit(reading, &quantity.path, found);
    }
}

/// What was changed in the workbook, to what the set does not have.
fn changed(
    reading: &Reading,
    quantity: &Quantity,
    base: Option<&Content>,
    is_kept: bool,
    found: &mut Comparison,
) {
    let path = &quantity.path;
    match (&quantity.content, &reading.value) {
        (Content::Expression(written), _) if is_kept => {
            let message = format!("`{path}` is computed in the set: `{written}`");
            let help = format!("write {written} here, and change it in the set");
            found.faults.push(fault(reading, reading.spot.cell, message, help));
        }
        (set, None) => {
            let message = format!("the cell of `{path}` is empty");
            let help = match set {
                Content::Number { value, unit, .. } => {
                    format!("write the number; the set has {value}{}", after(unit))
                }
                Content::Expression(written) => format!("write {written}, which the set has"),
            };
            found.faults.push(fault(reading, reading.spot.cell, message, help));
        }
        (Content::Number { .. }, Some(Value::Text(_, fault))) => found.faults.push(fault.clone()),
        (Content::Number { value, unit, .. }, Some(Value::Number(sheet))) => {
            match converted(*sheet, &reading.unit, unit) {
                Ok(new) if is_kept => found.edits.push(Change {
                    path: path.clone(),
                    cell: Some(reading.spot.clone()),
                    old: Some(*value),
                    new: Some(new),
                    unit: unit.clone(),
                }),
                Err((message, help)) if is_kept || !fits(reading, base) => {
                    // One unit stands for a whole row.
                    let wrong = fault(reading, reading.unit_cell, message, help);
                    if !found.faults.contains(&wrong) {
                        found.faults.push(wrong);
                    }
                }
                _ => found.conflicts.extend(conflict(reading, quantity, base)),
            }
        }
        (Content::Expression(_), Some(_)) => found.conflicts.extend(conflict(reading, quantity, base)),
    }
}

/// Whether the unit of a row is one of what was exported.
fn fits(reading: &Reading, base: Option<&Content>) -> bool {
    matches!(base, Some(Content::Number { unit, .. }) if converted(1.0, &reading.unit, unit).is_ok())
}

fn conflict(reading: &Reading, quantity: &Quantity, base: Option<&Content>) -> Option<Conflict> {
    let sheet = reading.value.as_ref()?.content(&reading.unit);
    let set = &quantity.content;
    let (exported, sheet) = (base.map(|base| like(base, set)), like(&sheet, set));
    let ([exported, set, sheet], unit) = shown([exported.as_ref(), Some(set), Some(&sheet)]);
    Some(Conflict {
        path: quantity.path.clone(),
        cell: reading.spot.clone(),
        exported,
        set: set?,
        sheet: sheet?,
        unit,
    })
}

fn since(path: &str, reading: Option<&Reading>, old: Option<&Content>, new: Option<&Content>) -> Since {
    let old = old.map(|old| new.map_or(old.clone(), |new| like(old, new)));
    Since {
        cell: reading.map(|reading| reading.spot.clone()),
        difference: Difference::of(path, old.as_ref(), new),
    }
}

/// A number in the unit of another one, where it has such a unit.
fn like(content: &Content, other: &Content) -> Content {
    match (content, other) {
        (Content::Number { value, unit: own, .. }, Content::Number { unit, .. }) => {
            match converted(*value, own, unit) {
                Ok(value) => Content::Number { value, unit: unit.clone(), numeral: 0..0 },
                Err(_) => content.clone(),
            }
        }
        _ => content.clone(),
    }
}

/// What was exported has no cell any more.
fn missing(tables: &Tables, quantity: &Quantity, found: &mut Comparison) {
    let path = &quantity.path;
    let home = tables.homes.get(path);
    // A faulty cell, row or sheet is told already.
    let is_faulty = home.map_or(!tables.faults.is_empty(), |home| {
        tables.missing.contains(home) || tables.faults.iter().any(|fault| fault.sheet == *home)
    });
    // Whoever makes a workbook by hand need not write what it cannot change.
    let is_needed = tables.remembered.is_some() || matches!(quantity.content, Content::Number { .. });
    if is_needed && !is_faulty {
        found.faults.push(Fault {
            sheet: home.cloned().unwrap_or_else(|| "the workbook".to_owned()),
            cell: None,
            message: format!("the row or the column of `{path}` is missing"),
            help: "put it back with its key and its heading, or export the set anew".to_owned(),
        });
    }
}

/// A unit beside an expression, which has its own.
fn no_unit(reading: &Reading, path: &str, found: &mut Comparison) {
    let message = format!("the unit `{}` does not count for `{path}`, which is an expression", reading.unit);
    let help = "empty the cell, and change the expression in the set".to_owned();
    let wrong = fault(reading, reading.unit_cell, message, help);
    // One unit stands for a whole row.
    if !found.faults.iter().any(|known| known.sheet == wrong.sheet && known.cell == wrong.cell) {
        found.faults.push(wrong);
    }
}

/// ` kg`, or nothing.
fn after(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// A number in another unit of the same kind, without the rounding of the way.
pub(crate) fn converted(number: f64, from: &str, to: &str) -> Result<f64, (String, String)> {
    let plain = |unit: &str| if unit.is_empty() { "1".to_owned() } else { unit.to_owned() };
    let (from, to) = (plain(from), plain(to));
    if from == to {
        return Ok(number);
    }
    let read = |text: &str| {
        Unit::parse(text).map_err(|error| {
            (error.message, error.help.unwrap_or_else(|| format!("write a unit such as {to}")))
        })
    };
    let (from, to) = (read(&from)?, read(&to)?);
    if from.dimension != to.dimension {
        let message = format!("the unit `{from}` does not fit; the set has `{to}`");
        return Err((message, format!("write {to}, or a unit of the same kind")));
    }
    Ok(rounded(to.from_si(from.to_si(number))))
}

/// Values for which the set has no place.
fn unknown(tables: &Tables, quantities: &[Quantity], found: &mut Comparison) {
    let known: BTreeSet<&str> = quantities.iter().map(|quantity| quantity.path.as_str()).collect();
    for (path, reading) in tables.readings.iter().filter(|(path, _)| !known.contains(path.as_str())) {
        if reading.value.is_none() {
            continue;
        }
        let remembered = tables.remembered.as_ref().and_then(|remembered| remembered.get(path));
        if let Some(base) = remembered.map(content).filter(|base| reading.is_untouched(base)) {
            found.since.push(since(path, Some(reading), Some(&base), None));
            continue;
        }
        let help = match closest(path, known.iter().copied()) {
            Some(near) => {
                format!("did you mean `{near}`? Otherwise add it to the set first, or delete the cell")
            }
            None => "add it to the set first, or delete the cell".to_owned(),
        };
        found.faults.push(fault(reading, reading.spot.cell, format!("the set has no `{path}`"), help));
    }
}
