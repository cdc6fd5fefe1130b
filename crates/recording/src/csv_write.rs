//! Signals and events as CSV (RFC 4180, line feeds, decimal points).

use std::io::{self, Write};

use crate::number::push_number;
use crate::recording::{EventRow, Kind, Recording, Signal};

/// Bytes collected before they are handed on.
const BUFFER: usize = 1 << 16;

/// Writes a recording: first column `time [s]`, then `path [unit]` per signal. Booleans have the unit `bool`
/// and the values 0 and 1, whole numbers without a unit have `int`.
///
/// Numbers are the shortest text that reads back to the same bits; `NaN`, `Inf` and `-Inf` are words.
///
/// # Errors
///
/// What the destination answers; `InvalidInput` if a signal has another number of values than there are
/// times.
pub fn write_signals(destination: &mut dyn Write, recording: &Recording) -> io::Result<()> {
    if let Some(odd) = recording.signals.iter().find(|s| s.values.len() != recording.rows()) {
        let message = format!("`{}` has {} values for {} rows", odd.path, odd.values.len(), recording.rows());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    write_headings(destination, &recording.signals)?;
    let values: Vec<&[f64]> = recording.signals.iter().map(|signal| signal.values.as_slice()).collect();
    write_rows(destination, &recording.time, &values)?;
    destination.flush()
}

/// Writes the first line: names of signals with their units.
///
/// # Errors
/// What the destination answers.
pub fn write_headings(destination: &mut dyn Write, signals: &[Signal]) -> io::Result<()> {
    let mut text = String::from("time [s]");
    for signal in signals {
        text.push(',');
        push_field(&mut text, &heading(signal));
    }
    text.push('\n');
    destination.write_all(text.as_bytes())
}

/// Writes rows: times, and as many values of each signal.
///
/// # Errors
/// What the destination answers.
pub fn write_rows(destination: &mut dyn Write, time: &[f64], values: &[impl AsRef<[f64]>]) -> io::Result<()> {
    let mut text = String::with_capacity(BUFFER + 1024);
    for (row, &time) in time.iter().enumerate() {
        push_number(&mut text, time);
        for values in values {
            text.push(',');
            push_number(&mut text, values.as_ref()[row]);
            hand_on_when_full(&mut text, destination)?;
        }
        text.push('\n');
        hand_on_when_full(&mut text, destination)?;
    }
    destination.write_all(text.as_bytes())
}

/// Writes events with the columns `time [s]`, `path`, `what`.
///
/// # Errors
///
/// What the destination answers.
pub fn write_events(destination: &mut dyn Write, events: &[EventRow]) -> io::Result<()> {
    let mut text = String::from("time [s],path,what\n");
    for event in events {
        push_number(&mut text, event.time);
        text.push(',');
        push_field(&mut text, &event.path);
        text.push(',');
        push_field(&mut text, &event.what);
        text.push('\n');
        hand_on_when_full(&mut text, destination)?;
    }
    destination.write_all(text.as_bytes())?;
    destination.flush()
}

fn hand_on_when_full(text: &mut String, destination: &mut dyn Write) -> io::Result<()> {
    if text.len() >= BUFFER {
        destination.write_all(text.as_bytes())?;
        text.clear();
    }
    Ok(())
}

fn heading(signal: &Signal) -> String {
    let unit = match (signal.kind, signal.unit.as_str()) {
        (Kind::Bool, _) => "bool",
        (Kind::Int, "1") => "int",
        (_, unit) => unit,
    };
    format!("{} [{unit}]", signal.path)
}

/// Quotes where a reader would otherwise see the end of the field or of the line.
fn push_field(text: &mut String, field: &str) {
    if field.contains([',', '"', '\n', '\r']) {
        text.push('"');
        text.push_str(&field.replace('"', "\"\""));
        text.push('"');
    } else {
        text.push_str(field);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_are_quoted_only_where_needed() {
        let signal = |path: &str, unit: &str, kind| Signal::new(path, unit, kind);
        let recording = Recording::new(vec![
            signal("control/joint1/scope.set", "rad", Kind::Real),
            signal("a, \"b\"", "N*m", Kind::Real),
            signal("c.limited", "1", Kind::Bool),
            signal("c.count", "1", Kind::Int),
        ]);
        let mut text = Vec::new();
        write_signals(&mut text, &recording).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "time [s],control/joint1/scope.set [rad],\"a, \"\"b\"\" [N*m]\",c.limited [bool],c.count [int]\n"
        );
    }

    #[test]
    fn a_signal_of_another_length_is_refused() {
        let mut recording = Recording::new(vec![Signal::new("a.y", "1", Kind::Real)]);
        recording.time.push(0.0);
        let error = write_signals(&mut Vec::new(), &recording).unwrap_err();
        assert_eq!(error.to_string(), "`a.y` has 0 values for 1 rows");
    }

    /// Takes a number of bytes, then is full.
    struct SmallDisk(usize);

    impl Write for SmallDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.0 == 0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            let taken = bytes.len().min(self.0);
            self.0 -= taken;
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_full_disk_is_noticed_at_the_first_and_at_the_last_byte() {
        let mut recording = Recording::new(vec![Signal::new("a.y", "1", Kind::Real)]);
        for k in 0..20_000 {
            recording.push_row(f64::from(k), &[0.5]).unwrap();
        }
        let mut whole = Vec::new();
        write_signals(&mut whole, &recording).unwrap();
        assert!(whole.len() > 2 * BUFFER);
        for room in [0, 1, BUFFER, whole.len() - 1] {
            let error = write_signals(&mut SmallDisk(room), &recording).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        }
        write_signals(&mut SmallDisk(whole.len()), &recording).unwrap();
    }
}
