//! What can go wrong between memory and disk, in words for the person at the keyboard.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// A failure to write or read a run: where, why, and what helps.
#[derive(Debug)]
pub enum ResultsError {
    /// The folder asked for exists and holds files.
    FolderInUse {
        /// The folder.
        path: PathBuf,
    },
    /// The path asked for cannot name a folder, for example `/`.
    NoFolderName {
        /// The path.
        path: PathBuf,
    },
    /// The operating system refused.
    Io {
        /// File or folder concerned.
        path: PathBuf,
        /// What was attempted: `write`, `create`, `read` …
        doing: &'static str,
        /// Its answer.
        source: io::Error,
    },
    /// A CSV file does not hold what it should.
    Csv {
        /// The file.
        path: PathBuf,
        /// Line, column and problem.
        source: CsvError,
    },
}

impl ResultsError {
    /// An answer of the operating system about `path`.
    pub fn io(doing: &'static str, path: &Path, source: io::Error) -> ResultsError {
        ResultsError::Io { path: path.to_owned(), doing, source }
    }

    /// The file or folder concerned.
    pub fn place(&self) -> &Path {
        match self {
            ResultsError::FolderInUse { path }
            | ResultsError::NoFolderName { path }
            | ResultsError::Io { path, .. }
            | ResultsError::Csv { path, .. } => path,
        }
    }

    /// Whether the folder was there at the start of the run and is not any more.
    fn is_gone(&self) -> bool {
        let gone = io::ErrorKind::NotFound;
        matches!(self, ResultsError::Io { doing: "write", source, .. } if source.kind() == gone)
    }

    /// Why it failed, without the place.
    pub fn reason(&self) -> String {
        match self {
            ResultsError::FolderInUse { .. } => "it already holds files".to_owned(),
            ResultsError::NoFolderName { .. } => "this is no name for a new folder".to_owned(),
            _ if self.is_gone() => "its folder was removed during the run".to_owned(),
            ResultsError::Io { source, .. } => io_reason(source),
            ResultsError::Csv { source, .. } => source.to_string(),
        }
    }

    /// What to do about it.
    pub fn remedy(&self) -> &'static str {
        match self {
            ResultsError::FolderInUse { .. } => {
                "choose another folder with --out, or move the old run away; nothing is ever overwritten"
            }
            ResultsError::NoFolderName { .. } => "choose another folder with --out",
            _ if self.is_gone() => "run it again, with --out in a place that nothing clears away",
            ResultsError::Io { source, .. } => io_remedy(source),
            ResultsError::Csv { .. } => "correct the file, or export it again",
        }
    }
}

fn io_reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        io::ErrorKind::QuotaExceeded => "your share of the disk is used up".to_owned(),
        io::ErrorKind::PermissionDenied => "you may not write or read there".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "the disk is read-only".to_owned(),
        io::ErrorKind::NotADirectory => "part of the path is a file, not a folder".to_owned(),
        io::ErrorKind::NotFound => "it does not exist".to_owned(),
        io::ErrorKind::AlreadyExists => "a file of this name is in the way".to_owned(),
        io::ErrorKind::InvalidFilename => "the name is too long or has signs that are not allowed".to_owned(),
        _ => error.to_string(),
    }
}

fn io_remedy(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free some space, record fewer signals, or choose another place with --out"
        }
        io::ErrorKind::NotFound => "check the path",
        io::ErrorKind::InvalidFilename => "choose a shorter, plainer name",
        _ => "choose another place with --out",
    }
}

impl fmt::Display for ResultsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let doing = match self {
            ResultsError::FolderInUse { .. } | ResultsError::NoFolderName { .. } => "write a run into",
            ResultsError::Io { doing, .. } => doing,
            ResultsError::Csv { .. } => "read",
        };
        write!(f, "cannot {doing} `{}`: {}; {}", self.place().display(), self.reason(), self.remedy())
    }
}

impl std::error::Error for ResultsError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            ResultsError::Io { source, .. } => Some(source),
            ResultsError::Csv { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// Where and why a CSV text cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CsvError {
    /// Line of the text, from 1.
    pub line: u64,
    /// Column of the table, from 1; `None` where the line as a whole is meant.
    pub column: Option<usize>,
    /// What is wrong, with what to do where that is known.
    pub problem: String,
}

impl fmt::Display for CsvError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.column {
            Some(column) => write!(f, "line {}, column {column}: {}", self.line, self.problem),
            None => write!(f, "line {}: {}", self.line, self.problem),
        }
    }
}

impl std::error::Error for CsvError {}

/// A row that does not belong into a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RecordingError {
    /// The row has another number of values than there are signals.
    RowLength {
        /// Signals of the recording.
        signals: usize,
        /// Values of the row.
        values: usize,
    },
    /// Time is not a number or lies before the last row.
    TimeOrder {
        /// Time of the last row, s.
        last: f64,
        /// Time of the new row, s.
        time: f64,
    },
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RecordingError::RowLength { signals, values } => {
                write!(f, "a row of {values} values does not fit a recording of {signals} signals")
            }
            RecordingError::TimeOrder { last, time } => {
                write!(f, "a row at {time} s cannot follow one at {last} s")
            }
        }
    }
}

impl std::error::Error for RecordingError {}
