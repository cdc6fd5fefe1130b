//! The command line of `blocksim report`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// `blocksim report`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim report latest\n  blocksim report runs/before -o before.html --overlay measured.csv\n  \
                  blocksim report latest --full --no-3d\n  \
                  blocksim report latest --sections scopes,tracking --author 'Ada Lovelace'"
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
    /// The sections of the page beside its summary, separated by commas; without it, all.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "SECTION,...")]
    pub sections: Vec<Section>,
    /// Who hands the page in: it names them in its summary.
    #[arg(long, value_name = "NAME")]
    pub author: Option<String>,
    /// Show the file in the browser.
    #[arg(long)]
    pub open: bool,
    /// Replace a file that is there.
    #[arg(long)]
    pub yes: bool,
}

/// A section of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Section {
    /// The mechanism in 3D.
    #[value(name = "3d")]
    Space,
    /// Signals over time.
    Scopes,
    /// Signals over others.
    Planes,
    /// The block diagram.
    Diagram,
    /// How actual values follow their set values.
    Tracking,
    /// What was set, and all parameters of the model.
    Parameters,
    /// What happened.
    Events,
}

impl ReportArgs {
    /// Whether the page has a section.
    pub fn has(&self, section: Section) -> bool {
        let is_left_out = section == Section::Space && self.no_3d;
        !is_left_out && (self.sections.is_empty() || self.sections.contains(&section))
    }

    /// The page of a run in its folder, as it is without options.
    pub fn of(run: String) -> ReportArgs {
        ReportArgs {
            run,
            out: None,
            full: false,
            no_3d: false,
            surroundings: None,
            overlay: Vec::new(),
            sections: Vec::new(),
            author: None,
            open: false,
            yes: false,
        }
    }
}
