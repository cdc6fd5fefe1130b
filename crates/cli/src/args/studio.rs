//! The command line of `blocksim studio`.

use std::path::PathBuf;

/// `blocksim studio`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  blocksim studio\n  blocksim studio diagrams/irb2600/irb2600.ron --edit\n  \
                  blocksim studio . --no-open --port 7700"
)]
pub struct StudioArgs {
    /// A folder with models, or a model.
    #[arg(default_value = ".")]
    pub path: PathBuf,
    /// Port of 127.0.0.1; without it 7700, or the next that is free.
    #[arg(long, value_name = "N")]
    pub port: Option<u16>,
    /// Open no browser.
    #[arg(long)]
    pub no_open: bool,
    /// Let the page change the texts of the model: parameters, blocks, wires, text.
    #[arg(long)]
    pub edit: bool,
}
