//! What changed in a workbook and what in its set since the export.

use std::collections::BTreeSet;

use blocksim_diagram::fingerprint;
use blocksim_signal::{Unit, closest};

use crate::Fault;
use crate::cell::{Address, Spot};
use crate::numeral::{rounded, same};
use crate::quantity::{Content, Quantity};
use crate::table::{Reading, Tables, Value};

/// A number that differs; all numbers in the unit of the set.
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

/// A number that was changed in the workbook and, to something else, in the set.
#[derive(Debug, Clone, PartialEq)]
pub struct Conflict {
    /// Path in the set.
    pub path: String,
    /// Where it stands in the workbook.
    pub cell: Spot,
    /// When it was exported.
    pub exported: f64,
    /// In the set.
    pub set: f64,
    /// In the workbook.
    pub sheet: f64,
    /// As written in the set.
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
    pub since: Vec<Change>,
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
        match &quantity.content {
            Content::Number { value, unit, .. } => number(tables, quantity, *value, unit, &mut found),
            Content::Expression(written) => expression(tables, quantity, written, &mut found),
        }
    }
    unknown(tables, quantities, &mut found);
    found
}

fn fault(reading: &Reading, cell: Address, message: String, help: impl Into<String>) -> Fault {
    Fault { sheet: reading.spot.sheet.clone(), cell: Some(cell), message, help: help.into() }
}

fn number(tables: &Tables, quantity: &Quantity, set: f64, unit: &str, found: &mut Comparison) {
    let path = &quantity.path;
    let remembered = tables.remembered.as_ref().map(|remembered| remembered.get(path));
    let added =
        || Change { path: path.clone(), cell: None, old: None, new: Some(set), unit: unit.to_owned() };
    let Some(reading) = tables.readings.get(path) else {
        let home = tables.homes.get(path);
        let faulty = home.map_or(!tables.faults.is_empty(), |home| {
            tables.missing.contains(home) || tables.faults.iter().any(|fault| fault.sheet == *home)
        });
        match remembered {
            Some(None) => found.since.push(added()),
            // A faulty cell, row or sheet is told already.
            _ if faulty => {}
            _ => found.faults.push(Fault {
                sheet: home.cloned().unwrap_or_else(|| "the workbook".to_owned()),
                cell: None,
                message: format!("the row or the column of `{path}` is missing"),
                help: "put it back with its key and its heading, or export the set anew".to_owned(),
            }),
        }
        return;
    };
    let sheet = match &reading.value {
        Some(Value::Number(number)) => *number,
        Some(Value::Text(_, fault)) => return found.faults.push(fault.clone()),
        None if remembered == Some(None) => return found.since.push(added()),
        None => {
            let message = format!("the cell of `{path}` is empty");
            let help = format!("write the number; the set has {set}{}", after(unit));
            return found.faults.push(fault(reading, reading.spot.cell, message, help));
        }
    };
    let sheet = match converted(sheet, &reading.unit, unit) {
        Ok(number) => number,
        Err((message, help)) => {
            // One unit stands for a whole row.
            let wrong = fault(reading, reading.unit_cell, message, help);
            if !found.faults.contains(&wrong) {
                found.faults.push(wrong);
            }
            return;
        }
    };
    let base = match remembered.flatten() {
        Some((Some(base), base_unit)) => converted(*base, base_unit, unit).unwrap_or(set),
        _ => set,
    };
    let cell = reading.spot.clone();
    let change = |old, new| Change {
        path: path.clone(),
        cell: Some(cell.clone()),
        old: Some(old),
        new: Some(new),
        unit: unit.to_owned(),
    };
    match (same(sheet, base), same(set, base)) {
        (true, true) => {}
        (false, true) => found.edits.push(change(set, sheet)),
        (true, false) => found.since.push(change(base, set)),
        (false, false) if same(sheet, set) => {}
        (false, false) => found.conflicts.push(Conflict {
            path: path.clone(),
            cell,
            exported: base,
            set,
            sheet,
            unit: unit.to_owned(),
        }),
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

/// An expression stays as it is.
fn expression(tables: &Tables, quantity: &Quantity, written: &str, found: &mut Comparison) {
    let Some(reading) = tables.readings.get(&quantity.path) else { return };
    let unchanged = match &reading.value {
        Some(Value::Text(text, _)) => text == written.trim(),
        _ => false,
    };
    // What was a number when it was exported is not a change in the sheet.
    let remembered = tables.remembered.as_ref().and_then(|remembered| remembered.get(&quantity.path));
    let was_number = remembered.is_some_and(|(number, _)| number.is_some());
    if !unchanged && !was_number {
        let message = format!("`{}` is computed in the set: `{written}`", quantity.path);
        found.faults.push(fault(
            reading,
            reading.spot.cell,
            message,
            format!("write {written} here, and change it in the set"),
        ));
    }
}

/// Values for which the set has no place.
fn unknown(tables: &Tables, quantities: &[Quantity], found: &mut Comparison) {
    let known: BTreeSet<&str> = quantities.iter().map(|quantity| quantity.path.as_str()).collect();
    for (path, reading) in tables.readings.iter().filter(|(path, _)| !known.contains(path.as_str())) {
        let Some(value) = &reading.value else { continue };
        let remembered = tables.remembered.as_ref().and_then(|remembered| remembered.get(path));
        if let (Some((Some(base), unit)), Value::Number(number)) = (remembered, value)
            && converted(*number, &reading.unit, unit).is_ok_and(|number| same(number, *base))
        {
            let cell = Some(reading.spot.clone());
            found.since.push(Change {
                path: path.clone(),
                cell,
                old: Some(*base),
                new: None,
                unit: unit.clone(),
            });
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
