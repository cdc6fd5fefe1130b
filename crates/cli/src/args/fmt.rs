//! The command line of `blocksim fmt`.

use std::path::PathBuf;

/// `blocksim fmt`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  blocksim fmt servo.ron\n  blocksim fmt diagrams params --check      \
                        show what would change, exit code 1 if something would\n  blocksim fmt --stdin < servo.ron\n\n\
                        Exit codes: 0 laid out, 1 something would change (--check), 3 a text has errors and was left as \
                        it is, 4 files.")]
pub struct FmtArgs {
    /// Files, or folders whose `.ron` files are meant, also those in folders below.
    #[arg(required_unless_present = "stdin", value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Show what would change, and change nothing.
    #[arg(long)]
    pub check: bool,
    /// Read a text from the standard input and print it laid out.
    #[arg(long, conflicts_with_all = ["files", "check"])]
    pub stdin: bool,
}
