//! The rows of a sheet that is written.

use std::collections::{BTreeMap, BTreeSet};

use crate::arrangement::Arrangement;
use crate::key::{Column, ITEMS, numbered};
use crate::quantity::{Content, Quantity};

/// A row: its key, the unit that all its quantities have, and a quantity for some columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// `axis*.limits.lower`, `tool.tcp[*]`, `general.mass`.
    pub key: String,
    pub unit: String,
    /// Quantities by column of values.
    pub quantities: BTreeMap<Column, usize>,
}

/// Rows of a sheet and its columns of values.
pub(crate) struct Layout {
    pub columns: Vec<Column>,
    pub rows: Vec<Row>,
}

impl Layout {
    /// The headings of the columns of values.
    pub fn headings(&self) -> Vec<String> {
        let only_values = !self.columns.iter().any(|column| matches!(column, Column::Item(n) if *n > 0));
        self.columns.iter().map(|column| column.heading(only_values)).collect()
    }
}

/// Lays out one of the sheets.
pub(crate) fn layout(sheet: usize, quantities: &[Quantity], arrangement: &Arrangement) -> Layout {
    let here = || quantities.iter().enumerate().filter(|(n, _)| arrangement.of.get(*n) == Some(&sheet));
    let (mut units, mut is_long) = (BTreeMap::<String, Vec<&str>>::new(), BTreeMap::<String, bool>::new());
    for (_, quantity) in here() {
        let (key, column) = shared_key(&quantity.path, arrangement);
        let units = units.entry(key.clone()).or_default();
        if !units.contains(&unit(quantity)) {
            units.push(unit(quantity));
        }
        *is_long.entry(key).or_default() |= matches!(column, Column::Item(n) if n >= ITEMS.len());
    }
    let (mut rows, mut at): (Vec<Row>, BTreeMap<String, usize>) = (Vec::new(), BTreeMap::new());
    for (n, quantity) in here() {
        let (mut key, mut column) = shared_key(&quantity.path, arrangement);
        // Quantities share a row if they have the same unit and there is a column for each.
        let is_mixed = units.get(&key).is_some_and(|units| units.len() > 1);
        if is_mixed || is_long.get(&key) == Some(&true) {
            if let Column::Item(item) = &mut column {
                *item = 0;
            }
            key.clone_from(&quantity.path);
        }
        let row = *at.entry(key.clone()).or_insert_with(|| {
            rows.push(Row { key, unit: unit(quantity).to_owned(), quantities: BTreeMap::new() });
            rows.len() - 1
        });
        rows[row].quantities.insert(column, n);
    }
    let columns: BTreeSet<Column> = rows.iter().flat_map(|row| row.quantities.keys().cloned()).collect();
    Layout { columns: columns.into_iter().collect(), rows }
}

fn unit(quantity: &Quantity) -> &str {
    match &quantity.content {
        Content::Number { unit, .. } => unit,
        Content::Expression(_) => "",
    }
}

/// The key of a row and the column in it.
fn shared_key(path: &str, arrangement: &Arrangement) -> (String, Column) {
    if let Some((word, number, rest)) =
        numbered(path).filter(|(word, ..)| arrangement.columns.contains(*word))
    {
        return (format!("{word}*.{rest}"), Column::Numbered(word.to_owned(), number));
    }
    let item = path.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
    match item.and_then(|(list, n)| Some((list, n.parse::<usize>().ok()?))) {
        Some((list, n)) => (format!("{list}[*]"), Column::Item(n)),
        None => (path.to_owned(), Column::Item(0)),
    }
}
