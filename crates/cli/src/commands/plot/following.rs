//! How actual values follow their set values, as a table and as data.

use blocksim_analysis::{Metrics, metrics};
use blocksim_results::format::{fixed, seconds, significant};
use blocksim_results::{Align, Column, Table};
use serde_json::{Value, json};

use super::drawn::{Drawn, followed};
use crate::signals::traces::Book;

/// The numbers of one pair of set and actual value.
pub struct Row {
    /// Path of the actual value.
    pub path: String,
    /// What to call it.
    pub name: String,
    /// Unit of its errors.
    pub unit: String,
    /// The run that it is of.
    pub run: String,
    /// The numbers.
    pub metrics: Metrics,
}

/// The numbers of all pairs, those of the first run before those of the others.
pub fn rows(all: &[Drawn], books: &[Book]) -> Vec<Row> {
    let mut rows = Vec::new();
    for (number, book) in books.iter().enumerate() {
        for drawn in all {
            for &(set, actual) in &drawn.group.pairs {
                let own = |n: usize| -> Option<&Column> {
                    if number == 0 {
                        return drawn.columns.get(n);
                    }
                    drawn.others.iter().find(|other| other.0 == number && other.1 == n).map(|other| &other.2)
                };
                let Some(follows) = own(actual) else { continue };
                let wanted = own(set).unwrap_or(&drawn.columns[set]);
                let (wanted, there) = followed(wanted, follows, &drawn.group.unit);
                let Some(metrics) = metrics(&follows.time, Some(&wanted), &there) else { continue };
                rows.push(Row {
                    path: books[0].traces[drawn.group.traces[actual]].path.clone(),
                    name: match drawn.group.pairs.len() {
                        1 if !drawn.group.title.is_empty() => drawn.group.title.clone(),
                        _ => format!("{} {}", drawn.group.title, drawn.group.names[actual]).trim().to_owned(),
                    },
                    unit: drawn.group.unit.clone(),
                    run: book.name.clone(),
                    metrics,
                });
            }
        }
    }
    rows
}

/// A row for each pair.
pub fn table(rows: &[Row], several: bool) -> String {
    let headings = [
        "following",
        "unit",
        "step",
        "rise [s]",
        "overshoot",
        "settling [s]",
        "IAE",
        "ISE",
        "final error",
        "largest error",
        "at [s]",
    ];
    let aligned = |n: usize| if n < 2 { Align::Left } else { Align::Right };
    let columns: Vec<(&str, Align)> =
        headings.iter().enumerate().map(|(n, name)| (*name, aligned(n))).collect();
    let mut table = Table::new(&columns);
    let time = |t: Option<f64>| t.map_or_else(|| "-".to_owned(), |t| seconds(t, 4));
    for Row { name, unit, run, metrics: m, .. } in rows {
        let name = if several { format!("{name}, {run}") } else { name.clone() };
        table.row([
            name,
            unit.clone(),
            significant(m.step, 4),
            time(m.rise),
            m.overshoot.map_or_else(|| "-".to_owned(), |x| format!("{} %", fixed(100.0 * x, 2))),
            time(m.settling),
            significant(m.iae, 4),
            significant(m.ise, 4),
            significant(m.steady_state_error, 4),
            significant(m.max_error, 4),
            seconds(m.max_error_at, 4),
        ]);
    }
    table.render()
}

/// The same as data, in the units shown.
pub fn json(rows: &[Row]) -> Value {
    let row = |row: &Row| {
        let m = &row.metrics;
        json!({
            "run": row.run,
            "signal": row.path,
            "unit": row.unit,
            "begin": m.begin,
            "step": m.step,
            "rise_time": m.rise,
            "overshoot": m.overshoot,
            "settling_time": m.settling,
            "iae": m.iae,
            "ise": m.ise,
            "steady_state_error": m.steady_state_error,
            "largest_error": m.max_error,
            "largest_error_at": m.max_error_at,
        })
    };
    json!({ "v": 1, "type": "metrics", "following": rows.iter().map(row).collect::<Vec<_>>() })
}
