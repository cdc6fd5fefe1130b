//! The command line of `blocksim collisions`.

use std::path::PathBuf;

use super::values::moment;

/// `blocksim collisions`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Ends with 1 if something touches. Neighbours, which a joint connects, may touch, and so may parts of the \
                        mechanism that touch where the run starts.\n\nExamples:\n  blocksim collisions latest\n  \
                        blocksim collisions latest --surroundings bench.ron --from 0.5s --to 2s"
)]
pub struct CollisionsArgs {
    /// Folder of the run, part of the name of a run in `runs/`, or `latest`.
    pub run: String,
    /// What stands around the mechanism: a file with its shapes, or a diagram with the parameter `surroundings`; without it,
    /// that of the model, where it has one.
    #[arg(long, value_name = "FILE")]
    pub surroundings: Option<PathBuf>,
    /// Leave out what was before this time.
    #[arg(long, value_name = "TIME", value_parser = moment)]
    pub from: Option<f64>,
    /// Leave out what was after this time.
    #[arg(long, value_name = "TIME", value_parser = moment)]
    pub to: Option<f64>,
    /// List all contacts and distances, not only the first and the smallest.
    #[arg(long)]
    pub all: bool,
    /// As JSON, in SI units.
    #[arg(long)]
    pub json: bool,
}
