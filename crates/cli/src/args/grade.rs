//! The command line of `blocksim grade`.

use std::path::PathBuf;

use super::plot::{duration, tolerance};
use super::values::{positive, time};

/// `blocksim grade`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  blocksim grade students --against reference/loop.ron --rel 1e-2\n  \
                  blocksim grade students --against loop.ron --signals 'scope.*' --limit 30s --out graded")]
pub struct GradeArgs {
    /// A folder with a folder for each project.
    pub folder: PathBuf,
    /// The model that the others are compared with; in each project the one of the same name is run.
    #[arg(long, value_name = "MODEL")]
    pub against: PathBuf,
    /// Folder for the runs and the page, which must be new or empty.
    #[arg(short, long, value_name = "DIR", default_value = "graded")]
    pub out: PathBuf,
    /// Signals that are compared; without it all that the reference records.
    #[arg(long, value_name = "PATTERN", value_delimiter = ',')]
    pub signals: Vec<String>,
    /// Absolute tolerance, such as `0.1deg` or `2 N*m`, for signals of this kind; a plain number holds for all, in SI. May be repeated.
    #[arg(long, value_name = "X", value_parser = written_tolerance, allow_hyphen_values = true)]
    pub abs: Vec<String>,
    /// Relative tolerance, share of the reference at each instant.
    #[arg(long, value_name = "X", value_parser = positive)]
    pub rel: Option<f64>,
    /// Tolerance as a share of the range of the reference, its maximum less its minimum. Without it and --abs that of --rel, which alone
    /// would allow nothing where a signal passes zero; without any, 1e-3.
    #[arg(long, value_name = "X", value_parser = positive)]
    pub range: Option<f64>,
    /// How much earlier or later a value may come: where signals jump, other steps of the solver come a little beside. A ten-thousandth of
    /// the time that the reference runs for, if not given.
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub time_tolerance: Option<f64>,
    /// Longest time that a project may take to be built and to run.
    #[arg(long, value_name = "TIME", value_parser = time, default_value = "60s")]
    pub limit: f64,
    /// Longest time that a call of a plug-in may take.
    #[arg(long, value_name = "TIME", value_parser = time, default_value = "1s")]
    pub call_limit: f64,
    /// Print a JSON object for each project.
    #[arg(long)]
    pub json: bool,
}

/// A tolerance as `compare` takes it, as written.
fn written_tolerance(text: &str) -> Result<String, String> {
    tolerance(text).map(|_| text.to_owned())
}
