//! A chunk: some rows of one time base, column by column, behind a directory that says where each column is.

use super::bytes::{f64_at, u32_at, u64_at};
use super::column;
use super::marks::MOST_ROWS;
use crate::recording::Kind;

/// First bytes of a chunk.
pub const TAG: [u8; 4] = *b"CHNK";
/// Bytes before the directory.
pub const HEAD: usize = 48;
/// Bytes of the directory for each column.
pub const ENTRY: usize = 12;

/// What the bytes before the directory say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Head {
    /// Time base.
    pub base: u32,
    /// Rows.
    pub rows: u32,
    /// Columns, time included.
    pub columns: u32,
    /// Bytes behind the directory.
    pub data: u64,
    /// Time of the first row, s.
    pub first: f64,
    /// Time of the last row, s.
    pub last: f64,
    sum: u32,
}

/// Where a column is within the data of its chunk.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// First byte.
    pub at: u64,
    /// Bytes.
    pub length: u32,
    /// How the values are written.
    pub form: u32,
    /// CRC-32 of the bytes.
    pub sum: u32,
}

/// Reads the first bytes of a chunk; `None` where there is none, or one that cannot be.
pub fn head(bytes: &[u8]) -> Option<Head> {
    if bytes.len() < HEAD || bytes[..4] != TAG {
        return None;
    }
    let head = Head {
        base: u32_at(bytes, 4),
        rows: u32_at(bytes, 8),
        columns: u32_at(bytes, 12),
        data: u64_at(bytes, 16),
        first: f64_at(bytes, 24),
        last: f64_at(bytes, 32),
        sum: u32_at(bytes, 44),
    };
    let possible = (1..=MOST_ROWS).contains(&head.rows) && head.columns > 0;
    // No form takes more than eight bytes a value.
    let most = || u64::from(head.columns) * 8 * u64::from(head.rows);
    (possible && head.data <= most()).then_some(head)
}

impl Head {
    /// Bytes of the directory.
    pub fn directory(&self) -> u64 {
        u64::from(self.columns) * ENTRY as u64
    }

    /// Bytes of the whole chunk.
    pub fn length(&self) -> u64 {
        HEAD as u64 + self.directory() + self.data
    }

    /// Reads the directory from the bytes of head and directory; `None` if it is damaged.
    pub fn entries(&self, bytes: &[u8]) -> Option<Vec<Entry>> {
        let (head, directory) = bytes.split_at_checked(HEAD)?;
        if directory.len() as u64 != self.directory() || sum(head, directory) != self.sum {
            return None;
        }
        let mut at = 0;
        let mut entries = Vec::with_capacity(self.columns as usize);
        for entry in directory.chunks_exact(ENTRY) {
            let (form, length) = (u32_at(entry, 0), u32_at(entry, 4));
            if !column::can_have(form, self.rows as usize, length as usize) {
                return None;
            }
            entries.push(Entry { at, length, form, sum: u32_at(entry, 8) });
            at += u64::from(length);
        }
        (at == self.data).then_some(entries)
    }
}

fn sum(head: &[u8], directory: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&head[..44]);
    hasher.update(directory);
    hasher.finalize()
}

/// Columns that are turned at a time: the doubles of a line of the cache.
const ABREAST: usize = 8;

/// Makes chunks of rows in memory that is used again.
#[derive(Debug, Default)]
pub struct Maker {
    bytes: Vec<u8>,
    turned: Vec<f64>,
}

impl Maker {
    /// The bytes of a chunk of rows that lie one behind the other, each of them time and one value per kind.
    pub fn make(&mut self, base: u32, rows: &[f64], kinds: &[Kind]) -> &[u8] {
        let width = kinds.len() + 1;
        let count = rows.len() / width;
        let data = HEAD + width * ENTRY;
        self.bytes.clear();
        self.bytes.resize(data, 0);
        for from in (0..width).step_by(ABREAST) {
            let abreast = ABREAST.min(width - from);
            self.turned.resize(abreast * count, 0.0);
            for (at, row) in rows.chunks_exact(width).enumerate() {
                for (column, &value) in row[from..from + abreast].iter().enumerate() {
                    self.turned[column * count + at] = value;
                }
            }
            for (at, values) in self.turned.chunks_exact(count.max(1)).enumerate() {
                let column = from + at;
                let kind = if column == 0 { Kind::Real } else { kinds[column - 1] };
                let start = self.bytes.len();
                let form = column::encode(values, kind, &mut self.bytes);
                let written = &self.bytes[start..];
                let entry = [form, written.len() as u32, crc32fast::hash(written)];
                let place = HEAD + column * ENTRY;
                for (bytes, number) in self.bytes[place..place + ENTRY].chunks_exact_mut(4).zip(entry) {
                    bytes.copy_from_slice(&number.to_le_bytes());
                }
            }
        }
        let length = (self.bytes.len() - data) as u64;
        let last = rows.len() - width;
        let mut head = Vec::with_capacity(HEAD);
        head.extend(TAG);
        for number in [base, count as u32, width as u32] {
            head.extend(number.to_le_bytes());
        }
        head.extend(length.to_le_bytes());
        head.extend(rows[0].to_le_bytes());
        head.extend(rows[last].to_le_bytes());
        head.extend([0; 4]);
        self.bytes[..44].copy_from_slice(&head);
        let sum = sum(&head, &self.bytes[HEAD..data]);
        self.bytes[44..HEAD].copy_from_slice(&sum.to_le_bytes());
        &self.bytes
    }
}
