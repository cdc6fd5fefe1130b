//! Runs for other programs: CSV, MAT and, where the feature is on, Parquet.

mod csv;
mod mat;
#[cfg(feature = "parquet")]
mod parquet;
mod resample;
mod within;

pub use csv::write_run_csv;
pub use mat::write_mat;
#[cfg(feature = "parquet")]
pub use parquet::write_parquet;
pub use resample::resampled;
