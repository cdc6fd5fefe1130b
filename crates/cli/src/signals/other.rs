//! Signals of a second recording, brought to units and times of the first.

use blocksim_recording::{ALWAYS, Column};

use super::traces::{Book, Trace};
use crate::failure::Failure;

/// The values of a signal of the other recording in SI, its times shifted. Where it has no unit it is taken to be in the
/// one that the baseline is shown in.
///
/// # Errors
/// Why it cannot be read.
pub fn other_values(book: &Book, at: usize, baseline: &Trace, shift: f64) -> Result<Column, Failure> {
    let mut column = book.read(at, &ALWAYS)?;
    if !book.traces[at].has_unit && baseline.has_unit {
        column.values.iter_mut().for_each(|value| *value = baseline.unit.to_si(*value));
    }
    if shift != 0.0 {
        column.time.iter_mut().for_each(|t| *t += shift);
    }
    Ok(column)
}
