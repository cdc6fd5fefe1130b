//! Signals of a second recording, brought to units and times of the first.

use blocksim_recording::{ALWAYS, Column};

use super::traces::{Book, Trace};
use crate::failure::Failure;

/// The values of a signal of the other recording in SI, its times shifted. Where one of both has no unit it is taken to be in the one that
/// the other is shown in; without one in the baseline, values are numbers in that unit.
///
/// # Errors
/// Why it cannot be read.
pub fn other_values(book: &Book, at: usize, baseline: &Trace, shift: f64) -> Result<Column, Failure> {
    let mut column = book.read(at, &ALWAYS)?;
    let own = &book.traces[at];
    match (baseline.has_unit, own.has_unit) {
        (true, false) => column.values.iter_mut().for_each(|value| *value = baseline.unit.to_si(*value)),
        (false, true) => column.values.iter_mut().for_each(|value| *value = own.unit.from_si(*value)),
        _ => {}
    }
    if shift != 0.0 {
        column.time.iter_mut().for_each(|t| *t += shift);
    }
    Ok(column)
}
