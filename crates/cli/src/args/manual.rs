//! The command lines of `blocksim blocks`, `manual`, `help` and `explain`.

use std::path::PathBuf;

/// `blocksim blocks`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  blocksim blocks LowPass\n  blocksim blocks spring\n  blocksim blocks \"dead time\""
)]
pub struct BlocksArgs {
    /// A kind of block, which is described, or words, which kinds are found by; without it all kinds are listed.
    #[arg(value_name = "KIND OR WORDS")]
    pub words: Vec<String>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
}

/// `blocksim manual`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  blocksim manual start\n  blocksim manual language units\n  blocksim manual --site manual"
)]
pub struct ManualArgs {
    /// Name of a page; all names if none is given.
    pub page: Option<String>,
    /// Words: only the sections that are about them.
    #[arg(value_name = "WORDS")]
    pub section: Vec<String>,
    /// Write the whole manual to this folder as a site with search: guides, tutorials, errors, and a page for each block with its
    /// drawing and a run.
    #[arg(long, value_name = "FOLDER", conflicts_with = "page")]
    pub site: Option<PathBuf>,
    /// Replace a site that is there.
    #[arg(long, requires = "site")]
    pub yes: bool,
}

/// `blocksim help`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  blocksim help drive\n  blocksim help params set")]
pub struct HelpArgs {
    /// A command, or words to look for; the commands if nothing is given.
    pub words: Vec<String>,
}

/// `blocksim explain`.
#[derive(Debug, clap::Args)]
pub struct ExplainArgs {
    /// The word in the brackets of the message; all of them if none is given.
    pub code: Option<String>,
}
