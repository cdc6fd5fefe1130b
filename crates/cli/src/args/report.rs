//! The command line of `blocksim report`.

use std::path::PathBuf;

use clap::Args;

/// `blocksim report`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim report latest\n  blocksim report runs/before -o before.html --overlay measured.csv\n  \
                  blocksim report latest --full --no-3d"
)]
pub struct ReportArgs {
    /// The run: its folder, its name or the beginning of it, `latest`, or a table (CSV).
    pub run: String,
    /// The file; without it `report.html` in the folder of the run.
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Keep all values, however large the file becomes.
    #[arg(long)]
    pub full: bool,
    /// Leave the 3D view away.
    #[arg(long = "no-3d")]
    pub no_3d: bool,
    /// What stands around the robot: a file with its shapes, or a diagram with the parameter `surroundings`; without it, that of
    /// the model, where it has one.
    #[arg(long, value_name = "FILE")]
    pub surroundings: Option<PathBuf>,
    /// A measurement to lay over the pictures, a CSV file; may be repeated.
    #[arg(long, value_name = "FILE")]
    pub overlay: Vec<PathBuf>,
    /// Show the file in the browser.
    #[arg(long)]
    pub open: bool,
    /// Replace a file that is there.
    #[arg(long)]
    pub yes: bool,
}

impl ReportArgs {
    /// The page of a run in its folder, as it is without options.
    pub fn of(run: String) -> ReportArgs {
        ReportArgs {
            run,
            out: None,
            full: false,
            no_3d: false,
            surroundings: None,
            overlay: Vec::new(),
            open: false,
            yes: false,
        }
    }
}
