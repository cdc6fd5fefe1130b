//! Runs for other programs: CSV, MAT, Parquet.

mod csv;
mod mat;
mod parquet;
mod resample;

pub use csv::write_run_csv;
pub use mat::write_mat;
pub use parquet::write_parquet;
pub use resample::resampled;

use crate::error::ResultsError;

/// An error of a run within the writing of a file, which goes with it where it is one of reading.
fn within(error: ResultsError) -> std::io::Error {
    match error {
        ResultsError::Io { source, doing: "write", .. } => source,
        error => std::io::Error::new(std::io::ErrorKind::InvalidData, error),
    }
}
