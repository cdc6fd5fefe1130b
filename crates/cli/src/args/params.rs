//! The command line of `blocksim params`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// The verbs of `blocksim params`.
#[derive(Debug, Subcommand)]
pub enum ParamsCommand {
    /// List the parameters of a model with their values, and where these are written.
    List(ListArgs),
    /// Show the value of a parameter and where it is written; all below it, of a set or a block.
    Get(GetArgs),
    /// Write another value of a parameter into the text that holds it, if the model has no errors with it.
    Set(SetArgs),
    /// Write the parameters of a model, or a set of parameters, as a workbook.
    Export(ExportArgs),
    /// Take changed numbers from a workbook into a model or a set; shows them, and writes with --yes.
    Import(ImportArgs),
    /// List the numbers that differ between two sets, two workbooks, or a set and a workbook.
    Diff(DiffArgs),
    /// Report what is wrong in a workbook and what changed on which side since it was exported.
    Check(CheckArgs),
}

impl ParamsCommand {
    /// Whether the answer is to be data.
    pub fn json(&self) -> bool {
        match self {
            ParamsCommand::List(args) => args.json,
            ParamsCommand::Get(args) => args.json,
            _ => false,
        }
    }
}

/// `blocksim params list`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim params list servo.ron\n  blocksim params list servo.ron pid --all"
)]
pub struct ListArgs {
    /// The model, or a set of parameters.
    pub model: PathBuf,
    /// Part of the names.
    pub pattern: Option<String>,
    /// Also parameters that are not written, with their defaults.
    #[arg(long)]
    pub all: bool,
    /// As JSON, an object for each; values in SI.
    #[arg(long)]
    pub json: bool,
}

/// `blocksim params get`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim params get servo.ron pid.kp\n  blocksim params get servo.ron motor"
)]
pub struct GetArgs {
    /// The model, or a set of parameters.
    pub model: PathBuf,
    /// The parameter as `--set` names it: `drive`, `robot.axis1.gear.ring_teeth`, `pid.kp`, `arm/link3.drive`.
    pub target: String,
    /// As JSON, an object for each; values in SI.
    #[arg(long)]
    pub json: bool,
}

/// `blocksim params set`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  blocksim params set servo.ron pid.kp 12\n  \
                        blocksim params set servo.ron motor.l \"3 mH\" --dry-run\n\nExit codes: 0 written, 2 unknown \
                        parameter or invalid value, 3 the model has errors with it and nothing was written, 4 files.")]
pub struct SetArgs {
    /// The model, or a set of parameters.
    pub model: PathBuf,
    /// The parameter as `--set` names it: `drive`, `robot.axis1.gear.ring_teeth`, `pid.kp`, `arm/link3.drive`.
    pub target: String,
    /// The value: `12`, `\"3 mH\"`, `\"2 * kp\"`, `dc`.
    #[arg(allow_hyphen_values = true)]
    pub value: String,
    /// Change a text that several parts of the model are made of.
    #[arg(long)]
    pub all: bool,
    /// Show what would change, and change nothing.
    #[arg(long)]
    pub dry_run: bool,
}

/// `blocksim params export`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  blocksim params export servo.ron\n  \
                  blocksim params export params/irb2600.ron --out irb2600.xlsx\n\n\
                  A model has a sheet for its top level, one for each subsystem and one for each set that it reads; a set has one \
                  for each of its groups, or those that a file `NAME.sheets.ron` beside it names.")]
pub struct ExportArgs {
    /// The model, or the set, such as params/irb2600.ron.
    pub set: PathBuf,
    /// The workbook; without it, the name of the model or set with .xlsx in the present folder.
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace a workbook that is there.
    #[arg(long)]
    pub yes: bool,
}

/// `blocksim params import`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  blocksim params import irb2600.xlsx params/irb2600.ron              show what would change\n  \
                  blocksim params import irb2600.xlsx params/irb2600.ron --yes        change the set\n  \
                  blocksim params import irb2600.xlsx params/irb2600.ron --out mine.ron\n\n\
                  Exit codes: 0 nothing to do or written, 1 changes were shown but not written, 3 the workbook or the \
                  model has errors, 4 files."
)]
pub struct ImportArgs {
    /// The workbook.
    pub book: PathBuf,
    /// The model or the set.
    pub set: PathBuf,
    /// Write the changed set into this file and leave the set as it is.
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Change the set, or replace the file of `--out`.
    #[arg(long)]
    pub yes: bool,
    /// Write only if this model has no errors with the new numbers.
    #[arg(long, value_name = "MODEL")]
    pub model: Option<PathBuf>,
}

/// `blocksim params diff`.
#[derive(Debug, Args)]
#[command(after_help = "Exit codes: 0 the same, 1 different, 3 a workbook has errors, 4 files.")]
pub struct DiffArgs {
    /// A model or a set (.ron), or a workbook (.xlsx).
    pub old: PathBuf,
    /// Another one.
    pub new: PathBuf,
}

/// `blocksim params check`.
#[derive(Debug, Args)]
#[command(
    after_help = "Exit codes: 0 sound (numbers may have changed), 3 the workbook or the model has errors, 4 files."
)]
pub struct CheckArgs {
    /// The workbook.
    pub book: PathBuf,
    /// The model or the set.
    pub set: PathBuf,
    /// Check this model with the numbers of the workbook.
    #[arg(long, value_name = "MODEL")]
    pub model: Option<PathBuf>,
}
