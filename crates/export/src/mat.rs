//! MAT-files of version 5 (MATLAB "Level 5", as it is published): what MATLAB, Octave and SciPy load.

use std::collections::HashSet;
use std::io::{self, Write};
use std::ops::RangeInclusive;

use crate::within::within;
use blocksim_recording::ResultsError;
use blocksim_recording::Run;

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
/// `time_of` tell for each variable the path, the SI unit and the name of its times. Held signals have both values of their
/// jumps, and all signals of their time base a row for them.
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
    let mut bases: Vec<Base> = Vec::new();
    let mut about: [Vec<(String, String)>; 3] = Default::default();
    for &at in signals {
        let Some(info) = run.signals().get(at) else { continue };
        let known = bases.iter().position(|base| base.number == info.base);
        let base = match known {
            Some(known) => &bases[known],
            None => {
                let mut base = Base::of(run, info.base, signals, range)?;
                base.time = unused("time", &mut names);
                vector(destination, &base.time, run, &base, None, range)?;
                bases.push(base);
                &bases[bases.len() - 1]
            }
        };
        let name = unused(&identifier(&info.path), &mut names);
        vector(destination, &name, run, base, Some(at), range)?;
        let time = base.time.clone();
        about[0].push((name.clone(), info.path.clone()));
        about[1].push((name.clone(), info.unit.clone()));
        about[2].push((name, time));
    }
    for (name, fields) in ["path", "unit", "time_of"].iter().zip(&about) {
        destination.write_all(&structure(name, fields))?;
    }
    destination.flush()
}

/// A time base of the file.
struct Base {
    /// Its number in the run.
    number: usize,
    /// Name of its times.
    time: String,
    /// Rows, those before jumps of held signals included.
    rows: u64,
    /// Recorded rows that have one before them, because a held signal jumps there.
    doubled: Vec<u64>,
}

impl Base {
    fn of(run: &Run, number: usize, signals: &[usize], range: &RangeInclusive<f64>) -> io::Result<Base> {
        let is_held = |&at: &usize| run.signals().get(at).is_some_and(|s| s.base == number && s.held);
        let held: Vec<usize> = signals.iter().copied().filter(is_held).collect();
        let mut base = Base { number, time: String::new(), rows: 0, doubled: Vec::new() };
        let mut before: Option<(f64, Vec<f64>)> = None;
        let counted = run.recorded_blocks(number, &held, range, &mut |time, values| {
            for (row, &t) in time.iter().enumerate() {
                let now: Vec<f64> = values.iter().map(|column| column[row]).collect();
                let jumps = before.as_ref().is_some_and(|(last, old)| {
                    t > *last && old.iter().zip(&now).any(|(old, now)| old.to_bits() != now.to_bits())
                });
                if jumps {
                    base.doubled.push(base.rows);
                }
                base.rows += 1;
                before = Some((t, now));
            }
            Ok(())
        });
        counted.map_err(within)?;
        base.rows += base.doubled.len() as u64;
        Ok(base)
    }
}

/// A column vector: the times of a base, or a signal of it.
fn vector(
    destination: &mut dyn Write,
    name: &str,
    run: &Run,
    base: &Base,
    signal: Option<usize>,
    range: &RangeInclusive<f64>,
) -> io::Result<()> {
    let rows = base.rows;
    let is_held = signal.is_some_and(|at| run.signals()[at].held);
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
    let mut doubled = base.doubled.iter().copied().peekable();
    let (mut row, mut last) = (0_u64, 0.0_f64);
    let done = run.recorded_blocks(base.number, &wanted, range, &mut |time, values| {
        let column = values.first().map_or(time, Vec::as_slice);
        let mut bytes = Vec::with_capacity(16 * column.len());
        for &value in column {
            if doubled.next_if_eq(&row).is_some() {
                let before = if is_held { last } else { value };
                bytes.extend(before.to_le_bytes());
            }
            bytes.extend(value.to_le_bytes());
            (row, last) = (row + 1, value);
        }
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
    use blocksim_recording::{ALWAYS, Kind, Recording, Signal};

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
    fn what_is_held_has_both_values_of_its_jumps_and_all_vectors_of_a_base_have_as_many() {
        use blocksim_recording::{Layout, SignalInfo};
        let info = |path: &str, held| SignalInfo { path: path.to_owned(), held, ..SignalInfo::default() };
        let mut recording =
            Recording::new(["held", "moving"].map(|path| Signal::new(path, "1", Kind::Real)).to_vec());
        for (t, row) in [(0.0, [0.0, 5.0]), (1.0, [3.0, 6.0]), (2.0, [3.0, 7.0])] {
            recording.push_row(t, &row).unwrap();
        }
        let layout =
            Layout { signals: vec![info("held", true), info("moving", false)], ..Layout::of(&recording) };
        let run = Run::of_layout(recording, layout, "memory".as_ref());
        let mut bytes = Vec::new();
        write_mat(&mut bytes, &run, &[1, 0], &ALWAYS).unwrap();
        let doubles = |values: [f64; 4]| values.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
        let has = |values| bytes.windows(32).any(|window| window == doubles(values));
        assert!(has([0.0, 1.0, 1.0, 2.0]), "time");
        assert!(has([5.0, 6.0, 6.0, 7.0]), "moving");
        assert!(has([0.0, 0.0, 3.0, 3.0]), "held");
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
