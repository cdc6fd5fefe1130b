//! Columns of one chunk.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use super::chunk::{self, HEAD, Head};
use super::column;
use super::index::Place;

/// Why a chunk cannot be read.
pub enum Failed {
    /// The disk says no.
    Disk(io::Error),
    /// It is not what was written.
    Damaged,
}

impl From<io::Error> for Failed {
    fn from(error: io::Error) -> Failed {
        // The file is shorter than its index says.
        if error.kind() == io::ErrorKind::UnexpectedEof { Failed::Damaged } else { Failed::Disk(error) }
    }
}

/// Fills `values` with columns of a chunk of a file of this length and a time base of this width; the first of them is time, which must not fall.
pub fn read_columns(
    file: &mut File,
    (length, width): (u64, usize),
    place: &Place,
    wanted: &[usize],
    values: &mut [Vec<f64>],
) -> Result<(), Failed> {
    let first = bytes_at(file, place.offset, HEAD)?;
    let head = chunk::head(&first).filter(|head| fits(head, place)).ok_or(Failed::Damaged)?;
    if head.columns as usize != width || place.offset.saturating_add(head.length()) > length {
        return Err(Failed::Damaged);
    }
    let all = bytes_at(file, place.offset, HEAD + head.directory() as usize)?;
    let entries = head.entries(&all).ok_or(Failed::Damaged)?;
    let data = place.offset + HEAD as u64 + head.directory();
    for (&column, values) in wanted.iter().zip(values.iter_mut()) {
        let entry = entries.get(column).ok_or(Failed::Damaged)?;
        let bytes = bytes_at(file, data + entry.at, entry.length as usize)?;
        if crc32fast::hash(&bytes) != entry.sum {
            return Err(Failed::Damaged);
        }
        values.clear();
        if !column::decode(entry.form, &bytes, head.rows as usize, values) {
            return Err(Failed::Damaged);
        }
    }
    if values[0].is_sorted() { Ok(()) } else { Err(Failed::Damaged) }
}

fn fits(head: &Head, place: &Place) -> bool {
    let same_time =
        head.first.to_bits() == place.first.to_bits() && head.last.to_bits() == place.last.to_bits();
    head.base == place.base && head.rows == place.rows && same_time
}

/// Bytes of a file from an offset on.
pub fn bytes_at(file: &mut File, offset: u64, length: usize) -> io::Result<Vec<u8>> {
    file.seek(SeekFrom::Start(offset))?;
    let mut bytes = vec![0; length];
    file.read_exact(&mut bytes)?;
    Ok(bytes)
}
