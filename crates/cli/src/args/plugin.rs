//! The command lines of `blocksim plugin`.

use std::path::PathBuf;

use clap::{Subcommand, ValueEnum};

use super::model::PluginArgs;

/// `blocksim plugin`.
#[derive(Debug, Subcommand)]
pub enum PluginCommand {
    /// Make the sources of a controller in Rust, C or C++, with a diagram that runs it.
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
                        blocksim plugin new ~/lab/cruise --kind CruiseControl\n  \
                        blocksim plugin new plugins/current --language c")]
pub struct PluginNewArgs {
    /// Folder of the sources, which must be new or empty; its name becomes that of the plug-in.
    pub folder: PathBuf,
    /// Name of the controller in diagrams; without it that of the plug-in in capitals, `MyController`.
    #[arg(long, value_name = "NAME")]
    pub kind: Option<String>,
    /// Language of the controller.
    #[arg(long, value_enum, default_value_t = Language::Rust, value_name = "LANGUAGE")]
    pub language: Language,
    /// Clone of blocksim that a crate is built against; without it the one around the folder, or the one that this
    /// program was built from.
    #[arg(long, value_name = "DIR")]
    pub blocksim: Option<PathBuf>,
}

/// The language that a controller is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// A crate, built with cargo.
    Rust,
    /// C99, built with `cc`.
    C,
    /// C++20, built with `c++`.
    Cpp,
}

/// `blocksim plugin show`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  blocksim plugin show plugins/pid")]
pub struct PluginShowArgs {
    /// A built library, or the folder of its sources, which is built first.
    pub library: String,
    #[command(flatten)]
    pub plugins: PluginArgs,
    /// As JSON, an object for each controller.
    #[arg(long)]
    pub json: bool,
}
