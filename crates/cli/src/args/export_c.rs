//! The command line of `blocksim export c`.

use std::path::PathBuf;

use clap::ValueEnum;

use super::model::ModelArgs;
use super::values::time;

/// `blocksim export c`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "The code has no globals and allocates nothing. Existing files are not overwritten without --yes.\n\nExample:\n  \
                        blocksim export c loop.ron --subsystem control --rate 1ms --out control_c"
)]
pub struct ExportCArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// Subsystem that runs on the target, by its path; without it the whole model, whose outputs are what it records.
    #[arg(long, value_name = "PATH")]
    pub subsystem: Option<String>,
    /// Time between two steps on the target; all sample times must be multiples of it.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub rate: f64,
    /// Folder for the files, made if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// Method of fixed step for continuous states.
    #[arg(long, value_enum, value_name = "NAME")]
    pub method: Option<MethodName>,
    /// Single precision.
    #[arg(long)]
    pub float: bool,
    /// What files, types and functions begin with; without it the name of the subsystem or of the file.
    #[arg(long, value_name = "NAME")]
    pub name: Option<String>,
    /// Replace files that are there already.
    #[arg(long)]
    pub yes: bool,
    /// Steps of the test, at most; it ends with the simulation.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub test_steps: u32,
}

/// Methods that a target can run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Euler's method, order 1.
    Euler,
    /// The classical method of Runge and Kutta, order 4.
    Rk4,
}
