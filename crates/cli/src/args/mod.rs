//! The command line: one file for the flags of each command, or of a few that are alike.

pub mod collisions;
pub mod edit;
pub mod export;
pub mod export_c;
pub mod fmt;
pub mod grade;
pub mod graph;
pub mod identify;
pub mod import;
pub mod linearise;
pub mod manual;
pub mod model;
pub mod params;
pub mod plan;
pub mod plot;
pub mod plugin;
pub mod report;
pub mod start;
pub mod studio;
pub mod sweep;
pub mod trust;
pub mod values;

use clap::{Parser, Subcommand};

use self::collisions::CollisionsArgs;
use self::edit::EditCommand;
use self::export::{ExportArgs, RunsArgs};
use self::fmt::FmtArgs;
use self::grade::GradeArgs;
use self::graph::GraphArgs;
use self::identify::IdentifyCommand;
use self::import::ImportArgs;
use self::linearise::LineariseArgs;
use self::manual::{BlocksArgs, ExplainArgs, HelpArgs, ManualArgs};
use self::model::{CheckArgs, EmitArgs, Format, RunArgs};
use self::params::ParamsCommand;
use self::plan::PlanCommand;
use self::plot::{CompareArgs, PlotArgs};
use self::plugin::PluginCommand;
use self::report::ReportArgs;
use self::start::{CompletionsArgs, DoctorArgs, NewArgs};
use self::studio::StudioArgs;
use self::sweep::SweepArgs;
use self::trust::TrustArgs;
use crate::terminal::console::Colour;

/// Simulate block diagrams written as text.
#[derive(Debug, Parser)]
#[command(name = "blocksim", version, disable_help_subcommand = true, max_term_width = 100)]
#[command(after_help = "`blocksim help WORDS` finds what is about something: `blocksim help friction`.\n\n\
                        Exit codes: 0 done, 1 the simulation failed, 2 usage, 3 the model has errors, \
                        4 files, 101 a bug, 130 interrupted.")]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Colour of messages; NO_COLOR and CLICOLOR_FORCE are respected.
    #[arg(long, global = true, value_enum, default_value_t = Colour::Auto, value_name = "WHEN")]
    pub color: Colour,
    /// Draw with plain ASCII signs.
    #[arg(long, global = true)]
    pub ascii: bool,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Make a project that runs at once.
    New(NewArgs),
    /// Simulate a model, show what happened and keep it in a folder.
    Run(RunArgs),
    /// Show a project in the browser: diagrams, parameters, runs with live scopes, results.
    Studio(StudioArgs),
    /// Draw a run: in the terminal, as SVG or PNG, with numbers of how set values are followed.
    Plot(PlotArgs),
    /// Make one HTML page of a run: scopes, the 3D view, numbers.
    Report(ReportArgs),
    /// Compare two runs or tables within tolerances.
    Compare(CompareArgs),
    /// Run many projects apart from each other, compare each with a reference, and make one page.
    Grade(GradeArgs),
    /// List the contacts of a run, when and how deep, and clearances.
    Collisions(CollisionsArgs),
    /// Run a model over values of its parameters, and table how it follows its set values.
    Sweep(SweepArgs),
    /// Linearise a model at an instant: poles, zeros, margins of loops, frequency response.
    #[command(visible_alias = "linearize")]
    Linearise(LineariseArgs),
    /// List all problems of a model without running it.
    Check(CheckArgs),
    /// Lay out the text of diagrams and sets of parameters; comments stay.
    Fmt(FmtArgs),
    /// List the runs that were kept.
    Runs(RunsArgs),
    /// Write the signals of a run for other programs: CSV, MATLAB, Parquet.
    Export(ExportArgs),
    /// Print what a step of the compiler makes of a model.
    Emit(EmitArgs),
    /// Draw a level of a model: in the terminal, as SVG or as PNG.
    Graph(GraphArgs),
    /// Make a diagram of a robot description or a CAD assembly, or bring its numbers up to date.
    Import(ImportArgs),
    /// List the kinds of block, find some by words, or describe one.
    Blocks(BlocksArgs),
    /// Serve an editor: problems while you write, completion, pages of blocks (Language Server Protocol).
    Lsp,
    /// List, add or remove folders whose plug-ins are loaded to look at a model.
    Trust(TrustArgs),
    /// Check that the tools that blocksim needs are installed.
    Doctor(DoctorArgs),
    /// Print the licences of the program and of all of its parts.
    #[command(visible_alias = "licenses")]
    Licences,
    /// Print what makes a shell complete commands and options.
    Completions(CompletionsArgs),
    /// Print a page of the manual, or list the pages.
    Manual(ManualArgs),
    /// Find commands, options, pages, blocks and problems by words; or the help of one command.
    Help(HelpArgs),
    /// Explain a problem by the word that stands in its brackets: `error[unknown_port]`.
    Explain(ExplainArgs),
    /// Measure a robot of a diagram by experiments, and compare with its parameters.
    #[command(subcommand)]
    Identify(IdentifyCommand),
    /// Plan a move of a robot, check it along its whole way, and write it as a file.
    #[command(subcommand)]
    Plan(Box<PlanCommand>),
    /// Controllers as dynamic libraries: make the crate of one, show what one offers.
    #[command(subcommand)]
    Plugin(PluginCommand),
    /// Parameters of a model: list, get and set them; sets as workbooks for Excel and LibreOffice, and back.
    #[command(subcommand)]
    Params(ParamsCommand),
    /// Change a model as its picture is changed: rename, delete, connect, add, wrap; comments and layout of the text stay.
    #[command(subcommand)]
    Edit(EditCommand),
}

impl Args {
    /// How problems are printed: in the format of the results.
    pub fn format(&self) -> Format {
        let is_data = match &self.command {
            Some(Command::Check(args)) => return args.output_format,
            Some(Command::Run(args)) => args.json,
            Some(Command::Plot(args)) => args.json,
            Some(Command::Compare(args)) => args.json,
            Some(Command::Grade(args)) => args.json,
            Some(Command::Collisions(args)) => args.json,
            Some(Command::Sweep(args)) => args.json,
            Some(Command::Linearise(args)) => args.json,
            Some(Command::Runs(args)) => args.json,
            Some(Command::Graph(args)) => args.json,
            Some(Command::Blocks(args)) => args.json,
            Some(Command::Doctor(args)) => args.json,
            Some(Command::Trust(args)) => args.json,
            Some(Command::Identify(command)) => command.json(),
            Some(Command::Plan(command)) => command.common().json,
            Some(Command::Plugin(command)) => command.json(),
            Some(Command::Params(command)) => command.json(),
            Some(
                Command::New(_)
                | Command::Report(_)
                | Command::Studio(_)
                | Command::Fmt(_)
                | Command::Edit(_)
                | Command::Export(_)
                | Command::Emit(_)
                | Command::Import(_)
                | Command::Licences
                | Command::Lsp
                | Command::Completions(_)
                | Command::Explain(_)
                | Command::Help(_)
                | Command::Manual(_),
            )
            | None => false,
        };
        if is_data { Format::Json } else { Format::Full }
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
}
