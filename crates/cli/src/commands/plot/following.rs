//! How actual values follow their set values, as a table and as data.

use std::ops::RangeInclusive;

use blocksim_analysis::{Metrics, metrics};
use blocksim_results::format::{fixed, seconds, significant};
use blocksim_results::{Align, Column, Table};
use serde_json::{Value, json};

use super::drawn::{Drawn, followed};
use crate::failure::Failure;
use crate::signals::traces::{Book, Trace};

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

/// The numbers of all pairs, those of the first run before those of the others. Of all values, not of those alone that a
/// picture needs.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn rows(all: &[Drawn], books: &[Book], range: &RangeInclusive<f64>) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for book in books {
        for drawn in all {
            for &(set, actual) in &drawn.group.pairs {
                let trace = |n: usize| &books[0].traces[drawn.group.traces[n]];
                let Some(follows) = book.find(&trace(actual).path) else { continue };
                // What a table does not have it was told to do as the first run was.
                let both: Vec<Column> = match book.find(&trace(set).path) {
                    Some(wanted) => {
                        let shown =
                            [(trace(set), &book.traces[wanted]), (trace(actual), &book.traces[follows])];
                        let columns = book.together(&[wanted, follows], range)?.into_iter();
                        columns
                            .zip(shown)
                            .map(|(column, (shown, own))| shown_as(column, shown, own))
                            .collect()
                    }
                    None => {
                        let wanted = books[0].read(drawn.group.traces[set], range)?;
                        let there = book.read(follows, range)?;
                        let there = shown_as(there, trace(actual), &book.traces[follows]);
                        vec![shown_as(wanted, trace(set), trace(set)), there]
                    }
                };
                let [wanted, follows] = &both[..] else { continue };
                let (time, wanted, there) = followed(wanted, follows, &drawn.group.unit);
                let Some(metrics) = metrics(&time, Some(&wanted), &there) else { continue };
                rows.push(Row {
                    path: trace(actual).path.clone(),
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
    Ok(rows)
}

/// A signal in the unit that `shown` has. Without a unit of its own it is in that one already.
fn shown_as(mut column: Column, shown: &Trace, own: &Trace) -> Column {
    if own.has_unit {
        column.values.iter_mut().for_each(|value| *value = shown.unit.from_si(*value));
    }
    column
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
            "rise": m.rise,
            "overshoot": m.overshoot,
            "settling": m.settling,
            "iae": m.iae,
            "ise": m.ise,
            "final_error": m.steady_state_error,
            "largest_error": m.max_error,
            "largest_error_at": m.max_error_at,
        })
    };
    json!({ "v": 2, "type": "metrics", "following": rows.iter().map(row).collect::<Vec<_>>() })
}
