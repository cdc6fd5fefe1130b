//! The command lines of `blocksim runs` and `blocksim export`.

use std::path::PathBuf;

use super::export_c::ExportCArgs;
use super::values::{RUNS, moment, time};

/// `blocksim runs`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "A run is named by its folder, by part of its name, or as `latest`.\n\nExample:\n  blocksim runs"
)]
pub struct RunsArgs {
    /// Folder in which the runs are.
    #[arg(default_value = RUNS)]
    pub folder: PathBuf,
    /// As JSON, an object a line.
    #[arg(long)]
    pub json: bool,
}

/// `blocksim export`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Values are in SI units. An existing file is not overwritten.\n\nExamples:\n  \
                  blocksim export latest --csv arm.csv --signals 'arm/**' --every 10ms\n  \
                  blocksim export servo --mat servo.mat\n  \
                  blocksim export servo --parquet servo.parquet\n  \
                  blocksim export c loop.ron --subsystem control --rate 1ms --out control_c")]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(group(clap::ArgGroup::new("format").required(true).args(["csv", "mat", "parquet"])))]
pub struct ExportArgs {
    #[command(subcommand)]
    pub what: Option<ExportWhat>,
    /// Folder or recording of the run, part of the name of a run in `runs/`, or `latest`.
    #[arg(required = true)]
    pub run: Option<String>,
    /// A table with decimal points, the first column time; signals of other rates go to files of their own.
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// A MAT-file for MATLAB, Octave and SciPy; signals of all rates go into it.
    #[arg(long, value_name = "FILE")]
    pub mat: Option<PathBuf>,
    /// A Parquet file for pandas, DuckDB, MATLAB and others; signals of other rates go to files of their own.
    #[arg(long, value_name = "FILE")]
    pub parquet: Option<PathBuf>,
    /// Signals to write: parts of their paths or patterns with `*`, separated by commas.
    #[arg(long, value_name = "PATTERN", value_delimiter = ',')]
    pub signals: Vec<String>,
    /// Bring all signals to the multiples of this time; real ones are interpolated.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub every: Option<f64>,
    /// Leave out what was before this time.
    #[arg(long, value_name = "TIME", value_parser = moment)]
    pub from: Option<f64>,
    /// Leave out what was after this time.
    #[arg(long, value_name = "TIME", value_parser = moment)]
    pub to: Option<f64>,
}

/// What is exported that is no run.
#[derive(Debug, clap::Subcommand)]
pub enum ExportWhat {
    /// C99 of a subsystem or of a whole model, for a target, with a test against the simulation.
    C(ExportCArgs),
}
