//! The command lines of `blocksim blocks` and `explain`.

/// `blocksim blocks`.
#[derive(Debug, clap::Args)]
pub struct BlocksArgs {
    /// A kind of block; all kinds if none is given.
    pub kind: Option<String>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
}

/// `blocksim explain`.
#[derive(Debug, clap::Args)]
pub struct ExplainArgs {
    /// The word in the brackets of the message; all of them if none is given.
    pub code: Option<String>,
}
