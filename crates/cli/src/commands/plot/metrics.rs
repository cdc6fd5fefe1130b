//! How actual values follow their set values, as a table and as data.

use std::ops::RangeInclusive;

use blocksim_analysis::{Metrics, metrics};
use blocksim_numbers::format::{fixed, seconds, significant};
use blocksim_recording::{Column, Kind};
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use super::curves::{Drawn, followed, going_on};
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
    /// The run that it is of, and what that is called beside others.
    pub run: String,
    pub label: String,
    /// The numbers.
    pub metrics: Metrics,
    /// Whether it follows a set value; else the numbers are those of its way to its own last value, and errors mean nothing.
    pub follows: bool,
}

/// The numbers of all pairs, those of the first run before those of the others. Of all values, not of those alone that a
/// picture needs. With `alone` there are rows of the signals that follow nothing, too.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn rows(
    all: &[Drawn],
    books: &[Book],
    range: &RangeInclusive<f64>,
    alone: bool,
) -> Result<Vec<Row>, Failure> {
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
                    label: book.label.clone(),
                    metrics,
                    follows: true,
                });
            }
            if alone {
                rows.extend(lone_rows(drawn, books, book, range)?);
            }
        }
    }
    Ok(rows)
}

/// The numbers of the signals of a group that are in no pair: of their way to their own last value.
fn lone_rows(
    drawn: &Drawn,
    books: &[Book],
    book: &Book,
    range: &RangeInclusive<f64>,
) -> Result<Vec<Row>, Failure> {
    let group = &drawn.group;
    let mut rows = Vec::new();
    for (n, &at) in group.traces.iter().enumerate() {
        let trace = &books[0].traces[at];
        let is_paired = group.pairs.iter().any(|pair| pair.0 == n || pair.1 == n);
        let Some(there) = book.find(&trace.path).filter(|_| !is_paired && trace.kind == Kind::Real) else {
            continue;
        };
        let column = shown_as(book.read(there, range)?, trace, &book.traces[there]);
        let column = going_on(&column, &group.unit);
        let Some(metrics) = metrics(&column.time, None, &column.values) else { continue };
        let name = format!("{} {}", group.title, group.names[n]);
        rows.push(Row {
            path: trace.path.clone(),
            name: name.trim().to_owned(),
            unit: group.unit.clone(),
            run: book.name.clone(),
            label: book.label.clone(),
            metrics,
            follows: false,
        });
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
    let disturbed = rows.iter().any(|row| row.metrics.disturbed.is_some());
    let mut headings = vec![
        "tracking",
        "unit",
        "step",
        "rise [s]",
        "overshoot",
        "settling [s]",
        "IAE",
        "ISE",
        "final error",
        "maximum error",
        "at [s]",
    ];
    if disturbed {
        headings.push("disturbed [s]");
    }
    let aligned = |n: usize| if n < 2 { Align::Left } else { Align::Right };
    let columns: Vec<(&str, Align)> =
        headings.iter().enumerate().map(|(n, name)| (*name, aligned(n))).collect();
    let mut table = Table::new(&columns);
    let time = |t: Option<f64>| t.map_or_else(|| "-".to_owned(), |t| seconds(t, 4));
    for Row { name, unit, label, metrics: m, follows, .. } in rows {
        let name = if several { format!("{name}, {label}") } else { name.clone() };
        let error = |x: String| if *follows { x } else { "-".to_owned() };
        let mut cells = vec![
            name,
            unit.clone(),
            significant(m.step, 4),
            time(m.rise),
            m.overshoot.map_or_else(|| "-".to_owned(), |x| format!("{} %", fixed(100.0 * x, 2))),
            time(m.settling),
            error(significant(m.iae, 4)),
            error(significant(m.ise, 4)),
            error(significant(m.steady_state_error, 4)),
            error(significant(m.max_error, 4)),
            error(seconds(m.max_error_at, 4)),
        ];
        if disturbed {
            cells.push(time(m.disturbed));
        }
        table.row(cells);
    }
    table.render()
}

/// The same as data, in the units shown.
pub fn json(rows: &[Row]) -> Value {
    let row = |row: &Row| {
        let m = &row.metrics;
        let error = |x: f64| row.follows.then_some(x);
        json!({
            "run": row.run,
            "signal": row.path,
            "unit": row.unit,
            "begin": m.begin,
            "step": m.step,
            "rise": m.rise,
            "overshoot": m.overshoot,
            "settling": m.settling,
            "disturbed_at": m.disturbed,
            "follows": row.follows,
            "iae": error(m.iae),
            "ise": error(m.ise),
            "final_error": error(m.steady_state_error),
            "maximum_error": error(m.max_error),
            "maximum_error_at": error(m.max_error_at),
        })
    };
    json!({ "v": 3, "type": "metrics", "tracking": rows.iter().map(row).collect::<Vec<_>>() })
}
