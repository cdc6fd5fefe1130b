//! The values of pictures, from all runs and tables.

use std::borrow::Cow;
use std::ops::RangeInclusive;

use blocksim_analysis::{Interpolation, Series, continued, together, with_gaps, without_jumps};
use blocksim_recording::Column;
use blocksim_signal::Unit;

use super::groups::Group;
use crate::failure::Failure;
use crate::signals::display::turn;
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
    /// What the signals are drawn over, if that is not time; it stands in the place of the times of the columns.
    pub over: Vec<Vec<f64>>,
}

/// A signal of a book over another one, both in their units: what it is drawn over stands in the place of the times.
///
/// # Errors
/// What to tell the person at the keyboard.
fn in_plane(
    book: &Book,
    (over, trace): (usize, usize),
    units: (&Unit, &Unit),
    range: &RangeInclusive<f64>,
) -> Result<Column, Failure> {
    let columns = book.together(&[over, trace], range)?;
    let (x, y) = match columns[0].time == columns[1].time {
        true => (columns[0].values.clone(), columns[1].values.clone()),
        false => {
            let series = |column: usize| Series::new(&columns[column].time, &columns[column].values);
            let (_, x, y) = together(series(0), series(1));
            (x, y)
        }
    };
    // Without a unit of its own a column is taken to be in the unit shown.
    let shown = |unit: &Unit, trace: usize, values: Vec<f64>| -> Vec<f64> {
        let has_unit = book.traces[trace].has_unit;
        values.into_iter().map(|value| if has_unit { unit.from_si(value) } else { value }).collect()
    };
    Ok(Column { time: shown(units.0, over, x), values: shown(units.1, trace, y) })
}

/// Reads the values of a group from all books.
///
/// # Errors
/// What to tell the person at the keyboard.
pub fn read(group: Group, books: &[Book], range: &RangeInclusive<f64>) -> Result<Drawn, Failure> {
    let first = &books[0];
    let mut drawn = Drawn::new(group);
    if let Some(axis) = drawn.group.over.clone() {
        for (number, book) in books.iter().enumerate() {
            for (n, (&over, &at)) in axis.traces.iter().zip(&drawn.group.traces).enumerate() {
                let of = |at: usize| book.find(&first.traces[at].path);
                let (Some(x), Some(y)) = (of(over), of(at)) else { continue };
                let units = (&first.traces[over].unit, &first.traces[at].unit);
                let column = in_plane(book, (x, y), units, range)?;
                match number {
                    0 => {
                        drawn.over.push(column.time.clone());
                        drawn.columns.push(column);
                        drawn.steps.push(false);
                    }
                    _ => drawn.others.push((number, n, column)),
                }
            }
        }
        return Ok(drawn);
    }
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
                let help = format!("give the unit, such as --map 'COLUMN={}[unit]'", trace.path);
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

impl Drawn {
    /// A group of which nothing has been read.
    pub fn new(group: Group) -> Drawn {
        Drawn { group, columns: Vec::new(), steps: Vec::new(), others: Vec::new(), over: Vec::new() }
    }
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

/// A signal that goes on where an angle in `unit` jumps by a whole turn, for a picture too coarse to show a gap.
pub fn going_on<'c>(column: &'c Column, unit: &str) -> Cow<'c, Column> {
    let turn = Unit::parse(unit).ok().and_then(|unit| turn(&unit));
    match turn.and_then(|turn| continued(&column.time, &column.values, turn)) {
        Some(values) => Cow::Owned(Column { time: column.time.clone(), values }),
        None => Cow::Borrowed(column),
    }
}

/// Set and actual value on common times: times, set values, actual values. Angles in `unit` that jump by whole turns are
/// made to go on.
pub fn followed(set: &Column, actual: &Column, unit: &str) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let (mut wanted, mut there) = (set.values.clone(), actual.values.clone());
    if let Some(turn) = Unit::parse(unit).ok().and_then(|unit| turn(&unit)) {
        without_jumps([&set.time, &actual.time], &mut wanted, &mut there, turn);
    }
    together(Series::new(&set.time, &wanted), Series::new(&actual.time, &there))
}

/// Set value less actual value.
pub fn error(set: &Column, actual: &Column, unit: &str) -> Column {
    let (time, wanted, there) = followed(set, actual, unit);
    let values = wanted.iter().zip(&there).map(|(set, actual)| set - actual).collect();
    Column { time, values }
}

/// Whether two signals are the same to the eye, over the time that both have. At a jump either of its values will do: the
/// other signal may have one row there, or two.
pub fn agree(a: &Column, b: &Column) -> bool {
    let size = a.values.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let series = Series::new(&a.time, &a.values);
    let Some((from, to)) = series.span() else { return false };
    let same = |(&t, &y): (&f64, &f64)| {
        let Some((before, after)) = series.at(t, Interpolation::Linear, 0.0).filter(|_| from <= t && t <= to)
        else {
            return true;
        };
        let near = |x: f64| x.is_nan() || (x - y).abs() <= 1e-3 * size;
        near(before) || near(after)
    };
    b.time.iter().zip(&b.values).all(same)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_that_two_runs_have_in_common_is_the_same_whatever_their_rows() {
        let column = |time: &[f64], values: &[f64]| Column { time: time.to_vec(), values: values.to_vec() };
        let step = column(&[0.0, 1.0, 1.0, 3.0], &[0.0, 0.0, 90.0, 90.0]);
        let other = column(&[0.0, 0.5, 1.0, 1.0, 2.0, 2.5], &[0.0, 0.0, 0.0, 90.0, 90.0, 90.0]);
        assert!(agree(&step, &other) && agree(&other, &step));
        let later = column(&[0.0, 1.5, 1.5, 3.0], &[0.0, 0.0, 90.0, 90.0]);
        let higher = column(&[0.0, 1.0, 1.0, 3.0], &[0.0, 0.0, 95.0, 95.0]);
        assert!(!agree(&step, &later) && !agree(&step, &higher));
        assert!(!agree(&column(&[], &[]), &step));
    }
}
