//! A second recording beside the first: its values in the pictures of the first.

use blocksim_analysis::{Interpolation, Series, refined};
use blocksim_recording::{Column, Kind};
use blocksim_report::{Compared, Report, Role};

use crate::commands::plot::curves::agree;
use crate::failure::Failure;
use crate::signals::other::other_values;
use crate::signals::traces::Book;

/// The second recording.
pub struct Other<'a> {
    /// Its signals.
    pub book: &'a Book,
    /// What to add to its times, s.
    pub shift: f64,
    /// What was found about it.
    pub compared: Compared,
}

/// Adds its values wherever the first recording `book` has a signal of the same path.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn add(book: &Book, other: Other, report: &mut Report) -> Result<(), Failure> {
    for panel in &mut report.panels {
        for series in &mut panel.series {
            let (Some(here), Some(there)) = (book.find(&series.path), other.book.find(&series.path)) else {
                continue;
            };
            let trace = &book.traces[here];
            let measured = &other.book.traces[there];
            if trace.has_unit
                && measured.has_unit
                && !trace.unit.dimension.compatible(measured.unit.dimension)
            {
                continue;
            }
            let column = other_values(other.book, there, trace, other.shift)?;
            let refine = trace.kind == Kind::Real && column.time != panel.time;
            let (times, values) = match refine {
                true => refined(&column.time, &column.values),
                false => (column.time, column.values),
            };
            let course = Series::new(&times, &values);
            let between = if trace.kind == Kind::Real { Interpolation::Linear } else { Interpolation::Hold };
            let (from, to) = course.span().unwrap_or((f64::NAN, f64::NAN));
            let at = |(row, &t): (usize, &f64)| {
                let Some((before, after)) = course.at(t, between, 0.0).filter(|_| from <= t && t <= to)
                else {
                    return f64::NAN;
                };
                // Of two rows of one instant the first is before a jump.
                let jumps = panel.time.get(row + 1) == Some(&t);
                trace.unit.from_si(if jumps { before } else { after })
            };
            let values: Vec<f64> = panel.time.iter().enumerate().map(at).collect();
            // What both were told to do is drawn once.
            let wanted = Column { time: panel.time.clone(), values: series.values.clone() };
            let other = Column { time: panel.time.clone(), values: values.clone() };
            if series.role != Role::Set || !agree(&wanted, &other) {
                series.other = Some(values);
            }
        }
    }
    report.compared = Some(other.compared);
    Ok(())
}
