//! Reads recordings: the header and the index when a file is opened, else only what is asked for.

use std::fs::File;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::bytes::u32_at;
use super::index::Place;
use super::layout::Layout;
use super::marks::{MAGIC, VERSION};
use super::pick::{Failed, bytes_at, read_columns};
use super::places::{closing_index, scan};
use crate::error::ResultsError;
use crate::regular::open_regular;

/// Bytes before the header.
const PREFIX: usize = 20;

/// Who takes rows: times, and the values of each signal.
pub type Take<'a> = &'a mut dyn FnMut(&[f64], &[Vec<f64>]) -> Result<(), ResultsError>;

/// A recording on disk.
#[derive(Debug)]
pub struct Store {
    path: PathBuf,
    file: Mutex<File>,
    layout: Layout,
    /// Column of each signal in the chunks of its time base.
    columns: Vec<usize>,
    /// Chunks of each time base, by time.
    chunks: Vec<Vec<Place>>,
    /// Columns of each time base, time included.
    widths: Vec<usize>,
    /// Bytes of the file when it was opened.
    length: u64,
    is_whole: bool,
}

impl Store {
    /// Opens a recording. One that was not closed, because the program that wrote it was ended, is read up to
    /// its last whole chunk.
    ///
    /// # Errors
    /// [`ResultsError`] where the file cannot be read, is no recording, has another version or is damaged.
    pub fn open(path: &Path) -> Result<Store, ResultsError> {
        let file = open_regular(path).map_err(|error| ResultsError::io("read", path, error))?;
        Store::of_file(file, path)
    }

    /// As [`Store::open`] for a file that is open for reading; `path` is what messages call it.
    ///
    /// # Errors
    /// As [`Store::open`].
    pub fn of_file(mut file: File, path: &Path) -> Result<Store, ResultsError> {
        let io = |error| ResultsError::io("read", path, error);
        let damaged = |problem: &str| ResultsError::damaged(path, problem);
        let length = file.metadata().map_err(io)?.len();
        let prefix = bytes_at(&mut file, 0, length.min(PREFIX as u64) as usize).map_err(io)?;
        if prefix.len() < PREFIX || prefix[..8] != MAGIC {
            return Err(damaged("it is not a recording of blocksim, or only the first bytes of one"));
        }
        let version = u32_at(&prefix, 8);
        if !(1..=VERSION).contains(&version) {
            return Err(damaged(&format!(
                "it is a recording of version {version}; this program reads versions 1 to {VERSION}"
            )));
        }
        let header_length = u32_at(&prefix, 12);
        let start = PREFIX as u64 + u64::from(header_length);
        if start > length {
            return Err(damaged("it ends within its header"));
        }
        let header = bytes_at(&mut file, PREFIX as u64, header_length as usize).map_err(io)?;
        if crc32fast::hash(&header) != u32_at(&prefix, 16) {
            return Err(damaged("its header is damaged"));
        }
        let layout: Layout = serde_json::from_slice(&header)
            .map_err(|error| damaged(&format!("its header cannot be understood: {error}")))?;
        if let Some(mistake) = layout.mistake() {
            return Err(damaged(&mistake));
        }
        let widths: Vec<usize> =
            (0..layout.rates.len()).map(|base| 1 + layout.of_base(base).count()).collect();
        let (places, is_whole) = match closing_index(&mut file, length, start, &widths).map_err(io)? {
            Some(places) => (places, true),
            None => (scan(&mut file, length, start, &widths).map_err(io)?, false),
        };
        let mut chunks = vec![Vec::new(); layout.rates.len()];
        for place in places {
            chunks[place.base as usize].push(place);
        }
        let mut next = vec![1; layout.rates.len()];
        let columns = layout.signals.iter().map(|signal| {
            next[signal.base] += 1;
            next[signal.base] - 1
        });
        let columns = columns.collect();
        Ok(Store {
            path: path.to_owned(),
            file: Mutex::new(file),
            layout,
            columns,
            chunks,
            widths,
            length,
            is_whole,
        })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Signals and time bases.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Whether the file was closed by the program that wrote it.
    pub fn is_whole(&self) -> bool {
        self.is_whole
    }

    /// Rows of a time base.
    pub fn rows(&self, base: usize) -> u64 {
        self.chunks.get(base).into_iter().flatten().map(|place| u64::from(place.rows)).sum()
    }

    /// Times of the first and the last row of a time base, s.
    pub fn span(&self, base: usize) -> Option<(f64, f64)> {
        let chunks = self.chunks.get(base)?;
        Some((chunks.first()?.first, chunks.last()?.last))
    }

    /// Rows of the chunks that a range of time touches: at least as many as there are within it.
    pub fn rows_about(&self, base: usize, range: &RangeInclusive<f64>) -> u64 {
        self.touched(base, range).map(|place| u64::from(place.rows)).sum()
    }

    /// A range of time widened so that it has rows before its beginning and behind its end, if there are any.
    pub fn around(&self, base: usize, range: &RangeInclusive<f64>) -> RangeInclusive<f64> {
        let chunks = self.chunks.get(base).map_or(&[][..], Vec::as_slice);
        let before = chunks.iter().rposition(|place| place.first < *range.start());
        let behind = chunks.iter().position(|place| place.last > *range.end());
        // Of the next chunk there may be one row alone; a curve needs more.
        let from = before.and_then(|at| chunks.get(at.saturating_sub(1)));
        let to = behind.and_then(|at| chunks.get(at + 1).or(chunks.get(at)));
        from.map_or(*range.start(), |place| place.first)..=to.map_or(*range.end(), |place| place.last)
    }

    fn touched<'a>(
        &'a self,
        base: usize,
        range: &'a RangeInclusive<f64>,
    ) -> impl Iterator<Item = &'a Place> + 'a {
        let chunks = self.chunks.get(base).into_iter().flatten();
        chunks.filter(|place| place.last >= *range.start() && place.first <= *range.end())
    }

    /// Hands the rows of a time base within a range of time to `take`, some thousands at a time: times, and the
    /// values of each of the signals (positions in the layout; those of other time bases are not allowed).
    ///
    /// # Errors
    /// [`ResultsError`] where the file cannot be read or is damaged, and whatever `take` answers.
    pub fn blocks(
        &self,
        base: usize,
        signals: &[usize],
        range: &RangeInclusive<f64>,
        take: Take,
    ) -> Result<(), ResultsError> {
        if let Some(&odd) =
            signals.iter().find(|&&at| self.layout.signals.get(at).is_none_or(|s| s.base != base))
        {
            return Err(ResultsError::damaged(
                &self.path,
                &format!("it has no signal {odd} on this time base"),
            ));
        }
        let mut wanted = vec![0];
        wanted.extend(signals.iter().map(|&at| self.columns[at]));
        let mut columns = vec![Vec::new(); wanted.len()];
        for place in self.touched(base, range) {
            let read = {
                let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
                read_columns(&mut file, (self.length, self.widths[base]), place, &wanted, &mut columns)
            };
            read.map_err(|error| match error {
                Failed::Disk(error) => ResultsError::io("read", &self.path, error),
                Failed::Damaged => {
                    let (first, last) = (place.first, place.last);
                    let at = place.offset;
                    ResultsError::damaged(
                        &self.path,
                        &format!(
                            "it is damaged at byte {at}, from t = {first} s to {last} s; what is before and behind can be read"
                        ),
                    )
                }
            })?;
            let times = &columns[0];
            let from = times.partition_point(|&t| t < *range.start());
            let to = times.partition_point(|&t| t <= *range.end());
            if from == 0 && to == times.len() {
                take(&columns[0], &columns[1..])?;
            } else if from < to {
                columns.iter_mut().for_each(|column| {
                    column.truncate(to);
                    column.drain(..from);
                });
                take(&columns[0], &columns[1..])?;
            }
        }
        Ok(())
    }
}
