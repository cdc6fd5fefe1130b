//! Texts as the editor has them, which come before those on the disk.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use blocksim_block::CodePolicy;
use blocksim_diagram::Reader;

/// Largest file that is read.
const LARGEST: u64 = 64 << 20;

/// An open file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Document {
    /// Its text.
    pub text: Arc<str>,
    /// The number that the editor gives to this state of it.
    pub version: i32,
}

/// Open files.
pub type Open = BTreeMap<PathBuf, Document>;

/// Open files as they were when work began, and whether that is still wanted.
#[derive(Debug, Clone)]
pub struct Snapshot {
    /// The files.
    pub open: Arc<Open>,
    /// Its number.
    pub number: u64,
    /// The number of the newest one.
    pub newest: Arc<AtomicU64>,
}

impl Snapshot {
    /// Whether texts have changed since.
    pub fn is_stale(&self) -> bool {
        self.newest.load(Ordering::Relaxed) != self.number
    }
}

/// A text with the time and the length of its file.
type Kept = (SystemTime, u64, Arc<str>);

/// Files on the disk that have been read, which are read again only when their time or length changes.
#[derive(Debug, Default)]
pub struct Disk {
    kept: RefCell<HashMap<PathBuf, Kept>>,
    reads: Cell<usize>,
}

impl Disk {
    /// How many files have been read so far.
    #[cfg(test)]
    pub fn reads(&self) -> usize {
        self.reads.get()
    }

    /// Text of a file.
    ///
    /// # Errors
    /// A sentence why it cannot be read.
    pub fn read(&self, path: &Path) -> Result<Arc<str>, String> {
        let about = std::fs::metadata(path).map_err(|error| error.to_string())?;
        if !about.is_file() || about.len() > LARGEST {
            return Err("it is not a text file".to_owned());
        }
        let time = about.modified().unwrap_or(SystemTime::UNIX_EPOCH);
        if let Some((known, length, text)) = self.kept.borrow().get(path)
            && (*known, *length) == (time, about.len())
        {
            return Ok(text.clone());
        }
        self.reads.set(self.reads.get() + 1);
        let text: Arc<str> = std::fs::read_to_string(path).map_err(|error| error.to_string())?.into();
        self.kept.borrow_mut().insert(path.to_owned(), (time, about.len(), text.clone()));
        Ok(text)
    }
}

/// The texts of a model: those given instead of others, those of the editor, those of the disk.
pub struct Texts<'a> {
    /// Texts that somebody thinks of writing.
    pub instead: BTreeMap<PathBuf, String>,
    /// Texts of the editor.
    pub snapshot: &'a Snapshot,
    /// Texts of the disk.
    pub disk: &'a Disk,
    /// Decides whether plug-ins that the texts name are built and loaded.
    pub code: &'a dyn CodePolicy,
    /// Whether the answer is wanted although texts have changed since.
    pub is_patient: bool,
    /// Files that could not be read.
    pub missing: RefCell<Vec<PathBuf>>,
}

impl<'a> Texts<'a> {
    /// Texts of the editor and of the disk.
    pub fn new(snapshot: &'a Snapshot, disk: &'a Disk, code: &'a dyn CodePolicy) -> Self {
        Self {
            instead: BTreeMap::new(),
            snapshot,
            disk,
            code,
            is_patient: false,
            missing: RefCell::default(),
        }
    }

    /// Text of a file.
    ///
    /// # Errors
    /// A sentence why it cannot be read.
    pub fn text(&self, path: &Path) -> Result<Arc<str>, String> {
        match self.snapshot.open.get(path) {
            Some(document) => Ok(document.text.clone()),
            None => self.disk.read(path),
        }
    }
}

impl Reader for Texts<'_> {
    fn read(&self, path: &Path) -> Result<String, String> {
        if let Some(text) = self.instead.get(path) {
            return Ok(text.clone());
        }
        let text = self.text(path).map(|text| text.to_string());
        if text.is_err() {
            self.missing.borrow_mut().push(path.to_owned());
        }
        text
    }

    fn code(&self) -> &dyn CodePolicy {
        self.code
    }

    fn is_cancelled(&self) -> bool {
        !self.is_patient && self.snapshot.is_stale()
    }
}
