//! Errors of a run while a file is written.

use blocksim_recording::ResultsError;

/// An error of a run within the writing of a file, which goes with it where it is one of reading.
pub(crate) fn within(error: ResultsError) -> std::io::Error {
    match error {
        ResultsError::Io { source, doing: "write", .. } => source,
        error => std::io::Error::new(std::io::ErrorKind::InvalidData, error),
    }
}
