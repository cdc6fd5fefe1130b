//! The table of chunks at the end of a recording, and the last bytes, which say where it is.

use super::bytes::{f64_at, u32_at, u64_at};
use super::marks::END;

/// First bytes of the index.
const TAG: [u8; 4] = *b"INDX";
/// Bytes of an entry.
const ENTRY: usize = 32;
/// Bytes at the very end.
pub const TAIL: usize = 24;

/// One chunk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Its first byte within the file.
    pub offset: u64,
    /// Time base.
    pub base: u32,
    /// Rows.
    pub rows: u32,
    /// Time of the first row, s.
    pub first: f64,
    /// Time of the last row, s.
    pub last: f64,
}

/// Index and last bytes for an index that begins at `offset`.
pub fn write(places: &[Place], offset: u64) -> Vec<u8> {
    let mut bytes = TAG.to_vec();
    bytes.extend((places.len() as u32).to_le_bytes());
    for place in places {
        bytes.extend(place.offset.to_le_bytes());
        bytes.extend(place.base.to_le_bytes());
        bytes.extend(place.rows.to_le_bytes());
        bytes.extend(place.first.to_le_bytes());
        bytes.extend(place.last.to_le_bytes());
    }
    let sum = crc32fast::hash(&bytes);
    bytes.extend(offset.to_le_bytes());
    bytes.extend(sum.to_le_bytes());
    bytes.extend([0; 4]);
    bytes.extend(END);
    bytes
}

/// Where the index begins, from the last bytes of a file of this length; `None` if it was not closed.
pub fn start(tail: &[u8], length: u64) -> Option<u64> {
    let closed = tail.len() == TAIL && tail[16..] == END;
    let start = u64_at(tail, 0);
    (closed && start < length - TAIL as u64).then_some(start)
}

/// Reads the index from its bytes and the last ones; `None` if it is damaged.
pub fn read(bytes: &[u8], tail: &[u8]) -> Option<Vec<Place>> {
    let (head, entries) = bytes.split_at_checked(8)?;
    let count = u32_at(head, 4) as usize;
    let whole = head[..4] == TAG && entries.len() == count.checked_mul(ENTRY)?;
    if !whole || crc32fast::hash(bytes) != u32_at(tail, 8) {
        return None;
    }
    let place = |entry: &[u8]| Place {
        offset: u64_at(entry, 0),
        base: u32_at(entry, 8),
        rows: u32_at(entry, 12),
        first: f64_at(entry, 16),
        last: f64_at(entry, 24),
    };
    Some(entries.chunks_exact(ENTRY).map(place).collect())
}
