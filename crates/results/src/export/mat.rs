//! MAT-files of version 5 (MATLAB "Level 5", as it is published): what MATLAB, Octave and SciPy load.

use std::collections::HashSet;
use std::io::{self, Write};
use std::ops::RangeInclusive;

use super::within::within;
use crate::error::ResultsError;
use crate::run::Run;

/// Types of data elements.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const UTF8: u32 = 16;
/// Classes of arrays.
const STRUCT_CLASS: u32 = 2;
const CHAR_CLASS: u32 = 4;
const DOUBLE_CLASS: u32 = 6;
/// Longest name of a variable in MATLAB, without the zero at the end.
const NAME: usize = 63;
/// Bytes that an element may have.
const MOST: u64 = (1 << 31) - 1;

/// Writes signals within a range of time. Each becomes a column vector of doubles named after its path with `_` for what
/// names in MATLAB may not have; each time base becomes `time`, `time_2` and so on. The structs `path`, `unit` and
/// `time_of` tell for each variable the path, the SI unit and the name of its times.
///
/// # Errors
/// What the destination answers; `InvalidData` where a signal has more values than such a file can hold, and for what
/// reading the run brings.
pub fn write_mat(
    destination: &mut dyn Write,
    run: &Run,
    signals: &[usize],
    range: &RangeInclusive<f64>,
) -> io::Result<()> {
    let mut header = format!("MATLAB 5.0 MAT-file, blocksim {}", env!("CARGO_PKG_VERSION")).into_bytes();
    header.resize(124, b' ');
    header[116..124].fill(0);
    header.extend(0x0100_u16.to_le_bytes());
    header.extend(b"IM");
    destination.write_all(&header)?;

    let mut names = HashSet::from(["path", "unit", "time_of"].map(str::to_owned));
    let mut times: Vec<(usize, String, u64)> = Vec::new();
    let mut about: [Vec<(String, String)>; 3] = Default::default();
    for &at in signals {
        let Some(info) = run.signals().get(at) else { continue };
        let (time, rows) = match times.iter().find(|(base, ..)| *base == info.base) {
            Some((_, name, rows)) => (name.clone(), *rows),
            None => {
                let rows = count(run, info.base, range)?;
                let name = unused("time", &mut names);
                vector(destination, &name, rows, run, info.base, None, range)?;
                times.push((info.base, name.clone(), rows));
                (name, rows)
            }
        };
        let name = unused(&identifier(&info.path), &mut names);
        vector(destination, &name, rows, run, info.base, Some(at), range)?;
        about[0].push((name.clone(), info.path.clone()));
        about[1].push((name.clone(), info.unit.clone()));
        about[2].push((name, time));
    }
    for (name, fields) in ["path", "unit", "time_of"].iter().zip(&about) {
        destination.write_all(&structure(name, fields))?;
    }
    destination.flush()
}

fn count(run: &Run, base: usize, range: &RangeInclusive<f64>) -> io::Result<u64> {
    let mut rows = 0;
    let counted = run.blocks(base, &[], range, &mut |time, _| {
        rows += time.len() as u64;
        Ok(())
    });
    counted.map_err(within)?;
    Ok(rows)
}

/// A column vector: the times of a base, or a signal of it.
fn vector(
    destination: &mut dyn Write,
    name: &str,
    rows: u64,
    run: &Run,
    base: usize,
    signal: Option<usize>,
    range: &RangeInclusive<f64>,
) -> io::Result<()> {
    let too_long = || {
        let message = format!(
            "`{name}` has {rows} values, too many for a MAT-file; export part of the time or every n-th"
        );
        io::Error::new(io::ErrorKind::InvalidData, message)
    };
    if 8 * rows > MOST - 1024 {
        return Err(too_long());
    }
    let head = array_head(DOUBLE_CLASS, rows as u32, 1, name);
    let mut bytes = tag(MATRIX, head.len() as u32 + 8 + 8 * rows as u32);
    bytes.extend(head);
    bytes.extend(tag(DOUBLE, 8 * rows as u32));
    destination.write_all(&bytes)?;
    let mut refused = None;
    let wanted: Vec<usize> = signal.into_iter().collect();
    let done = run.blocks(base, &wanted, range, &mut |time, values| {
        let column = values.first().map_or(time, Vec::as_slice);
        let bytes: Vec<u8> = column.iter().flat_map(|value| value.to_le_bytes()).collect();
        destination.write_all(&bytes).map_err(|error| {
            let kind = error.kind();
            refused = Some(error);
            ResultsError::io("write", run.path(), kind.into())
        })
    });
    if let Some(error) = refused {
        return Err(error);
    }
    done.map_err(within)
}

/// A struct of texts.
fn structure(name: &str, fields: &[(String, String)]) -> Vec<u8> {
    let mut content = array_head(STRUCT_CLASS, 1, 1, name);
    // The length of the names of fields, in the short form of an element.
    content.extend(INT32.to_le_bytes()[..2].iter());
    content.extend(4_u16.to_le_bytes());
    content.extend((NAME as u32 + 1).to_le_bytes());
    let mut names = Vec::with_capacity(fields.len() * (NAME + 1));
    for (field, _) in fields {
        names.extend(field.as_bytes());
        names.resize(names.len().next_multiple_of(NAME + 1), 0);
    }
    content.extend(element(INT8, &names));
    for (_, text) in fields {
        let mut array = array_head(CHAR_CLASS, 1, text.chars().count() as u32, "");
        array.extend(element(UTF8, text.as_bytes()));
        content.extend(element(MATRIX, &array));
    }
    element(MATRIX, &content)
}

/// Class, dimensions and name of an array.
fn array_head(class: u32, rows: u32, columns: u32, name: &str) -> Vec<u8> {
    let numbers = |numbers: [u32; 2]| numbers.map(u32::to_le_bytes).concat();
    let mut bytes = element(UINT32, &numbers([class, 0]));
    bytes.extend(element(INT32, &numbers([rows, columns])));
    bytes.extend(element(INT8, name.as_bytes()));
    bytes
}

fn tag(kind: u32, length: u32) -> Vec<u8> {
    [kind, length].map(u32::to_le_bytes).concat()
}

/// An element, filled up to a multiple of eight bytes.
fn element(kind: u32, content: &[u8]) -> Vec<u8> {
    let mut bytes = tag(kind, content.len() as u32);
    bytes.extend(content);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A path as a name in MATLAB: letters, digits and `_`, beginning with a letter.
fn identifier(path: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mut name: String = path.chars().map(plain).collect();
    name.truncate(name.trim_end_matches('_').len());
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        name.insert(0, 'x');
    }
    // The end of a path tells more than its beginning.
    if name.len() > NAME {
        name = format!("x{}", &name[name.len() - NAME + 1..]);
    }
    name
}

/// The name, or the name with the first number that makes it a new one.
fn unused(name: &str, names: &mut HashSet<String>) -> String {
    let numbered = (2_u32..).map(|n| {
        let suffix = format!("_{n}");
        format!("{}{suffix}", &name[..name.len().min(NAME - suffix.len())])
    });
    let mut candidates = std::iter::once(name.to_owned()).chain(numbered);
    let found = candidates.find(|candidate| !names.contains(candidate)).unwrap_or_default();
    names.insert(found.clone());
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ALWAYS, Kind, Recording, Signal};

    #[test]
    fn names_are_those_that_matlab_takes_and_each_is_new() {
        let mut names = HashSet::new();
        let long = format!("a/{}", "b".repeat(100));
        let mut name = |path: &str| unused(&identifier(path), &mut names);
        assert_eq!(name("servo/angle.actual"), "servo_angle_actual");
        assert_eq!(name("servo.angle/actual"), "servo_angle_actual_2");
        assert_eq!(name("1.q[0]"), "x1_q_0");
        assert_eq!(name("ü"), "x");
        assert_eq!(name(""), "x_2");
        assert_eq!((name(&long).len(), name(&long).len()), (63, 63));
    }

    #[test]
    fn the_elements_of_a_file_follow_each_other_on_multiples_of_eight() {
        let mut recording = Recording::new(vec![Signal::new("a.y", "N*m", Kind::Real)]);
        (0..5).for_each(|k| recording.push_row(f64::from(k), &[f64::NAN]).unwrap());
        let run = Run::of_recording(recording, "memory".as_ref());
        let mut bytes = Vec::new();
        write_mat(&mut bytes, &run, &[0], &(1.0..=3.0)).unwrap();
        assert_eq!(&bytes[124..128], b"\0\x01IM");
        let mut at = 128;
        let mut arrays = 0;
        while at < bytes.len() {
            assert_eq!(bytes[at], MATRIX as u8);
            at += 8 + u32::from_le_bytes(bytes[at + 4..at + 8].try_into().unwrap()) as usize;
            arrays += 1;
        }
        assert_eq!((at, arrays), (bytes.len(), 5), "time, a_y and three structs");
        write_mat(&mut Vec::new(), &run, &[], &ALWAYS).unwrap();
    }
}
