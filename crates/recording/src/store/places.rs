//! Where the chunks of a recording are.

use std::fs::File;
use std::io;

use super::chunk::{self, HEAD, Head};
use super::index::{self, Place, TAIL};
use super::pick::{Failed, bytes_at, read_columns};

/// The chunks by the index at the end; `None` if the file was not closed or the index is damaged.
pub fn closing_index(
    file: &mut File,
    length: u64,
    start: u64,
    widths: &[usize],
) -> io::Result<Option<Vec<Place>>> {
    if length < start + TAIL as u64 {
        return Ok(None);
    }
    let tail = bytes_at(file, length - TAIL as u64, TAIL)?;
    let Some(begin) = index::start(&tail, length).filter(|&begin| begin >= start) else { return Ok(None) };
    let bytes = bytes_at(file, begin, (length - TAIL as u64 - begin) as usize)?;
    let possible = |place: &Place| (place.base as usize) < widths.len() && place.offset < begin;
    Ok(index::read(&bytes, &tail).filter(|places| places.iter().all(possible)))
}

/// The chunks by going from one to the next, as far as they are whole.
pub fn scan(file: &mut File, length: u64, start: u64, widths: &[usize]) -> io::Result<Vec<Place>> {
    let mut places: Vec<Place> = Vec::new();
    let mut offset = start;
    while length - offset >= HEAD as u64 {
        let first = bytes_at(file, offset, HEAD)?;
        let known = |head: &Head| widths.get(head.base as usize) == Some(&(head.columns as usize));
        let Some(head) = chunk::head(&first).filter(known) else { break };
        if head.length() > length - offset {
            break;
        }
        let all = bytes_at(file, offset, HEAD + head.directory() as usize)?;
        if head.entries(&all).is_none() {
            break;
        }
        let Head { base, rows, first, last, .. } = head;
        places.push(Place { offset, base, rows, first, last });
        offset += head.length();
    }
    // What was written last before a loss of power may be there in length only.
    if let Some(last) = places.last() {
        let all: Vec<usize> = (0..widths[last.base as usize]).collect();
        let mut columns = vec![Vec::new(); all.len()];
        match read_columns(file, (length, all.len()), last, &all, &mut columns) {
            Err(Failed::Disk(error)) => return Err(error),
            Err(Failed::Damaged) => drop(places.pop()),
            Ok(()) => {}
        }
    }
    Ok(places)
}
