//! Recording while a run goes: the run only copies its rows; a thread of its own turns and writes them.

use std::fs::{File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::layout::{Layout, Rate};
use super::sieve::Sieve;
use super::writer::StoreWriter;
use crate::error::{RecordingError, ResultsError};

/// Bytes of rows that are handed over at once.
const BATCH: usize = 4 << 20;
/// Batches on their way; with the one being filled and the one being written, all the memory that is taken.
const ON_THE_WAY: usize = 1;
/// What was not written for so long is written though it makes a small chunk: so little is lost by force.
const PATIENCE: Duration = Duration::from_secs(2);

/// A recording that is being written. Takes memory for a few batches of rows, however long the run is.
#[derive(Debug)]
pub struct Stream {
    path: PathBuf,
    width: usize,
    batch: Vec<f64>,
    full: usize,
    last: f64,
    rows: u64,
    flushed: Instant,
    batches: SyncSender<(Vec<f64>, bool)>,
    empties: Receiver<Vec<f64>>,
    has_failed: Arc<AtomicBool>,
    writer: JoinHandle<(File, io::Result<()>)>,
}

impl Stream {
    /// Begins a recording in a new file. `sources` says for each signal of the layout which value of a row it is, `width`
    /// how many values a row has.
    ///
    /// # Errors
    /// [`ResultsError`] where the file exists or cannot be written, or where the layout is not sound.
    pub fn begin(
        path: &Path,
        layout: &Layout,
        sources: &[usize],
        width: usize,
    ) -> Result<Stream, ResultsError> {
        let refused = |error| ResultsError::io("write", path, error);
        let is_sound = sources.len() == layout.signals.len() && sources.iter().all(|&source| source < width);
        let alone = |(base, rate): (usize, &Rate)| {
            !matches!(rate, Rate::Extremes(_)) || layout.of_base(base).count() == 1
        };
        if !is_sound || !layout.rates.iter().enumerate().all(alone) {
            return Err(refused(io::Error::new(
                io::ErrorKind::InvalidInput,
                "the layout does not fit the rows",
            )));
        }
        let file = OpenOptions::new().read(true).write(true).create_new(true).open(path).map_err(refused)?;
        let writer = StoreWriter::new(file, layout).map_err(refused)?;
        let sieve = |base| {
            let columns = layout.of_base(base).map(|at| sources[at]).collect();
            Sieve::new(layout.rates[base], columns, width)
        };
        let sieves = (0..layout.rates.len()).map(sieve).collect();
        let (batches, to_write) = sync_channel(ON_THE_WAY);
        let (written, empties) = channel();
        let has_failed = Arc::new(AtomicBool::new(false));
        let failed = Arc::clone(&has_failed);
        let work = move || write(writer, sieves, width, to_write, &written, &failed);
        let writer = thread::Builder::new().name("recorder".to_owned()).spawn(work).map_err(refused)?;
        let full = (BATCH / 8 / (width + 1)).max(64) * (width + 1);
        Ok(Stream {
            path: path.to_owned(),
            width,
            batch: Vec::with_capacity(full),
            full,
            last: f64::NEG_INFINITY,
            rows: 0,
            flushed: Instant::now(),
            batches,
            empties,
            has_failed,
            writer,
        })
    }

    /// Takes a row of the run. Waits where the disk is slower than the run.
    ///
    /// # Errors
    /// [`RecordingError`] for a row of another width or with a time before the last; it is not recorded then.
    pub fn row(&mut self, time: f64, values: &[f64]) -> Result<(), RecordingError> {
        if values.len() != self.width {
            return Err(RecordingError::RowLength { signals: self.width, values: values.len() });
        }
        let ordered = time >= self.last;
        if !ordered {
            return Err(RecordingError::TimeOrder { last: self.last, time });
        }
        self.last = time;
        self.rows += 1;
        self.batch.push(time);
        self.batch.extend_from_slice(values);
        if self.batch.len() >= self.full {
            self.hand_over(false);
        }
        Ok(())
    }

    /// To be called now and then: sees to it that no row waits long to be written.
    pub fn tend(&mut self) {
        if self.flushed.elapsed() >= PATIENCE {
            self.flushed = Instant::now();
            self.hand_over(true);
        }
    }

    /// Whether the disk has refused a row. All further ones are lost.
    pub fn has_failed(&self) -> bool {
        self.has_failed.load(Ordering::Relaxed)
    }

    /// Rows taken.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    fn hand_over(&mut self, flush: bool) {
        let empty = self.empties.try_recv().unwrap_or_else(|_| Vec::with_capacity(self.full));
        let batch = std::mem::replace(&mut self.batch, empty);
        // The writer takes batches until there are no more.
        let _ = self.batches.send((batch, flush));
    }

    /// Writes the rest and closes the file; gives the file for reading, and why it is not whole if it is not. What was
    /// written before a failure can be read.
    pub fn finish(mut self) -> (File, Option<ResultsError>) {
        self.hand_over(true);
        drop(self.batches);
        match self.writer.join() {
            Ok((file, outcome)) => {
                (file, outcome.err().map(|error| ResultsError::io("write", &self.path, error)))
            }
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// The thread of the recording.
fn write(
    mut writer: StoreWriter<File>,
    mut sieves: Vec<Sieve>,
    width: usize,
    batches: Receiver<(Vec<f64>, bool)>,
    written: &std::sync::mpsc::Sender<Vec<f64>>,
    has_failed: &AtomicBool,
) -> (File, io::Result<()>) {
    let mut outcome = Ok(());
    for (mut batch, flush) in batches {
        if outcome.is_ok() {
            outcome = take(&mut writer, &mut sieves, width, &batch, flush);
            has_failed.store(outcome.is_err(), Ordering::Relaxed);
        }
        batch.clear();
        let _ = written.send(batch);
    }
    if outcome.is_ok() {
        sieves.iter_mut().for_each(Sieve::end);
        outcome = take(&mut writer, &mut sieves, width, &[], true);
    }
    let whole = writer.written();
    match outcome.and_then(|()| writer.close()) {
        Ok(()) => {
            let file = writer.into_inner();
            // A disk may report only now that it is full.
            let synced = file.sync_all();
            (file, synced)
        }
        Err(error) => {
            let file = writer.into_inner();
            // A chunk that is there in part is passed over when it is read, so it may stay where it cannot be cut off.
            let _ = file.set_len(whole);
            (file, Err(error))
        }
    }
}

fn take(
    writer: &mut StoreWriter<File>,
    sieves: &mut [Sieve],
    width: usize,
    rows: &[f64],
    flush: bool,
) -> io::Result<()> {
    for (base, sieve) in sieves.iter_mut().enumerate() {
        if sieve.is_open() {
            writer.write(base, rows)?;
            continue;
        }
        rows.chunks_exact(width + 1).for_each(|row| sieve.see(row));
        if flush || sieve.picked.len() >= writer.chunk_values(base) {
            writer.write(base, &sieve.picked)?;
            sieve.picked.clear();
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::tests::Scratch;
    use crate::{ALWAYS, Kind, Run, SignalInfo, Store};

    fn layout(rates: &[Rate]) -> Layout {
        let signal = |base: usize| SignalInfo {
            path: format!("s{base}"),
            unit: "1".into(),
            kind: Kind::Real,
            base,
            ..SignalInfo::default()
        };
        Layout { rates: rates.to_vec(), signals: (0..rates.len()).map(signal).collect() }
    }

    #[test]
    fn rows_of_a_long_run_are_read_back_at_each_rate() {
        let scratch = Scratch::new();
        let path = scratch.0.join("signals.rec");
        let rates = [Rate::All, Rate::Nth(7), Rate::Every(0.5), Rate::Extremes(100.0)];
        let mut stream = Stream::begin(&path, &layout(&rates), &[3, 2, 1, 0], 4).unwrap();
        let rows = 300_000_u32;
        for k in 0..rows {
            let t = f64::from(k) * 1e-3;
            let value = f64::from(k);
            stream.row(t, &[if k == 123_456 { 9.0 } else { t.sin() }, value, 2.0 * value, -value]).unwrap();
            stream.tend();
        }
        assert!(stream.row(0.0, &[0.0; 4]).is_err() && stream.row(1e9, &[0.0]).is_err());
        assert_eq!((stream.rows(), stream.has_failed()), (300_000, false));
        let (file, failure) = stream.finish();
        assert!(failure.is_none());
        let run = Run::of(Store::of_file(file, &path).unwrap());
        let column = |signal: usize| run.read(signal, &ALWAYS).unwrap();
        assert!(column(0).values.iter().enumerate().all(|(k, &y)| y == -(k as f64)));
        assert_eq!(column(0).time.len(), 300_000);
        let nth = column(1).values;
        assert_eq!((nth.len(), nth[1], nth.last()), (42_858, 14.0, Some(&599_998.0)));
        assert_eq!(column(2).values[..3], [0.0, 500.0, 1000.0]);
        assert_eq!(column(2).values.len(), 601, "600 periods and the last row");
        let extremes = column(3);
        assert_eq!(extremes.time.len(), 6);
        assert!(extremes.values.contains(&9.0) && extremes.time.contains(&123.456));
        assert_eq!(run.shortfall(), None);
    }

    #[test]
    fn an_older_recording_is_not_overwritten_and_odd_layouts_are_refused() {
        let scratch = Scratch::new();
        let path = scratch.0.join("signals.rec");
        std::fs::write(&path, "precious").unwrap();
        let error = Stream::begin(&path, &layout(&[Rate::All]), &[0], 1).unwrap_err();
        assert_eq!(error.reason(), "a file of this name is in the way");
        assert_eq!(std::fs::read(&path).unwrap(), b"precious");
        let path = scratch.0.join("other.rec");
        assert!(Stream::begin(&path, &layout(&[Rate::All]), &[1], 1).is_err());
        assert!(Stream::begin(&path, &layout(&[Rate::All]), &[], 1).is_err());
    }

    #[test]
    fn a_run_without_rows_or_signals_is_closed_as_well() {
        let scratch = Scratch::new();
        for (name, rows) in [("none.rec", 0), ("one.rec", 1)] {
            let path = scratch.0.join(name);
            let empty = Layout { rates: vec![Rate::All], signals: Vec::new() };
            let mut stream = Stream::begin(&path, &empty, &[], 0).unwrap();
            (0..rows).for_each(|_| stream.row(0.0, &[]).unwrap());
            assert!(stream.finish().1.is_none());
            let store = Store::open(&path).unwrap();
            assert_eq!((store.rows(0), store.is_whole()), (rows, true));
        }
    }
}
