//! A run that was kept, opened for reading: what was recorded, what happened, and how it came about.

mod read;

use std::fs;
use std::io::BufReader;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use crate::csv::{ReadLimits, read_csv_file, read_events};
use crate::error::ResultsError;
use crate::manifest::{Ended, Manifest};
use crate::recording::{EventRow, Recording};
use crate::regular::{MOST_TEXT, limited_text, open_regular};
use crate::store::{Layout, Rate, SignalInfo, Store};

/// All times.
pub const ALWAYS: RangeInclusive<f64> = f64::NEG_INFINITY..=f64::INFINITY;

/// Name of the recording in the folder of a run.
pub const STORE: &str = "signals.rec";

/// A run for reading: the folder of one, its recording alone, or any table whose first column is `time [s]`.
///
/// Opening reads names and units; values are read when they are asked for. (A table is read at once.)
///
/// ```no_run
/// use blocksim_recording::{ALWAYS, Run};
///
/// let run = Run::open("runs/2026-11-21T14-03-22_servo".as_ref())?;
/// let angle = run.find("servo/angle.actual")?;
/// let column = run.read(angle, &ALWAYS)?;
/// println!("{} values in {}", column.values.len(), run.signals()[angle].unit);
/// # Ok::<(), blocksim_recording::ResultsError>(())
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
        Run::of_layout(recording, layout, path)
    }

    /// The same with a layout of these signals, which knows more of them than the recording.
    pub fn of_layout(recording: Recording, layout: Layout, path: &Path) -> Run {
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

    /// What happened, by time; nothing for a file alone.
    ///
    /// # Errors
    /// [`ResultsError`] where `events.csv` cannot be read.
    pub fn events(&self) -> Result<Vec<EventRow>, ResultsError> {
        let Some(path) = &self.events else { return Ok(Vec::new()) };
        let file = open_regular(path).map_err(|error| ResultsError::io("read", path, error))?;
        read_events(BufReader::new(file), ReadLimits::default())
            .map_err(|source| ResultsError::Csv { path: path.clone(), source })
    }

    fn layout(&self) -> &Layout {
        match &self.source {
            Source::Store(store) => store.layout(),
            Source::Table { layout, .. } => layout,
        }
    }
}

fn table(path: &Path) -> Result<Source, ResultsError> {
    let recording = read_csv_file(path)?;
    let layout = Layout::of(&recording);
    Ok(Source::Table { recording, layout })
}

/// The manifest of a run, if there is one, or why it cannot be read. Signals do not need it.
fn manifest(folder: &Path) -> (Option<Manifest>, Option<String>) {
    let text = match limited_text(&folder.join("manifest.json"), MOST_TEXT) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return (None, None),
        Err(error) => return (None, Some(error.to_string())),
        Ok(text) => text,
    };
    match Manifest::from_json(&text) {
        Ok(manifest) => (Some(manifest), None),
        Err(error) => (None, Some(error.to_string())),
    }
}
