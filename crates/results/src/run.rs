//! A run that was kept, opened for reading: what was recorded, what happened, and how it came about.

use std::fs::{self, File};
use std::io::BufReader;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use crate::csv::{ReadLimits, read_csv_file, read_events};
use crate::error::ResultsError;
use crate::manifest::{Ended, Manifest};
use crate::recording::{EventRow, Recording};
use crate::store::{Layout, Rate, SignalInfo, Store, Take};

/// All times.
pub const ALWAYS: RangeInclusive<f64> = f64::NEG_INFINITY..=f64::INFINITY;

/// Name of the recording in the folder of a run.
pub const STORE: &str = "signals.rec";

/// Most rows that [`Run::read`] brings into memory.
const MOST_ROWS: u64 = 1 << 27;

/// Rows of a table in memory that are handed on at a time.
const BLOCK: usize = 1 << 16;

/// A signal over time, in SI units. Two values may share a time: those before and after an event.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Column {
    /// Times, s, never falling.
    pub time: Vec<f64>,
    /// As many values.
    pub values: Vec<f64>,
}

/// A run for reading: the folder of one, its recording alone, or any table whose first column is `time [s]`.
///
/// Opening reads names and units; values are read when they are asked for. (A table is read at once.)
///
/// ```no_run
/// use blocksim_results::{ALWAYS, Run};
///
/// let run = Run::open("runs/2026-11-21T14-03-22_servo".as_ref())?;
/// let angle = run.find("servo/angle.actual")?;
/// let column = run.read(angle, &ALWAYS)?;
/// println!("{} values in {}", column.values.len(), run.signals()[angle].unit);
/// # Ok::<(), blocksim_results::ResultsError>(())
/// ```
#[derive(Debug)]
pub struct Run {
    path: PathBuf,
    source: Source,
    manifest: Option<Manifest>,
    /// Why the manifest cannot be read.
    unread: Option<String>,
    events: Option<PathBuf>,
}

#[derive(Debug)]
enum Source {
    Store(Store),
    Table { recording: Recording, layout: Layout },
}

impl Run {
    /// Opens the folder of a run, a recording (`signals.rec`) or a table (any other file).
    ///
    /// # Errors
    /// [`ResultsError`] with the file and the reason.
    pub fn open(path: &Path) -> Result<Run, ResultsError> {
        let about = fs::metadata(path).map_err(|error| ResultsError::io("read", path, error))?;
        if !about.is_dir() {
            let source = if path.extension().is_some_and(|ending| ending == "rec") {
                Source::Store(Store::open(path)?)
            } else {
                table(path)?
            };
            return Ok(Run::alone(path, source));
        }
        let (store, csv) = (path.join(STORE), path.join("signals.csv"));
        let source = match (store.is_file(), csv.is_file()) {
            (true, _) => Source::Store(Store::open(&store)?),
            (_, true) => table(&csv)?,
            _ => return Err(ResultsError::NoRun { path: path.to_owned() }),
        };
        let events = Some(path.join("events.csv")).filter(|events| events.is_file());
        let (manifest, unread) = manifest(path);
        Ok(Run { manifest, unread, events, ..Run::alone(path, source) })
    }

    /// The run of a recording that is open.
    pub fn of(store: Store) -> Run {
        let path = store.path().to_owned();
        Run::alone(&path, Source::Store(store))
    }

    /// The run of a recording in memory, whose signals all have all rows; `path` is what messages call it.
    pub fn of_recording(recording: Recording, path: &Path) -> Run {
        let layout = Layout::of(&recording);
        Run::alone(path, Source::Table { recording, layout })
    }

    /// Signals of which nothing else is known.
    fn alone(path: &Path, source: Source) -> Run {
        Run { path: path.to_owned(), source, manifest: None, unread: None, events: None }
    }

    /// Folder or file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Name of folder or file, without the ending of a file.
    pub fn name(&self) -> String {
        let name = if self.path.is_dir() { self.path.file_name() } else { self.path.file_stem() };
        name.unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }

    /// What was run; none for a file alone, or where `manifest.json` is damaged, which [`Run::shortfall`] tells.
    pub fn manifest(&self) -> Option<&Manifest> {
        self.manifest.as_ref()
    }

    /// All signals. Their order is that of the recording; positions in it are how signals are named below.
    pub fn signals(&self) -> &[SignalInfo] {
        &self.layout().signals
    }

    /// The time bases; signals of the same one have the same times.
    pub fn rates(&self) -> &[Rate] {
        &self.layout().rates
    }

    /// Position of a signal.
    ///
    /// # Errors
    /// [`ResultsError::NoSignal`] with the path that is spelt most like it.
    pub fn find(&self, path: &str) -> Result<usize, ResultsError> {
        self.signals().iter().position(|signal| signal.path == path).ok_or_else(|| {
            let folded = path.to_lowercase();
            let alike = |signal: &&SignalInfo| {
                let known = signal.path.to_lowercase();
                known == folded || known.contains(&folded) || folded.contains(&known)
            };
            ResultsError::NoSignal {
                path: self.path.clone(),
                signal: path.to_owned(),
                likely: self.signals().iter().find(alike).map(|signal| signal.path.clone()),
            }
        })
    }

    /// Rows of a time base.
    pub fn rows(&self, base: usize) -> u64 {
        match &self.source {
            Source::Store(store) => store.rows(base),
            Source::Table { recording, .. } => recording.rows() as u64,
        }
    }

    /// Times of the first and the last row over all time bases, s; none for an empty run.
    pub fn span(&self) -> Option<(f64, f64)> {
        match &self.source {
            Source::Store(store) => {
                let spans = (0..self.rates().len()).filter_map(|base| store.span(base));
                spans.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            }
            Source::Table { recording, .. } => Some((*recording.time.first()?, *recording.time.last()?)),
        }
    }

    /// Why something is missing at the end, in words; none if the run came to its end and all of it is there.
    pub fn shortfall(&self) -> Option<String> {
        let is_closed = !matches!(&self.source, Source::Store(store) if !store.is_whole());
        match self.manifest.as_ref().map(|manifest| &manifest.ended) {
            Some(Ended::Stopped { reason }) => Some(format!("it was stopped: {reason}")),
            Some(Ended::Interrupted) => Some("it was interrupted".to_owned()),
            Some(Ended::Failed { reason }) => Some(format!("it failed: {reason}")),
            _ if !is_closed => {
                Some("its recording was not closed: the program still runs, or was ended by force".to_owned())
            }
            Some(Ended::Unfinished) => Some("it still runs, or was ended by force".to_owned()),
            Some(Ended::Complete) => None,
            None => self.unread.as_ref().map(|why| format!("its manifest cannot be read: {why}")),
        }
    }

    /// A signal within a range of time, bounds included. Reads nothing else.
    ///
    /// # Errors
    /// [`ResultsError`] where the file cannot be read, is damaged, or has more rows than fit into memory.
    pub fn read(&self, signal: usize, range: &RangeInclusive<f64>) -> Result<Column, ResultsError> {
        let base = self.base_of(signal)?;
        self.refuse_too_many(base, range, 1)?;
        let mut column = Column::default();
        self.blocks(base, &[signal], range, &mut |time, values| {
            column.time.extend(time);
            column.values.extend(&values[0]);
            Ok(())
        })?;
        Ok(column)
    }

    /// Several signals of one time base within a range of time.
    ///
    /// # Errors
    /// As [`Run::read`], and [`ResultsError::TwoRates`] if the signals are not of one time base.
    pub fn read_together(
        &self,
        signals: &[usize],
        range: &RangeInclusive<f64>,
    ) -> Result<Recording, ResultsError> {
        let Some(&first) = signals.first() else { return Ok(Recording::default()) };
        let base = self.base_of(first)?;
        for &signal in signals {
            if self.base_of(signal)? != base {
                let [a, b] = [first, signal].map(|at| self.signals()[at].path.clone());
                return Err(ResultsError::TwoRates { path: self.path.clone(), signals: [a, b] });
            }
        }
        self.refuse_too_many(base, range, signals.len())?;
        let empty = |&at: &usize| {
            let info = &self.signals()[at];
            crate::Signal::new(&info.path, &info.unit, info.kind)
        };
        let mut recording = Recording::new(signals.iter().map(empty).collect());
        self.blocks(base, signals, range, &mut |time, values| {
            recording.time.extend(time);
            for (signal, values) in recording.signals.iter_mut().zip(values) {
                signal.values.extend(values);
            }
            Ok(())
        })?;
        Ok(recording)
    }

    /// A signal within a range of time by about `points` of its values: all, where there are not more, else the
    /// least and the largest of each of equally long stretches of rows, at their times. Keeps `points` values in
    /// memory, however long the run is. Where there are others, values that are not finite are passed over.
    ///
    /// # Errors
    /// [`ResultsError`] where the file cannot be read or is damaged.
    pub fn overview(
        &self,
        signal: usize,
        range: &RangeInclusive<f64>,
        points: usize,
    ) -> Result<Column, ResultsError> {
        let base = self.base_of(signal)?;
        let rows = match &self.source {
            Source::Store(store) => store.rows_about(base, range),
            Source::Table { recording, .. } => {
                let before = |limit: f64| recording.time.partition_point(|&t| t < limit);
                let after = recording.time.partition_point(|&t| t <= *range.end());
                after.saturating_sub(before(*range.start())) as u64
            }
        };
        let mut extremes = crate::extremes::Extremes::new(rows, points);
        self.blocks(base, &[signal], range, &mut |time, values| {
            time.iter().zip(&values[0]).for_each(|(&t, &y)| extremes.push(t, y));
            Ok(())
        })?;
        Ok(extremes.finish())
    }

    /// Hands the rows of a time base within a range of time to `take`, some thousands at a time: times, and the
    /// values of each of the signals, which must be of this time base.
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
        for &signal in signals {
            self.base_of(signal)?;
        }
        match &self.source {
            Source::Store(store) => store.blocks(base, signals, range, take),
            Source::Table { recording, .. } => {
                let from = recording.time.partition_point(|&t| t < *range.start());
                let to = recording.time.partition_point(|&t| t <= *range.end()).max(from);
                for start in (from..to).step_by(BLOCK) {
                    let end = (start + BLOCK).min(to);
                    let part = |&at: &usize| recording.signals[at].values[start..end].to_vec();
                    let values: Vec<Vec<f64>> = signals.iter().map(part).collect();
                    take(&recording.time[start..end], &values)?;
                }
                Ok(())
            }
        }
    }

    /// What happened, by time; nothing for a file alone.
    ///
    /// # Errors
    /// [`ResultsError`] where `events.csv` cannot be read.
    pub fn events(&self) -> Result<Vec<EventRow>, ResultsError> {
        let Some(path) = &self.events else { return Ok(Vec::new()) };
        let file = File::open(path).map_err(|error| ResultsError::io("read", path, error))?;
        read_events(BufReader::new(file), ReadLimits::default())
            .map_err(|source| ResultsError::Csv { path: path.clone(), source })
    }

    fn layout(&self) -> &Layout {
        match &self.source {
            Source::Store(store) => store.layout(),
            Source::Table { layout, .. } => layout,
        }
    }

    fn base_of(&self, signal: usize) -> Result<usize, ResultsError> {
        let lost = || ResultsError::NoSignal {
            path: self.path.clone(),
            signal: format!("number {signal}"),
            likely: None,
        };
        self.signals().get(signal).map(|info| info.base).ok_or_else(lost)
    }

    fn refuse_too_many(
        &self,
        base: usize,
        range: &RangeInclusive<f64>,
        signals: usize,
    ) -> Result<(), ResultsError> {
        let Source::Store(store) = &self.source else { return Ok(()) };
        let values = store.rows_about(base, range).saturating_mul(signals as u64);
        if values <= MOST_ROWS {
            return Ok(());
        }
        Err(ResultsError::TooLong { path: self.path.clone(), values })
    }
}

fn table(path: &Path) -> Result<Source, ResultsError> {
    let recording = read_csv_file(path)?;
    let layout = Layout::of(&recording);
    Ok(Source::Table { recording, layout })
}

/// The manifest of a run, if there is one, or why it cannot be read. Signals do not need it.
fn manifest(folder: &Path) -> (Option<Manifest>, Option<String>) {
    let text = match fs::read_to_string(folder.join("manifest.json")) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return (None, None),
        Err(error) => return (None, Some(error.to_string())),
        Ok(text) => text,
    };
    match Manifest::from_json(&text) {
        Ok(manifest) => (Some(manifest), None),
        Err(error) => (None, Some(error.to_string())),
    }
}
