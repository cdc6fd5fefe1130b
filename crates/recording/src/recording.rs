//! What a run records: signals over time, and events.

use serde::{Deserialize, Serialize};

use crate::error::RecordingError;

/// What the values of a signal are. All are kept as `f64`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Real numbers.
    #[default]
    Real,
    /// 0 or 1.
    Bool,
    /// Whole numbers.
    Int,
}

/// One recorded signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Where it comes from: `control/joint1/scope.set`.
    pub path: String,
    /// SI unit as text, `1` where there is none.
    pub unit: String,
    /// What the values are.
    pub kind: Kind,
    /// One value per row of the recording.
    pub values: Vec<f64>,
}

impl Signal {
    /// A signal without values.
    pub fn new(path: impl Into<String>, unit: impl Into<String>, kind: Kind) -> Signal {
        Signal { path: path.into(), unit: unit.into(), kind, values: Vec::new() }
    }
}

/// Signals on one common time axis. Two rows may share a time: the values before and after an event.
///
/// Needs 8 bytes per value and nothing else; rows are the caller's choice.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Times of the rows, s, never falling.
    pub time: Vec<f64>,
    /// The signals, each with as many values as there are times.
    pub signals: Vec<Signal>,
}

impl Recording {
    /// An empty recording of these signals.
    pub fn new(signals: Vec<Signal>) -> Recording {
        Recording { time: Vec::new(), signals }
    }

    /// Makes room for exactly `rows` more rows, so that pushing them allocates nothing.
    pub fn reserve(&mut self, rows: usize) {
        self.time.reserve_exact(rows);
        for signal in &mut self.signals {
            signal.values.reserve_exact(rows);
        }
    }

    /// Adds a row: one value per signal, in their order.
    ///
    /// # Errors
    ///
    /// [`RecordingError`] if the number of values is another or time falls; nothing is added then.
    pub fn push_row(&mut self, time: f64, values: &[f64]) -> Result<(), RecordingError> {
        if values.len() != self.signals.len() {
            return Err(RecordingError::RowLength { signals: self.signals.len(), values: values.len() });
        }
        let last = self.time.last().copied().unwrap_or(f64::NEG_INFINITY);
        let ordered = time >= last;
        if !ordered {
            return Err(RecordingError::TimeOrder { last, time });
        }
        self.time.push(time);
        for (signal, &value) in self.signals.iter_mut().zip(values) {
            signal.values.push(value);
        }
        Ok(())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.time.len()
    }

    /// The signal of this path.
    pub fn signal(&self, path: &str) -> Option<&Signal> {
        self.signals.iter().find(|signal| signal.path == path)
    }
}

/// Something that happened at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct EventRow {
    /// When, s.
    pub time: f64,
    /// Which block: `arm/joint3/limit`.
    pub path: String,
    /// What, in words.
    pub what: String,
}

/// A signal over time, in SI units. Two values may share a time: those before and after an event.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Column {
    /// Times, s, never falling.
    pub time: Vec<f64>,
    /// As many values.
    pub values: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_of_wrong_length_or_time_changes_nothing() {
        let mut recording = Recording::new(vec![Signal::new("a.y", "1", Kind::Real)]);
        recording.push_row(0.0, &[1.0]).unwrap();
        recording.push_row(0.0, &[2.0]).unwrap();
        let before = recording.clone();
        assert!(recording.push_row(1.0, &[]).is_err());
        assert!(recording.push_row(-1.0, &[3.0]).is_err());
        let error = recording.push_row(f64::NAN, &[3.0]).unwrap_err();
        assert_eq!(error.to_string(), "a row at NaN s cannot follow one at 0 s");
        assert_eq!(recording, before);
    }

    #[test]
    fn reserved_room_is_not_exceeded_by_the_rows_it_is_for() {
        let mut recording = Recording::new(vec![Signal::new("a.y", "1", Kind::Real)]);
        recording.reserve(1000);
        let room = recording.time.capacity();
        for k in 0..1000 {
            recording.push_row(f64::from(k), &[0.0]).unwrap();
        }
        assert_eq!(recording.time.capacity(), room);
        assert_eq!(recording.rows(), 1000);
    }
}
