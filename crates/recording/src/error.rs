//! What can go wrong between memory and disk, in words for the person at the keyboard.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Most names in a message.
const SHOWN: usize = 5;

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
    /// A file is not what it should be, or not any more.
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// A folder holds no run.
    NoRun {
        /// The folder.
        path: PathBuf,
    },
    /// No run, or several, bear this name.
    NoSuchRun {
        /// The name.
        path: PathBuf,
        /// Where it was looked for.
        runs: PathBuf,
        /// The runs that it fits, if several do.
        likely: Vec<String>,
    },
    /// A run has no signal of this name.
    NoSignal {
        /// The run.
        path: PathBuf,
        /// The name.
        signal: String,
        /// The one that is probably meant.
        likely: Option<String>,
    },
    /// Signals that were to be read together have other times.
    TwoRates {
        /// The run.
        path: PathBuf,
        /// Two such signals.
        signals: [String; 2],
    },
    /// More was asked for than fits into memory.
    TooLong {
        /// The run.
        path: PathBuf,
        /// Numbers that were asked for.
        values: u64,
    },
}

impl ResultsError {
    /// A file that is not what it should be.
    pub fn damaged(path: &Path, problem: &str) -> ResultsError {
        ResultsError::Damaged { path: path.to_owned(), problem: problem.to_owned() }
    }

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
            | ResultsError::Csv { path, .. }
            | ResultsError::Damaged { path, .. }
            | ResultsError::NoRun { path }
            | ResultsError::NoSuchRun { path, .. }
            | ResultsError::NoSignal { path, .. }
            | ResultsError::TwoRates { path, .. }
            | ResultsError::TooLong { path, .. } => path,
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
            ResultsError::NoFolderName { .. } => "this is not a valid name for a new folder".to_owned(),
            _ if self.is_gone() => "its folder was removed or renamed during the run".to_owned(),
            ResultsError::Io { source, .. } => io_reason(source),
            ResultsError::Csv { source, .. } => source.to_string(),
            ResultsError::Damaged { problem, .. } => problem.clone(),
            ResultsError::NoRun { .. } => "there is no recording in this folder".to_owned(),
            ResultsError::NoSuchRun { path, runs, .. } if path == Path::new("latest") => {
                format!("there is no finished run in `{}`", runs.display())
            }
            ResultsError::NoSuchRun { runs, likely, .. } if likely.is_empty() => {
                format!("no folder, file or run in `{}` has this name", runs.display())
            }
            ResultsError::NoSuchRun { likely, .. } => {
                let more = if likely.len() > SHOWN { ", ..." } else { "" };
                format!("several runs fit: {}{more}", likely[..likely.len().min(SHOWN)].join(", "))
            }
            ResultsError::NoSignal { signal, likely: None, .. } => {
                format!("it has no signal `{signal}`")
            }
            ResultsError::NoSignal { signal, likely: Some(likely), .. } => {
                format!("it has no signal `{signal}`; did you mean `{likely}`?")
            }
            ResultsError::TwoRates { signals: [a, b], .. } => {
                format!("`{a}` and `{b}` were recorded at other times")
            }
            ResultsError::TooLong { values, .. } => {
                format!("{values} numbers are too many to have in memory at once")
            }
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
            ResultsError::Io { doing: "read", source, .. } => remedy_of_reading(source),
            ResultsError::Io { source, .. } => io_remedy(source),
            ResultsError::Csv { .. } => "correct the file, or export it again",
            ResultsError::Damaged { .. } => {
                "take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be whole"
            }
            ResultsError::NoRun { .. } => "name a folder that `blocksim run` wrote, or a table",
            ResultsError::NoSuchRun { likely, .. } if likely.is_empty() => {
                "`blocksim runs` lists what there is; `blocksim run MODEL` makes a new one"
            }
            ResultsError::NoSuchRun { .. } => "write more of the name, or `latest`",
            ResultsError::NoSignal { .. } => "the first line of `signals.csv` names all signals",
            ResultsError::TwoRates { .. } => "read them one by one",
            ResultsError::TooLong { .. } => "read fewer signals, or part of the time",
        }
    }
}

fn io_reason(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        io::ErrorKind::QuotaExceeded => "your share of the disk is used up".to_owned(),
        io::ErrorKind::FileTooLarge => "no file may become so large here".to_owned(),
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
        io::ErrorKind::FileTooLarge => {
            "raise the limit of the system (`ulimit -f`), record fewer signals, or choose another place with --out"
        }
        io::ErrorKind::NotFound => "check the path",
        io::ErrorKind::InvalidFilename => "choose a shorter, plainer name",
        _ => "choose another place with --out",
    }
}

fn remedy_of_reading(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => "check the path",
        io::ErrorKind::PermissionDenied => "ask its owner for the right to read it, or name a copy",
        _ => "name a recording, a table or the folder of a run",
    }
}

impl fmt::Display for ResultsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let doing = match self {
            ResultsError::FolderInUse { .. } | ResultsError::NoFolderName { .. } => "write a run into",
            ResultsError::Io { doing, .. } => doing,
            _ => "read",
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
