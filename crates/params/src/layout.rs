//! Which quantity stands in which sheet, row and column.
//!
//! The nine sheets and their names are those of the parameter workbook in O. Preuss, "Simulation Model for a Six Axis
//! Articulated Arm Industrial Robot", 2019, table 6.11. There axes are rows; here a quantity is a row and axes are
//! columns, which leaves room for a unit and sources. Bodies and frames, which that workbook leaves to the CAD model,
//! stand in the first sheet; other drives and the controllers beside the drives they belong to.

use std::collections::BTreeMap;

use crate::quantity::{Content, Quantity};

/// The nine sheets.
pub const SHEETS: [&str; 9] = [
    "(1) General Robot Information",
    "(2) Axis Range Limits",
    "(3) Axis Speed Limits",
    "(4) Axis Acceleration Limits",
    "(5) TCP Limits",
    "(6) Joint Parameters",
    "(7) Motor Parameters",
    "(8) Transmission Parameters",
    "(9) Motor Drivers Parameters",
];

/// The hidden sheet that remembers what was exported.
pub const MEMORY: &str = "blocksim";

/// Number of the sheet, from 0, in which a quantity stands.
pub fn sheet_of(path: &str) -> usize {
    let Some((_, rest)) = axis(path) else {
        return if path.starts_with("tcp_limits.") { 4 } else { 0 };
    };
    let group = rest.split(['.', '[']).next().unwrap_or_default();
    match (group, rest) {
        ("limits", "limits.speed") => 2,
        ("limits", "limits.acceleration") => 3,
        ("limits", _) => 1,
        ("motor" | "asm" | "dc" | "torque", _) => 6,
        ("gear", _) => 7,
        ("driver" | "control", _) => 8,
        _ => 5,
    }
}

/// Takes `axis3.limits.lower` apart; such a quantity has a column for each axis.
pub(crate) fn axis(path: &str) -> Option<(usize, &str)> {
    let (number, rest) = path.strip_prefix("axis")?.split_once('.')?;
    let canonical = number.bytes().all(|byte| byte.is_ascii_digit()) && !number.starts_with('0');
    Some((number.parse().ok().filter(|n| canonical && (1..=MOST_AXES).contains(n))?, rest))
}

/// Most columns for axes.
const MOST_AXES: usize = 64;

/// Longest list with a column for each item; those of longer ones have rows.
const ITEMS: [&str; 3] = ["Value / x", "y", "z"];

/// A row: its key, the unit that all its quantities have, and a quantity for some columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// `axis*.limits.lower`, `tool.tcp[*]`, `general.mass`.
    pub key: String,
    pub unit: String,
    /// Quantities by column of values, from 0.
    pub quantities: BTreeMap<usize, usize>,
}

/// Rows of a sheet and headings of its columns of values.
pub(crate) struct Layout {
    pub headings: Vec<String>,
    pub rows: Vec<Row>,
}

/// Lays out one of the sheets.
pub(crate) fn layout(sheet: usize, quantities: &[Quantity]) -> Layout {
    let here = || quantities.iter().enumerate().filter(|(_, quantity)| sheet_of(&quantity.path) == sheet);
    let mut units: BTreeMap<String, Vec<&str>> = BTreeMap::new();
    let mut longest: BTreeMap<String, usize> = BTreeMap::new();
    for (_, quantity) in here() {
        let (key, column) = shared_key(&quantity.path);
        let units = units.entry(key.clone()).or_default();
        if !units.contains(&unit(quantity)) {
            units.push(unit(quantity));
        }
        let longest = longest.entry(key).or_default();
        *longest = (*longest).max(column);
    }
    let (mut rows, mut at): (Vec<Row>, BTreeMap<String, usize>) = (Vec::new(), BTreeMap::new());
    for (n, quantity) in here() {
        let (mut key, mut column) = shared_key(&quantity.path);
        // Quantities share a row if they have the same unit and there is a column for each.
        let many =
            !key.starts_with("axis*.") && longest.get(&key).is_some_and(|&longest| longest >= ITEMS.len());
        if many || units.get(&key).is_some_and(|units| units.len() > 1) {
            column = axis(&quantity.path).map_or(0, |(axis, _)| axis - 1);
            key.clone_from(&quantity.path);
        }
        let row = *at.entry(key.clone()).or_insert_with(|| {
            rows.push(Row { key, unit: unit(quantity).to_owned(), quantities: BTreeMap::new() });
            rows.len() - 1
        });
        rows[row].quantities.insert(column, n);
    }
    let columns =
        rows.iter().filter_map(|row| row.quantities.keys().next_back()).max().map_or(1, |last| last + 1);
    let axes = (1..4).contains(&sheet) || sheet > 4;
    let headings = match (axes, columns) {
        (true, n) => (1..=n).map(|n| format!("Axis {n}")).collect(),
        (false, 1) => vec!["Value".to_owned()],
        (false, n) => ITEMS[..n.min(3)].iter().map(ToString::to_string).collect(),
    };
    Layout { headings, rows }
}

fn unit(quantity: &Quantity) -> &str {
    match &quantity.content {
        Content::Number { unit, .. } => unit,
        Content::Expression(_) => "",
    }
}

/// The key of a row and the column in it.
fn shared_key(path: &str) -> (String, usize) {
    if let Some((axis, rest)) = axis(path) {
        return (format!("axis*.{rest}"), axis - 1);
    }
    let item = path.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
    match item.and_then(|(list, n)| Some((list, n.parse::<usize>().ok()?))) {
        Some((list, n)) => (format!("{list}[*]"), n),
        None => (path.to_owned(), 0),
    }
}

/// The path of a cell: the reverse of the above, from the texts of a sheet alone. `None` where the row has no such
/// column.
pub(crate) fn path_of(key: &str, heading: &str) -> Option<String> {
    let heading = heading.trim();
    let number = heading.strip_prefix("Axis ").and_then(|n| n.trim().parse::<usize>().ok());
    if let Some(rest) = key.strip_prefix("axis*.") {
        return number.map(|axis| format!("axis{axis}.{rest}"));
    }
    if let Some((axis, _)) = axis(key) {
        return (number == Some(axis)).then(|| key.to_owned());
    }
    let item = ITEMS.iter().position(|item| *item == heading).or((heading == "Value").then_some(0))?;
    match key.strip_suffix("[*]") {
        Some(list) => Some(format!("{list}[{item}]")),
        None => (item == 0).then(|| key.to_owned()),
    }
}

/// Whether a heading is that of a column of values.
pub(crate) fn is_value_heading(heading: &str) -> bool {
    let heading = heading.trim();
    heading == "Value"
        || ITEMS.contains(&heading)
        || heading.strip_prefix("Axis ").is_some_and(|n| n.trim().parse::<usize>().is_ok())
}
