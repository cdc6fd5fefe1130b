//! The command line of `blocksim trust`.

use std::path::PathBuf;

/// `blocksim trust`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Without a folder, lists what is trusted.\n\nExamples:\n  blocksim trust                        what is trusted\n  \
                  blocksim trust ~/lab                  trust a project\n  blocksim trust --remove ~/lab         trust it no longer"
)]
pub struct TrustArgs {
    /// Folders whose diagrams and plug-ins are trusted, with all that is below them, or libraries of plug-ins.
    #[arg(value_name = "FOLDER")]
    pub folders: Vec<PathBuf>,
    /// Remove the folders from what is trusted.
    #[arg(long, requires = "folders")]
    pub remove: bool,
    /// List what is trusted, also after a change; without folders this is the default.
    #[arg(long)]
    pub list: bool,
    /// Print the list as JSON, an object a line.
    #[arg(long)]
    pub json: bool,
}
