//! Runs for other programs: CSV, MAT, Parquet.

mod csv;
mod mat;
mod parquet;
mod resample;
mod within;

pub use csv::write_run_csv;
pub use mat::write_mat;
pub use parquet::write_parquet;
pub use resample::resampled;
