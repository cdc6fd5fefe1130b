//! The command lines of `blocksim plugin`.

use std::path::PathBuf;

use clap::Subcommand;

use super::model::PluginArgs;

/// `blocksim plugin`.
#[derive(Debug, Subcommand)]
pub enum PluginCommand {
    /// Make the crate of a controller, with a diagram that runs it.
    New(PluginNewArgs),
    /// Show which controllers a plug-in has; one that is trusted is built and loaded first.
    Show(PluginShowArgs),
}

impl PluginCommand {
    /// Whether the answer is to be data.
    pub fn json(&self) -> bool {
        matches!(self, PluginCommand::Show(args) if args.json)
    }
}

/// `blocksim plugin new`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  blocksim plugin new plugins/my_controller\n  \
                        blocksim plugin new ~/lab/cruise --kind CruiseControl")]
pub struct PluginNewArgs {
    /// Folder of the crate, which must be new or empty; its name becomes that of the plug-in.
    pub folder: PathBuf,
    /// Name of the controller in diagrams; without it that of the plug-in in capitals, `MyController`.
    #[arg(long, value_name = "NAME")]
    pub kind: Option<String>,
    /// Clone of blocksim that the crate is built against; without it the one around the folder, or the one that this
    /// program was built from.
    #[arg(long, value_name = "DIR")]
    pub blocksim: Option<PathBuf>,
}

/// `blocksim plugin show`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  blocksim plugin show plugins/pid")]
pub struct PluginShowArgs {
    /// A built library, or the folder of its crate, which is built first.
    pub library: String,
    #[command(flatten)]
    pub plugins: PluginArgs,
    /// As JSON, an object for each controller.
    #[arg(long)]
    pub json: bool,
}
