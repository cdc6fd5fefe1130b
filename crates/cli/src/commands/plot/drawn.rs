//! The values of pictures, from all runs and tables.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use blocksim_analysis::{Interpolation, Series, together, with_gaps, without_jumps};
use blocksim_results::Column;
use blocksim_signal::Unit;

use super::groups::Group;
use crate::failure::Failure;
use crate::signals::shown::turn;
use crate::signals::traces::Book;

/// The values of a group.
pub struct Drawn {
    /// What it shows.
    pub group: Group,
    /// Values in the unit of the group, one column for each signal.
    pub columns: Vec<Column>,
    /// Whether the values of a signal hold until the next one.
    pub steps: Vec<bool>,
    /// The same signals of the other books, where they have them: book, position in the group, values.
    pub others: Vec<(usize, usize, Column)>,
}

/// Reads the values of a group from all books.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn read(group: Group, books: &[Book], range: &RangeInclusive<f64>) -> Result<Drawn, Failure> {
    let first = &books[0];
    let mut drawn = Drawn { columns: Vec::new(), steps: Vec::new(), others: Vec::new(), group };
    drawn.columns = first.pictures(&drawn.group.traces, range)?;
    for (n, (&at, column)) in drawn.group.traces.iter().zip(&mut drawn.columns).enumerate() {
        let trace = &first.traces[at];
        column.values.iter_mut().for_each(|value| *value = trace.unit.from_si(*value));
        drawn.steps.push(trace.held);
        for (number, book) in books.iter().enumerate().skip(1) {
            let Some(there) = book.find(&trace.path) else { continue };
            let other = &book.traces[there];
            if other.has_unit && trace.has_unit && !other.unit.dimension.compatible(trace.unit.dimension) {
                let said = format!(
                    "`{}` is in {} in `{}`, but in {} in `{}`",
                    trace.path, trace.unit, first.name, other.unit, book.name
                );
                let help = format!("say the unit, such as --map 'COLUMN={}[unit]'", trace.path);
                return Err(Failure::unreadable(said).help(help));
            }
            let mut column = book.picture(there, range)?;
            // Without a unit of its own a column is taken to be in the unit shown.
            if other.has_unit {
                column.values.iter_mut().for_each(|value| *value = trace.unit.from_si(*value));
            }
            drawn.others.push((number, n, column));
        }
    }
    Ok(drawn)
}

/// Whether two groups show the same values at ports of the same names.
fn is_same(a: &Drawn, b: &Drawn) -> bool {
    let same = |x: &Column, y: &Column| x.time == y.time && x.values == y.values;
    a.group.unit == b.group.unit
        && a.group.ports == b.group.ports
        && a.columns.iter().zip(&b.columns).all(|(x, y)| same(x, y))
}

/// Adds what was read of a group, unless it is there: two scopes may show the same. Of these the one with labels stays.
pub fn add_once(all: &mut Vec<Drawn>, drawn: Drawn) {
    match all.iter_mut().find(|other| is_same(other, &drawn)) {
        Some(other) if drawn.group.is_labelled && !other.group.is_labelled => *other = drawn,
        Some(_) => {}
        None => all.push(drawn),
    }
}

/// A signal as a line can show it: where an angle in `unit` jumps by a whole turn, it has a gap.
pub fn with_breaks<'c>(column: &'c Column, unit: &str) -> Cow<'c, Column> {
    let turn = Unit::parse(unit).ok().and_then(|unit| turn(&unit));
    match turn.and_then(|turn| with_gaps(&column.time, &column.values, turn)) {
        Some((time, values)) => Cow::Owned(Column { time, values }),
        None => Cow::Borrowed(column),
    }
}

/// Set and actual value on common times: times, set values, actual values. Angles in `unit` that jump by whole turns are
/// made to go on.
pub fn followed(set: &Column, actual: &Column, unit: &str) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (mut wanted, mut there) = (set.values.clone(), actual.values.clone());
    if let Some(turn) = Unit::parse(unit).ok().and_then(|unit| turn(&unit)) {
        without_jumps(&mut wanted, &mut there, turn);
    }
    together(Series::new(&set.time, &wanted), Series::new(&actual.time, &there))
}

/// Set value less actual value.
pub fn error(set: &Column, actual: &Column, unit: &str) -> Column {
    let (time, wanted, there) = followed(set, actual, unit);
    let values = wanted.iter().zip(&there).map(|(set, actual)| set - actual).collect();
    Column { time, values }
}

/// The values of a signal at other times.
fn at_times(column: &Column, time: &[f64]) -> Vec<f64> {
    if column.time == time {
        return column.values.clone();
    }
    let series = Series::new(&column.time, &column.values);
    let covers = series.span().unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
    let at = |&t: &f64| match series.at(t, Interpolation::Linear, 0.0) {
        Some((_, value)) if t >= covers.0 && t <= covers.1 => value,
        _ => f64::NAN,
    };
    time.iter().map(at).collect()
}

/// Whether two signals are the same to the eye, over the time that both have.
pub fn agree(a: &Column, b: &Column) -> bool {
    let size = a.values.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let there = at_times(a, &b.time);
    there.iter().zip(&b.values).all(|(x, y)| x.is_nan() || (x - y).abs() <= 1e-3 * size)
}
