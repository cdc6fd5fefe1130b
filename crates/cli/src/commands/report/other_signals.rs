//! Signals that were recorded and that no picture shows.

use std::collections::HashSet;

use blocksim_picture::pretty_unit;
use blocksim_recording::ALWAYS;
use blocksim_report::{Report, Unseen, few};

use crate::failure::Failure;
use crate::signals::traces::Book;

/// Most of them in a page that is to stay small.
const MOST: usize = 1000;
/// Points of each that are kept until the page is made.
const POINTS: usize = 1000;

/// Adds them; the pictures must be there.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn add(book: &Book, report: &mut Report) -> Result<(), Failure> {
    let shown: HashSet<&str> =
        report.panels.iter().flat_map(|panel| &panel.series).map(|series| series.path.as_str()).collect();
    let mut unseen: Vec<usize> =
        (0..book.traces.len()).filter(|&at| !shown.contains(book.traces[at].path.as_str())).collect();
    if !report.full && unseen.len() > MOST {
        report.warnings.push(format!(
            "{} recorded signals have no picture; only the first {MOST} of them are in this page (--full keeps all).",
            unseen.len()
        ));
        unseen.truncate(MOST);
    }
    for at in unseen {
        let trace = &book.traces[at];
        let mut column = if report.full { book.read(at, &ALWAYS)? } else { book.picture(at, &ALWAYS)? };
        column.values.iter_mut().for_each(|value| *value = trace.unit.from_si(*value));
        let mut signal = Unseen {
            path: trace.path.clone(),
            unit: pretty_unit(&trace.unit.to_string()),
            held: trace.held,
            ..Unseen::default()
        };
        if report.full {
            (signal.time, signal.values) = (column.time, column.values);
        } else {
            let few = few(&column.time, &column.values, signal.held, POINTS);
            signal.time = few.rows.iter().map(|&row| column.time[row]).collect();
            signal.values = few.rows.iter().map(|&row| column.values[row]).collect();
            signal.tolerance = few.tolerance;
        }
        report.unseen.push(signal);
    }
    Ok(())
}
