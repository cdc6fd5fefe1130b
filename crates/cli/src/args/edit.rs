//! The command line of `blocksim edit`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// The verbs of `blocksim edit`.
#[derive(Debug, Subcommand)]
pub enum EditCommand {
    /// Give a block, or a port of a subsystem, another name, wherever it is named.
    Rename(RenameArgs),
    /// Delete blocks with their wires.
    Delete(DeleteArgs),
    /// Connect two ports, if they and their units fit.
    Connect(ConnectArgs),
    /// Delete the wire of an input, all wires of an output, or take a conserving port out of its connection.
    Disconnect(DisconnectArgs),
    /// Add a block, beside another or into a wire.
    Add(AddArgs),
    /// Put blocks into a subsystem with a file of its own; its ports follow from the wires.
    Wrap(WrapArgs),
}

/// What all verbs have in common.
#[derive(Debug, Args)]
pub struct EditOptions {
    /// Change a file that several blocks, or several models, are made of.
    #[arg(long)]
    pub all: bool,
    /// Show what would change, and change nothing.
    #[arg(long)]
    pub dry_run: bool,
}

/// `blocksim edit rename`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim edit rename servo.ron pid controller\n  blocksim edit rename arm.ron arm/link1/motor drive\n  \
                        blocksim edit rename arm.ron arm/link1/in.torque moment\n\nReferences in connections, `record`, `panel` and `simulation` follow, in all \
                        models beside this one that share the file, and so do comments that show how to `--set` it."
)]
pub struct RenameArgs {
    /// The model.
    pub model: PathBuf,
    /// The block by its path, or `in.NAME` and `out.NAME` for a port of a subsystem.
    pub name: String,
    /// The name that it gets.
    pub new: String,
    /// Common options.
    #[command(flatten)]
    pub options: EditOptions,
}

/// `blocksim edit delete`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  blocksim edit delete servo.ron encoder angle --dry-run\n\n\
                        Entries of `record`, `panel` and `simulation` that name them are removed; ports that nothing is connected to any more are listed.")]
pub struct DeleteArgs {
    /// The model.
    pub model: PathBuf,
    /// The blocks by their paths, all of one level.
    #[arg(required = true)]
    pub blocks: Vec<String>,
    /// Common options.
    #[command(flatten)]
    pub options: EditOptions,
}

/// `blocksim edit connect`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim edit connect servo.ron error.y pid.e\n  blocksim edit connect servo.ron motor.r gear.base\n  \
                        blocksim edit connect arm.ron arm/link1/in.torque arm/link1/drive.u"
)]
pub struct ConnectArgs {
    /// The model.
    pub model: PathBuf,
    /// A port: `block.port`, `in.NAME` for an input of the diagram, `out.NAME` for what it hands outward.
    pub from: String,
    /// The other port; which comes first does not matter.
    pub to: String,
    /// Common options.
    #[command(flatten)]
    pub options: EditOptions,
}

/// `blocksim edit disconnect`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  blocksim edit disconnect servo.ron pid.e")]
pub struct DisconnectArgs {
    /// The model.
    pub model: PathBuf,
    /// The port.
    pub port: String,
    /// Common options.
    #[command(flatten)]
    pub options: EditOptions,
}

/// `blocksim edit add`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim edit add servo.ron LowPass --into error.y pid.e --with \"tau=5 ms\"\n  \
                        blocksim edit add servo.ron Scope --into pid.u\n  blocksim edit add servo.ron Gain --beside pid --name half --with k=0.5\n\n\
                        Required parameters that are not given get the values of the example of the kind (`blocksim blocks KIND`)."
)]
pub struct AddArgs {
    /// The model.
    pub model: PathBuf,
    /// The kind of block; `blocksim blocks WORDS` finds one.
    pub kind: String,
    /// Its name; without it, one that follows from the kind.
    #[arg(long)]
    pub name: Option<String>,
    /// The path of the subsystem that it is added to; without it the top, or the level of the other options.
    #[arg(long, value_name = "PATH")]
    pub level: Option<String>,
    /// The block that it follows in the text.
    #[arg(long, value_name = "BLOCK")]
    pub beside: Option<String>,
    /// Ends of the wire that it is put into: the source, and the targets that it drives then; all of them without any.
    #[arg(long, value_name = "PORT", num_args = 1..)]
    pub into: Vec<String>,
    /// A parameter: `k=0.5`, `"tau=5 ms"`.
    #[arg(long, value_name = "NAME=VALUE")]
    pub with: Vec<String>,
    /// Common options.
    #[command(flatten)]
    pub options: EditOptions,
}

/// `blocksim edit wrap`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  blocksim edit wrap servo.ron source motor gear --name drive\n\n\
                        The results of runs stay the same to the bit, but for random numbers, which follow from paths. Paths of the blocks \
                        change: `--set pid.kp` becomes \
                        `--set drive/pid.kp`.")]
pub struct WrapArgs {
    /// The model.
    pub model: PathBuf,
    /// The blocks by their paths, all of one level.
    #[arg(required = true)]
    pub blocks: Vec<String>,
    /// Name of the subsystem and of its file, without `.ron`.
    #[arg(long)]
    pub name: Option<String>,
    /// Common options.
    #[command(flatten)]
    pub options: EditOptions,
}
