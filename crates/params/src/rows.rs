//! The rows of a sheet that is written.

use std::collections::BTreeMap;

use crate::layout::{ITEMS, axis, sheet_of};
use crate::quantity::{Content, Quantity};

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
