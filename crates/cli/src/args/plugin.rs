//! The command lines of `blocksim plugin`.

use std::path::PathBuf;

use blocksim_block::ParamValue;
use blocksim_signal::Value;
use clap::{Subcommand, ValueEnum};

use super::model::PluginArgs;
use super::values::{quantity, time};

/// `blocksim plugin`.
#[derive(Debug, Subcommand)]
pub enum PluginCommand {
    /// Make the sources of a controller in Rust, C or C++, with a diagram that runs it.
    New(PluginNewArgs),
    /// Show which controllers a plug-in has; one that is trusted is built and loaded first.
    Show(PluginShowArgs),
    /// Examine whether the controllers of a plug-in keep the contract, in processes of their own.
    Check(PluginCheckArgs),
    /// Serve a plug-in to a process that runs it isolated.
    #[command(hide = true)]
    Serve,
}

impl PluginCommand {
    /// Whether the answer is to be data.
    pub fn json(&self) -> bool {
        match self {
            PluginCommand::Show(args) => args.json,
            PluginCommand::Check(args) => args.json,
            _ => false,
        }
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
    #[value(alias = "c++")]
    Cpp,
}

/// What a crate is built for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TargetName {
    /// A library for this computer.
    Native,
    /// A WebAssembly module.
    Wasm,
}

impl From<TargetName> for blocksim_host::Target {
    fn from(name: TargetName) -> blocksim_host::Target {
        match name {
            TargetName::Native => blocksim_host::Target::Native,
            TargetName::Wasm => blocksim_host::Target::Wasm,
        }
    }
}

/// `blocksim plugin show`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  blocksim plugin show plugins/pid")]
pub struct PluginShowArgs {
    /// A built library, a WebAssembly module, or the folder of its sources, which is built first.
    pub library: String,
    /// What a crate is built for, as `target` in a diagram.
    #[arg(long, value_enum, default_value_t = TargetName::Native, value_name = "TARGET")]
    pub target: TargetName,
    #[command(flatten)]
    pub plugins: PluginArgs,
    /// As JSON, an object for each controller.
    #[arg(long)]
    pub json: bool,
}

/// `blocksim plugin check`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  blocksim plugin check plugins/pid --set kp=2\n  blocksim plugin check students/ada --json\n\n\
                  Exit codes: 0 all rules are kept, 1 a rule is broken, 4 it does not build or load."
)]
pub struct PluginCheckArgs {
    /// A built library, a WebAssembly module, or the folder of its sources, which is built first.
    pub library: String,
    /// What a crate is built for, as `target` in a diagram.
    #[arg(long, value_enum, default_value_t = TargetName::Native, value_name = "TARGET")]
    pub target: TargetName,
    /// Controller to examine; without it all that the plug-in has.
    #[arg(long, value_name = "NAME")]
    pub block: Option<String>,
    /// Value of a parameter, in SI or with a unit; of a vector with commas. May be repeated; without it the default holds.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = parameter)]
    pub set: Vec<(String, ParamValue)>,
    /// Longest time that a call may take; without it 10 s.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub call_limit: Option<f64>,
    /// As JSON, an object for each controller.
    #[arg(long)]
    pub json: bool,
}

/// A parameter and its value.
fn parameter(text: &str) -> Result<(String, ParamValue), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, such as kp=2")?;
    let number =
        |text: &str| quantity(text.trim(), "a value is a number, such as 2 or \"20 ms\"").map(Value::from);
    let value = match value.contains(',') {
        true => Value::List(value.split(',').map(number).collect::<Result<_, _>>()?),
        false => number(value)?,
    };
    Ok((name.trim().to_owned(), ParamValue(value)))
}
