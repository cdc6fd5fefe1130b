//! The command line.

use std::path::PathBuf;

use blocksim_signal::{Lookup, Quantity, Scope, Unit, evaluate};
use clap::{Parser, Subcommand, ValueEnum};

use crate::export_args::{ExportArgs, RunsArgs};
use crate::graph_args::GraphArgs;
use crate::identify_args::IdentifyCommand;
use crate::params_args::ParamsCommand;
use crate::plan_args::PlanCommand;
use crate::plot_args::{CompareArgs, PlotArgs};
use crate::report_args::ReportArgs;
use crate::selection::{Wanted, wanted};

/// Simulate block diagrams written as text.
#[derive(Debug, Parser)]
#[command(name = "blocksim", version, disable_help_subcommand = true, max_term_width = 100)]
#[command(after_help = "Exit codes: 0 done, 1 the simulation failed, 2 usage, 3 the model has errors, \
                        4 files, 101 a bug, 130 interrupted.")]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Colour of messages; NO_COLOR and CLICOLOR_FORCE are heeded.
    #[arg(long, global = true, value_enum, default_value_t = Colour::Auto, value_name = "WHEN")]
    pub color: Colour,
    /// Draw with plain ASCII signs.
    #[arg(long, global = true)]
    pub ascii: bool,
}

/// When messages are coloured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    /// On a terminal.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Simulate a model, show what happened and keep it in a folder.
    Run(RunArgs),
    /// Draw a run: in the terminal, as SVG or PNG, with numbers of how set values are followed.
    Plot(PlotArgs),
    /// Make one HTML page of a run: scopes, the mechanism in space, numbers.
    Report(ReportArgs),
    /// Tell whether two runs or tables agree within tolerances.
    Compare(CompareArgs),
    /// Tell all problems of a model without running it.
    Check(CheckArgs),
    /// List the runs that were kept.
    Runs(RunsArgs),
    /// Write the signals of a run for other programs: CSV, MATLAB.
    Export(ExportArgs),
    /// Print what a step of the compiler makes of a model.
    Emit(EmitArgs),
    /// Draw a level of a model: in the terminal, as SVG or as PNG.
    Graph(GraphArgs),
    /// Make a diagram of a robot description or a CAD assembly, or bring its numbers up to date.
    Import(ImportArgs),
    /// Tell which kinds of block there are, or all about one kind.
    Blocks(BlocksArgs),
    /// Explain a problem by the word that stands in its brackets: `error[unknown_port]`.
    Explain(ExplainArgs),
    /// Measure a robot of a diagram by experiments, and compare with its parameters.
    #[command(subcommand)]
    Identify(IdentifyCommand),
    /// Plan a move of a robot, check it along its whole way, and write it as a file.
    #[command(subcommand)]
    Plan(PlanCommand),
    /// Sets of parameters as workbooks for Excel and LibreOffice, and back.
    #[command(subcommand)]
    Params(ParamsCommand),
}

/// A model and what to change in it.
#[derive(Debug, clap::Args)]
pub struct ModelArgs {
    /// File of the model.
    pub model: PathBuf,
    /// Sets a parameter for this call: `drive=dc`, `robot.axis1.gear.ring_teeth=51`, `pid.kp=40`; may be repeated.
    #[arg(long = "set", value_name = "TARGET=VALUE", value_parser = assignment)]
    pub set: Vec<String>,
}

/// `blocksim run`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  blocksim run servo.ron\n  blocksim run servo.ron --set pid.kp=12 --until \"500 ms\"\n  \
                        blocksim run servo.ron --plot 'angle.*' --out before\n  blocksim run servo.ron --signals 'angle.*,motor.**@10ms'"
)]
pub struct RunArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// End of the simulation, such as `10`, `10s` or `250ms`.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub until: Option<f64>,
    /// Method: ode1 to ode5 (fixed step), ode23, ode45, rodas4, rosw3 (variable step).
    #[arg(long, value_name = "NAME")]
    pub solver: Option<String>,
    /// Relative tolerance of a method of variable step.
    #[arg(long, value_name = "X", value_parser = positive)]
    pub rtol: Option<f64>,
    /// Step of a method of fixed step, or the largest one of a method of variable step.
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub step: Option<f64>,
    /// Folder for the results, which must be new or empty; without it `runs/<time>_<model>`.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Signals to keep, of those that the diagram records: parts of their paths or patterns with `*`, separated by
    /// commas. A rate may follow: `arm/**@10ms`, `arm/**@10rows`, or the least and largest value with `@minmax:10ms`.
    #[arg(long, value_name = "PATTERN[@RATE]", value_delimiter = ',', value_parser = wanted)]
    pub signals: Vec<Wanted>,
    /// Write the signals as CSV however many they are; without this only up to about 200 MB.
    #[arg(long, conflicts_with = "no_csv")]
    pub csv: bool,
    /// Write no CSV, only the recording.
    #[arg(long)]
    pub no_csv: bool,
    /// Signals to plot: parts of their paths or patterns with `*`, separated by commas.
    #[arg(long, value_name = "PATTERN", value_delimiter = ',', conflicts_with = "no_plot")]
    pub plot: Vec<String>,
    /// Draw nothing.
    #[arg(long)]
    pub no_plot: bool,
    /// Make a page of the run, `report.html` in the folder of the results.
    #[arg(long)]
    pub report: bool,
    /// Say only what is wrong, and print the folder of the results.
    #[arg(long, short, conflicts_with = "json")]
    pub quiet: bool,
    /// Print problems, progress and the result as JSON, one object a line.
    #[arg(long)]
    pub json: bool,
}

/// `blocksim check`.
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// How problems are told: with the text around them, a line each, or as JSON, an object a line.
    #[arg(long, value_enum, default_value_t = Format::Full, value_name = "FORMAT")]
    pub output_format: Format,
}

/// How problems are told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// With the text around them.
    Full,
    /// A line each.
    Short,
    /// A JSON object a line, on the standard output.
    Json,
}

/// `blocksim emit`.
#[derive(Debug, clap::Args)]
pub struct EmitArgs {
    /// Which step.
    #[arg(value_enum)]
    pub stage: StageName,
    #[command(flatten)]
    pub model: ModelArgs,
}

/// The steps of the compiler whose result can be printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StageName {
    /// Files as read.
    Ast,
    /// Parameters and variants resolved.
    Model,
    /// All blocks and connections without levels.
    Flat,
    /// Types and sample times of all ports.
    Types,
    /// What the engine runs.
    Schedule,
    /// What is seen of mechanisms, as JSON: bodies, joints, shapes, masses, frames.
    Scene,
}

/// `blocksim import`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Writes a diagram and a file of its numbers. Where the diagram exists it is left alone, and only \
                        the numbers are brought up to date.\n\nExample:\n  blocksim import arm.urdf --out arm"
)]
pub struct ImportArgs {
    /// The file.
    pub file: PathBuf,
    /// What it is; without this the file tells.
    #[arg(long = "as", value_enum, value_name = "KIND")]
    pub kind: Option<Kind>,
    /// Folder for the diagram and its parameters.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Density for links without mass, which then is that of their mesh, such as `2700` or `"7850 kg/m^3"`.
    #[arg(long, value_name = "DENSITY", value_parser = density)]
    pub density: Option<f64>,
    /// Leave meshes where they are, unread.
    #[arg(long, conflicts_with = "density")]
    pub no_meshes: bool,
    /// Overwrite a parameter file even if it was changed by hand.
    #[arg(long)]
    pub force: bool,
}

/// Kinds of file that can be imported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Robot description.
    Urdf,
    /// Assembly, exported for Simscape Multibody as import XML 2.0.
    Simscape,
    /// Numbers of such an assembly, a script that fills `smiData`: parameters only.
    Smidata,
}

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

/// No names: only numbers and units make sense on the command line.
pub struct NoNames;

impl Scope for NoNames {
    fn lookup(&self, _name: &str) -> Lookup {
        Lookup::Unknown
    }

    fn names(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A density above zero, kg/m³.
fn density(text: &str) -> Result<f64, String> {
    let value = evaluate(text, &NoNames).map_err(|error| error.message)?;
    let quantity = value.as_number().ok_or("a density is a number, such as 2700 or \"2700 kg/m^3\"")?;
    let fits = Unit::parse("kg/m^3").is_ok_and(|unit| quantity.dimension == unit.dimension);
    match quantity.value {
        _ if !fits && !quantity.dimension.is_none() => Err("a density has a unit such as kg/m^3".to_owned()),
        x if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("a density is above zero".to_owned()),
    }
}

/// A time above zero, s.
///
/// # Errors
/// What is wrong with it.
pub fn time(text: &str) -> Result<f64, String> {
    match moment(text)? {
        seconds if seconds > 0.0 => Ok(seconds),
        _ => Err("a time here is above zero".to_owned()),
    }
}

/// An instant, s.
pub fn moment(text: &str) -> Result<f64, String> {
    let quantity = quantity(text, "a time is a number, such as 10s or 250ms")?;
    let is_time = Unit::parse("s").is_ok_and(|second| quantity.dimension == second.dimension);
    match quantity.value {
        _ if !is_time && !quantity.dimension.is_none() => Err("a time has a unit such as s or ms".to_owned()),
        seconds if seconds.is_finite() => Ok(seconds),
        _ => Err("a time is finite".to_owned()),
    }
}

/// A number with or without a unit; `otherwise` tells what else is wrong.
pub fn quantity(text: &str, otherwise: &str) -> Result<Quantity, String> {
    let value = evaluate(text, &NoNames).map_err(|error| match error.help {
        Some(help) => format!("{}; {help}", error.message),
        None => error.message,
    })?;
    value.as_number().ok_or_else(|| otherwise.to_owned())
}

/// A number above zero.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("a number above zero, such as 1e-6".to_owned()),
    }
}

/// `target=value` with something on both sides.
pub fn assignment(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((target, value)) if !target.trim().is_empty() && !value.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("write target=value, such as drive=dc or pid.kp=40".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_of_the_command_line_is_sound() {
        Args::command().debug_assert();
    }

    #[test]
    fn times_have_units_or_are_seconds() {
        assert_eq!(time("10"), Ok(10.0));
        assert_eq!(time("10s"), Ok(10.0));
        assert_eq!(time("250 ms"), Ok(0.25));
        assert_eq!(time("2*1.5 s"), Ok(3.0));
        for wrong in ["3 m", "0", "-1 s", "1/0", "soon", "[1, 2]", ""] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn densities_have_units_or_are_kilograms_per_cubic_metre() {
        assert_eq!(density("2700"), Ok(2700.0));
        assert_eq!(density("7850 kg/m^3"), Ok(7850.0));
        for wrong in ["0", "-1", "3 kg", "steel"] {
            assert!(density(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_assignment_has_two_sides() {
        assert!(assignment("pid.kp=40").is_ok());
        assert!(assignment("a=b=c").is_ok(), "the value may be an expression");
        for wrong in ["kp", "=4", "kp=", " = "] {
            assert!(assignment(wrong).is_err(), "{wrong}");
        }
    }
}
