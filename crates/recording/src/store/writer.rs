//! Writes recordings.

use std::io::{self, Write};

use super::chunk::Maker;
use super::index::{self, Place};
use super::layout::Layout;
use super::marks::{MAGIC, MOST_ROWS, VERSION};
use crate::recording::{Kind, Recording};

/// Bytes of rows that make a chunk.
const CHUNK: usize = 4 << 20;

/// Writes a recording chunk by chunk. What was handed over before something failed can be read back.
#[derive(Debug)]
pub struct StoreWriter<W: Write> {
    out: W,
    offset: u64,
    places: Vec<Place>,
    /// Kinds of the signals of each time base.
    kinds: Vec<Vec<Kind>>,
    maker: Maker,
}

impl<W: Write> StoreWriter<W> {
    /// Writes the header.
    ///
    /// # Errors
    /// What the destination answers; `InvalidInput` if a signal has no time base.
    pub fn new(mut out: W, layout: &Layout) -> io::Result<StoreWriter<W>> {
        if let Some(mistake) = layout.mistake() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, mistake));
        }
        let header = serde_json::to_vec(layout)?;
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((header.len() as u32).to_le_bytes());
        bytes.extend(crc32fast::hash(&header).to_le_bytes());
        bytes.extend(header);
        out.write_all(&bytes)?;
        let kinds_of = |base| layout.of_base(base).map(|at| layout.signals[at].kind).collect();
        let kinds = (0..layout.rates.len()).map(kinds_of).collect();
        Ok(StoreWriter {
            out,
            offset: bytes.len() as u64,
            places: Vec::new(),
            kinds,
            maker: Maker::default(),
        })
    }

    /// Values, times included, of the rows of a time base that make a chunk of a good size: few enough that there is
    /// memory for one of each base.
    pub fn chunk_values(&self, base: usize) -> usize {
        let width = self.kinds.get(base).map_or(1, |kinds| kinds.len() + 1);
        (CHUNK / 8 / width / self.kinds.len().max(1)).clamp(64, 1 << 16) * width
    }

    /// Writes rows of a time base: time and the values of its signals, row behind row.
    ///
    /// # Errors
    /// What the destination answers; `InvalidInput` for a time base that is not there or rows that are not whole.
    pub fn write(&mut self, base: usize, rows: &[f64]) -> io::Result<()> {
        let invalid = || io::Error::new(io::ErrorKind::InvalidInput, "rows do not fit the recording");
        let kinds = self.kinds.get(base).ok_or_else(invalid)?;
        let width = kinds.len() + 1;
        if !rows.len().is_multiple_of(width) {
            return Err(invalid());
        }
        for rows in rows.chunks(width * MOST_ROWS as usize) {
            let bytes = self.maker.make(base as u32, rows, kinds);
            self.out.write_all(bytes)?;
            self.places.push(Place {
                offset: self.offset,
                base: base as u32,
                rows: (rows.len() / width) as u32,
                first: rows[0],
                last: rows[rows.len() - width],
            });
            self.offset += bytes.len() as u64;
        }
        Ok(())
    }

    /// Bytes of header and chunks that were written whole.
    pub fn written(&self) -> u64 {
        self.offset
    }

    /// Writes the index, which says that nothing is missing.
    ///
    /// # Errors
    /// What the destination answers.
    pub fn close(&mut self) -> io::Result<()> {
        self.out.write_all(&index::write(&self.places, self.offset))?;
        self.out.flush()
    }

    /// The destination.
    pub fn into_inner(self) -> W {
        self.out
    }
}

/// Writes a recording that is in memory. The layout must have its signals in the same order, all with all rows.
///
/// # Errors
/// What the destination answers; `InvalidInput` where layout and recording do not fit.
pub fn write_store<W: Write>(out: W, layout: &Layout, recording: &Recording) -> io::Result<W> {
    let whole = recording.signals.iter().all(|signal| signal.values.len() == recording.rows());
    if layout.rates.len() != 1 || layout.signals.len() != recording.signals.len() || !whole {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the layout is of another recording"));
    }
    let mut writer = StoreWriter::new(out, layout)?;
    let most = writer.chunk_values(0);
    let mut rows = Vec::new();
    for (at, &time) in recording.time.iter().enumerate() {
        rows.push(time);
        rows.extend(recording.signals.iter().map(|signal| signal.values[at]));
        if rows.len() >= most {
            writer.write(0, &rows)?;
            rows.clear();
        }
    }
    writer.write(0, &rows)?;
    writer.close()?;
    Ok(writer.into_inner())
}
