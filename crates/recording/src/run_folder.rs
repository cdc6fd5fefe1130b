//! The folder of one run.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::clock::iso_for_file_names;
use crate::csv_write::{write_events, write_signals};
use crate::error::ResultsError;
use crate::manifest::Manifest;
use crate::place::{numbered, write_whole};
use crate::recording::{EventRow, Recording};
use crate::run::STORE;
use crate::store::{Layout, Stream};

/// Longest run name kept; the file systems allow 255 bytes for the whole.
const NAME_LENGTH: usize = 80;

/// A run being written. Until [`RunFolder::finish`] its folder bears the suffix `.partial`; when it is
/// dropped before, for example because a file could not be written, the partial folder is removed, unless a
/// recording was begun in it.
///
/// Never overwrites a folder.
#[derive(Debug)]
pub struct RunFolder {
    partial: PathBuf,
    parent: PathBuf,
    /// Name of the finished folder.
    name: String,
    /// Whether another name may be taken where this one is in use.
    free_to_number: bool,
    /// Whether the folder stays when this is dropped.
    stays: bool,
}

impl RunFolder {
    /// Begins a run in `parent`, in a folder named after the present time in UTC and `name`:
    /// `2026-11-21T14-03-22_pick`. Where this exists, `-2`, `-3` … is added. Signs other than letters,
    /// digits, `_` and `-` become `-`.
    ///
    /// # Errors
    ///
    /// [`ResultsError`] where the folder cannot be created.
    pub fn create(parent: &Path, name: &str) -> Result<RunFolder, ResultsError> {
        RunFolder::create_at_time(parent, name, SystemTime::now())
    }

    /// As [`RunFolder::create`], with the time of the start given.
    ///
    /// # Errors
    ///
    /// [`ResultsError`] where the folder cannot be created.
    pub fn create_at_time(parent: &Path, name: &str, start: SystemTime) -> Result<RunFolder, ResultsError> {
        let name = format!("{}_{}", iso_for_file_names(start), sanitised(name));
        fs::create_dir_all(parent).map_err(|error| ResultsError::io("create", parent, error))?;
        let free = |name: &String| !parent.join(name).exists();
        begin(parent, numbered(&name).filter(free), None)
    }

    /// Begins a run that will be exactly `folder`, which must be missing or empty.
    ///
    /// # Errors
    ///
    /// [`ResultsError::FolderInUse`] if it holds anything, others where it cannot be created.
    pub fn create_exactly(folder: &Path) -> Result<RunFolder, ResultsError> {
        let no_name = || ResultsError::NoFolderName { path: folder.to_owned() };
        let absolute = match fs::canonicalize(folder) {
            Ok(existing) => {
                refuse_unless_empty(folder)?;
                existing
            }
            Err(_) => std::path::absolute(folder).map_err(|_| no_name())?,
        };
        let name = absolute.file_name().ok_or_else(no_name)?.to_string_lossy().into_owned();
        let parent = absolute.parent().ok_or_else(no_name)?;
        fs::create_dir_all(parent).map_err(|error| ResultsError::io("create", parent, error))?;
        begin(parent, numbered(&name), Some(name.clone()))
    }

    /// Where the run will be once finished; with [`RunFolder::create`] a number may still be added if
    /// another run takes the name first.
    pub fn path(&self) -> PathBuf {
        self.parent.join(&self.name)
    }

    /// Where the run is until it is finished.
    pub fn partial_path(&self) -> &Path {
        &self.partial
    }

    /// Begins to record into `signals.rec`; see [`Stream::begin`]. From now on the folder stays, whatever happens: what
    /// was recorded can be read.
    ///
    /// # Errors
    ///
    /// As [`Stream::begin`].
    pub fn record(
        &mut self,
        layout: &Layout,
        sources: &[usize],
        width: usize,
    ) -> Result<Stream, ResultsError> {
        let stream = Stream::begin(&self.partial.join(STORE), layout, sources, width)?;
        self.stays = true;
        Ok(stream)
    }

    /// Writes a file of the run, whole or not at all.
    ///
    /// # Errors
    ///
    /// [`ResultsError`] with the path and the reason.
    pub fn write(
        &self,
        name: &str,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), ResultsError> {
        write_whole(&self.partial, name, |out| content(out)).map(|_| ())
    }

    /// Writes `signals.csv`.
    ///
    /// # Errors
    ///
    /// As [`RunFolder::write`].
    pub fn write_signals(&self, recording: &Recording) -> Result<(), ResultsError> {
        self.write("signals.csv", |w| write_signals(w, recording))
    }

    /// Writes `events.csv`.
    ///
    /// # Errors
    ///
    /// As [`RunFolder::write`].
    pub fn write_events(&self, events: &[EventRow]) -> Result<(), ResultsError> {
        self.write("events.csv", |w| write_events(w, events))
    }

    /// Writes `log.txt`, one line per entry.
    ///
    /// # Errors
    ///
    /// As [`RunFolder::write`].
    pub fn write_log(&self, lines: &[String]) -> Result<(), ResultsError> {
        self.write("log.txt", |w| lines.iter().try_for_each(|line| writeln!(w, "{line}")))
    }

    /// Writes `manifest.json`.
    ///
    /// # Errors
    ///
    /// As [`RunFolder::write`].
    pub fn write_manifest(&self, manifest: &Manifest) -> Result<(), ResultsError> {
        self.write("manifest.json", |w| w.write_all(manifest.to_json()?.as_bytes()))
    }

    /// Removes the folder with all that was written, as nobody wants the run.
    pub fn discard(mut self) {
        self.stays = false;
    }

    /// Gives the folder its name; returns its path.
    ///
    /// # Errors
    ///
    /// [`ResultsError`] where the folder asked for was filled meanwhile or cannot be renamed.
    pub fn finish(mut self) -> Result<PathBuf, ResultsError> {
        let mut target = self.path();
        if self.free_to_number {
            let free = numbered(&self.name).map(|name| self.parent.join(name)).find(|path| !path.exists());
            target = free.unwrap_or(target);
        } else if target.exists() {
            refuse_unless_empty(&target)?;
            fs::remove_dir(&target).map_err(|error| ResultsError::io("replace", &target, error))?;
        }
        fs::rename(&self.partial, &target).map_err(|error| ResultsError::io("create", &target, error))?;
        self.stays = true;
        Ok(target)
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        if !self.stays {
            // Nobody is left to tell; whatever remains says by its suffix that it is not a run.
            let _ = fs::remove_dir_all(&self.partial);
        }
    }
}

/// Creates `<name>.partial` for the first name for which this is possible. `exactly` is the final name where
/// that is not free to choose.
fn begin(
    parent: &Path,
    names: impl Iterator<Item = String>,
    exactly: Option<String>,
) -> Result<RunFolder, ResultsError> {
    for name in names {
        let partial = parent.join(format!("{name}.partial"));
        match fs::create_dir(&partial) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(ResultsError::io("create", &partial, error)),
            Ok(()) => {
                let free_to_number = exactly.is_none();
                let name = exactly.unwrap_or(name);
                return Ok(RunFolder {
                    partial,
                    parent: parent.to_owned(),
                    name,
                    free_to_number,
                    stays: false,
                });
            }
        }
    }
    Err(ResultsError::FolderInUse { path: parent.to_owned() })
}

fn refuse_unless_empty(folder: &Path) -> Result<(), ResultsError> {
    let mut entries = fs::read_dir(folder).map_err(|error| ResultsError::io("write into", folder, error))?;
    match entries.next() {
        None => Ok(()),
        Some(_) => Err(ResultsError::FolderInUse { path: folder.to_owned() }),
    }
}

/// Letters, digits, `_` and `-` of a name; `run` where nothing is left.
fn sanitised(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
    let name: String = name.chars().take(NAME_LENGTH).map(plain).collect();
    let name = name.trim_matches('-');
    (if name.is_empty() { "run" } else { name }).to_owned()
}

#[cfg(test)]
#[path = "run_folder_tests.rs"]
mod tests;
