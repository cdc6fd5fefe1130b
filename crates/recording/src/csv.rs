//! Reading signals and events back, for comparison, plots and tests.

use std::io::{BufRead, BufReader};
use std::path::Path;

use crate::csv_record::Records;
use crate::error::{CsvError, ResultsError};
use crate::recording::{EventRow, Kind, Recording, Signal};
use crate::regular::open_regular;

/// How much a file may ask of memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReadLimits {
    /// Longest line, bytes.
    pub line: usize,
    /// Most numbers (or events), times included.
    pub values: usize,
}

impl Default for ReadLimits {
    /// Lines of 4 MiB and 128 million numbers, which are 1 GiB.
    fn default() -> ReadLimits {
        ReadLimits { line: 4 << 20, values: 1 << 27 }
    }
}

/// Reads a file that [`crate::write_signals`] wrote, or any CSV whose first column is `time [s]`.
///
/// # Errors
///
/// [`ResultsError`] with the file, and for its content with line and column.
pub fn read_csv_file(path: &Path) -> Result<Recording, ResultsError> {
    let file = open_regular(path).map_err(|error| ResultsError::io("read", path, error))?;
    read_csv(BufReader::new(file), ReadLimits::default())
        .map_err(|source| ResultsError::Csv { path: path.to_owned(), source })
}

/// Reads signals. A column `path [unit]` becomes a signal of this path and unit, one without brackets has
/// the unit `1`; the units `bool` and `int` become the kinds of these names with the unit `1`.
///
/// # Errors
///
/// [`CsvError`] with line and column where the text is no such table or exceeds the limits.
pub fn read_csv(source: impl BufRead, limits: ReadLimits) -> Result<Recording, CsvError> {
    let mut records = Records::new(source, limits.line);
    if !records.advance()? {
        return Err(records.error(None, "the file is empty; the first line must name the columns"));
    }
    let mut headings = records.fields().iter().map(|heading| signal(heading));
    match headings.next() {
        Some(time) if time.path == "time" && time.unit == "s" => {}
        _ => return Err(records.error(Some(0), wrong_first_heading(&records.fields()[0]))),
    }
    let mut recording = Recording::new(headings.collect());
    let columns = recording.signals.len() + 1;

    let mut values = Vec::with_capacity(columns);
    while records.advance()? {
        if records.count != columns {
            return Err(records.error(None, wrong_count(records.count, columns)));
        }
        if (recording.rows() + 1).saturating_mul(columns) > limits.values {
            let problem = format!("the file has more than {} numbers, which is the limit", limits.values);
            return Err(records.error(None, problem));
        }
        values.clear();
        for (column, field) in records.fields().iter().enumerate() {
            values.push(number(field).ok_or_else(|| records.error(Some(column), no_number(field)))?);
        }
        let (time, row) = (values[0], &values[1..]);
        recording.push_row(time, row).map_err(|error| records.error(Some(0), error.to_string()))?;
    }
    Ok(recording)
}

/// Reads events, columns `time [s]`, `path`, `what`.
///
/// # Errors
///
/// [`CsvError`] with line and column where the text is no such table or exceeds the limits.
pub fn read_events(source: impl BufRead, limits: ReadLimits) -> Result<Vec<EventRow>, CsvError> {
    let mut records = Records::new(source, limits.line);
    if !records.advance()? || records.fields() != ["time [s]", "path", "what"] {
        return Err(records.error(None, "the first line must be `time [s],path,what`"));
    }
    let mut events = Vec::new();
    while records.advance()? {
        let [time, path, what] = records.fields() else {
            return Err(records.error(None, wrong_count(records.count, 3)));
        };
        if events.len() >= limits.values {
            let problem = format!("the file has more than {} events, which is the limit", limits.values);
            return Err(records.error(None, problem));
        }
        let time = number(time).ok_or_else(|| records.error(Some(0), no_number(time)))?;
        events.push(EventRow { time, path: path.clone(), what: what.clone() });
    }
    Ok(events)
}

/// A heading `path [unit]` as a signal without values.
fn signal(heading: &str) -> Signal {
    let heading = heading.trim();
    let split = heading.strip_suffix(']').and_then(|rest| rest.rsplit_once(" ["));
    match split {
        Some((path, "bool")) => Signal::new(path, "1", Kind::Bool),
        Some((path, "int")) => Signal::new(path, "1", Kind::Int),
        Some((path, unit)) => Signal::new(path, unit, Kind::Real),
        None => Signal::new(heading, "1", Kind::Real),
    }
}

fn number(field: &str) -> Option<f64> {
    field.trim().parse().ok()
}

fn wrong_first_heading(heading: &str) -> String {
    if heading.contains(';') {
        "columns are separated by `;` here; write `,` between columns and a decimal point in numbers"
            .to_owned()
    } else {
        format!("the first column must be `time [s]`, found `{}`", shortened(heading))
    }
}

fn wrong_count(found: usize, expected: usize) -> String {
    let hint = if found > expected { "; a decimal comma? write 1.05, not 1,05" } else { "" };
    format!("{found} columns, but the first line names {expected}{hint}")
}

fn no_number(field: &str) -> String {
    let trimmed = field.trim();
    let with_point = trimmed.replacen(',', ".", 1);
    if trimmed.is_empty() {
        "a number is missing; write NaN for a missing one".to_owned()
    } else if trimmed.contains(',') && number(&with_point).is_some() {
        format!("`{}` is not a number - a decimal comma? write {with_point}", shortened(trimmed))
    } else {
        format!("`{}` is not a number", shortened(trimmed))
    }
}

/// Enough of a text to find it by.
fn shortened(text: &str) -> String {
    if text.chars().count() <= 40 {
        text.to_owned()
    } else {
        text.chars().take(40).chain(std::iter::once('…')).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::csv_write::{write_events, write_signals};

    fn read(text: &str) -> Result<Recording, CsvError> {
        read_csv(text.as_bytes(), ReadLimits::default())
    }

    #[test]
    fn what_is_written_reads_back_bit_by_bit() {
        let mut recording = Recording::new(vec![
            Signal::new("control/joint1/scope.set", "rad", Kind::Real),
            Signal::new("odd, \"name\"\nof two lines", "N*m", Kind::Real),
            Signal::new("drive.limited", "1", Kind::Bool),
            Signal::new("hits", "1", Kind::Int),
            Signal::new("ratio", "1", Kind::Real),
        ]);
        // All bit patterns that a multiplicative generator comes by: subnormals, huge, tiny, NaN.
        let mut bits = 0x0123_4567_89ab_cdef_u64;
        for k in 0..5000 {
            bits = bits.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            let any = f64::from_bits(bits ^ (bits >> 29));
            let row = [any, f64::from(k) * 0.1, f64::from(k % 2), f64::from(k), 1.0 / any];
            recording.push_row(f64::from(k / 2) * 1e-3, &row).unwrap();
        }
        for special in [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MIN_POSITIVE, 5e-324] {
            recording.push_row(1e9, &[special, special, 1.0, -3.0, special]).unwrap();
        }
        let mut text = Vec::new();
        write_signals(&mut text, &recording).unwrap();
        let back = read_csv(&text[..], ReadLimits::default()).unwrap();

        assert_eq!(back.rows(), recording.rows());
        for (a, b) in back.signals.iter().zip(&recording.signals) {
            assert_eq!((&a.path, &a.unit, a.kind), (&b.path, &b.unit, b.kind));
            for (x, y) in a.values.iter().zip(&b.values) {
                assert!(x.to_bits() == y.to_bits() || (x.is_nan() && y.is_nan()), "{x:e} is not {y:e}");
            }
        }
        assert_eq!(back.time, recording.time);
    }

    #[test]
    fn events_read_back() {
        let events = vec![
            EventRow { time: 0.1, path: "arm/joint3".into(), what: "upper limit reached, contact".into() },
            EventRow { time: 0.1, path: "stop".into(), what: "\"end\"".into() },
        ];
        let mut text = Vec::new();
        write_events(&mut text, &events).unwrap();
        assert_eq!(read_events(&text[..], ReadLimits::default()).unwrap(), events);
    }

    #[test]
    fn tables_of_other_programs_are_read() {
        let back = read("time [s],a\r\n0,1\r\n0.5, 2.5\r\n").unwrap();
        assert_eq!(back.time, [0.0, 0.5]);
        assert_eq!(back.signals[0], Signal { values: vec![1.0, 2.5], ..Signal::new("a", "1", Kind::Real) });
    }

    #[test]
    fn mistakes_are_named_with_line_and_column() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(message(""), "line 1: the file is empty; the first line must name the columns");
        assert_eq!(message("t,a\n"), "line 1, column 1: the first column must be `time [s]`, found `t`");
        assert_eq!(
            message("time [s];a [rad]\n0;1,5\n"),
            "line 1, column 1: columns are separated by `;` here; write `,` between columns and a decimal \
             point in numbers"
        );
        assert_eq!(
            message("time [s],a\n0,1,05\n"),
            "line 2: 3 columns, but the first line names 2; a decimal comma? write 1.05, not 1,05"
        );
        assert_eq!(
            message("time [s],a\n0,1\n1,\"1,05\"\n"),
            "line 3, column 2: `1,05` is not a number - a decimal comma? write 1.05"
        );
        assert_eq!(message("time [s],a\n0,x\n"), "line 2, column 2: `x` is not a number");
        assert_eq!(
            message("time [s],a\n0,\n"),
            "line 2, column 2: a number is missing; write NaN for a missing one"
        );
        assert_eq!(message("time [s],a\n0\n"), "line 2: 1 columns, but the first line names 2");
        assert_eq!(
            message("time [s],a\n1,0\n0,0\n"),
            "line 3, column 1: a row at 0 s cannot follow one at 1 s"
        );
    }

    #[test]
    fn memory_is_bounded_by_the_limits() {
        let limits = ReadLimits { line: 100, values: 6 };
        let text = |rows: usize| format!("time [s],a\n{}", "0,0\n".repeat(rows));
        assert_eq!(read_csv(text(3).as_bytes(), limits).unwrap().rows(), 3);
        let error = read_csv(text(4).as_bytes(), limits).unwrap_err();
        assert_eq!(error.to_string(), "line 5: the file has more than 6 numbers, which is the limit");
    }
}
