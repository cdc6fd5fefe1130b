//! `blocksim`: simulates block diagrams written as text, as a library of one function.
//!
//! This file parses the command line and dispatches; `commands` has one function for each verb. Data goes to the
//! standard output, what is said to people about it to the standard error.

// Blocks register themselves when they are linked, and only crates that are named are linked.
use blocksim_blocks as _;
use blocksim_host as _;

mod args;
mod bug;
mod commands;
mod disk;
mod editing;
mod exit;
mod failure;
mod home;
#[cfg_attr(
    all(feature = "lsp", feature = "parquet", feature = "png", feature = "xlsx", not(test)),
    expect(dead_code, reason = "nothing is left out")
)]
mod left_out;
mod loaded;
mod mechanism;
mod picture_file;
mod running;
mod scene;
mod seal;
mod search;
mod signals;
mod terminal;
mod trust;
mod usage;
mod watch;

use std::process::ExitCode;

use clap::Parser;

use crate::args::model::Format;
use crate::args::{Args, Command};
use crate::failure::Outcome;
use crate::running::{interrupt, rescue};
use crate::terminal::console::{Colour, Console};
use crate::trust::Purpose;

/// Does what the command line asks for.
pub fn main() -> ExitCode {
    bug::report_panics();
    interrupt::survive_full_files();
    let args = match Args::try_parse() {
        Ok(args) => args,
        Err(error) => {
            let is_data = usage::asks_for_data(std::env::args_os());
            let format = if is_data { Format::Json } else { Format::Full };
            let console = Console::of_process(Colour::Auto, false, format);
            return usage::tell(&error, console, is_data).into();
        }
    };
    let console = Console::of_process(args.color, args.ascii, args.format());
    rescue::prepare(console);
    let exit = done(&args, console).unwrap_or_else(|failure| failure.tell(console));
    blocksim_host::end(exit.code());
    exit.into()
}

/// What one verb does.
fn done(args: &Args, console: Console) -> Outcome {
    match &args.command {
        None => commands::hints(console),
        Some(Command::New(args)) => commands::new(args, console),
        Some(Command::Run(args)) if args.watch => {
            Ok(watch::watch(&args.model, Purpose::Run, console, || commands::run(args, console)))
        }
        Some(Command::Run(args)) => commands::run(args, console),
        Some(Command::Studio(args)) => commands::studio(args, console),
        Some(Command::Report(args)) => commands::report(args, console),
        Some(Command::Plot(args)) => commands::plot(args, console),
        Some(Command::Grade(args)) => commands::grade(args, console),
        Some(Command::Compare(args)) => commands::compare(args, console),
        Some(Command::Collisions(args)) => commands::collisions(args, console),
        Some(Command::Check(args)) if args.watch => {
            Ok(watch::watch(&args.model, Purpose::Look, console, || commands::check(args, console)))
        }
        Some(Command::Check(args)) => commands::check(args, console),
        Some(Command::Fmt(args)) => commands::fmt(args, console),
        Some(Command::Runs(args)) => commands::runs(args, console),
        Some(Command::Sweep(args)) => commands::sweep(args, console),
        Some(Command::Linearise(args)) => commands::linearise(args, console),
        Some(Command::Export(args)) => commands::export(args, console),
        Some(Command::Emit(args)) => commands::emit(args, console),
        Some(Command::Graph(args)) => commands::graph(args, console),
        Some(Command::Import(args)) => commands::import(args, console),
        Some(Command::Lsp) => commands::lsp(),
        Some(Command::Blocks(args)) => commands::blocks(args, console),
        Some(Command::Licences) => commands::licences(console),
        Some(Command::Trust(args)) => commands::trust(args, console),
        Some(Command::Doctor(args)) => commands::doctor(args, console),
        Some(Command::Completions(args)) => commands::completions(args, console),
        Some(Command::Explain(args)) => commands::explain(args, console),
        Some(Command::Help(args)) => commands::help(args, console),
        Some(Command::Manual(args)) => commands::manual(args, console),
        Some(Command::Identify(command)) => commands::identify(command, console),
        Some(Command::Plan(command)) => commands::plan(command, console),
        Some(Command::Plugin(command)) => commands::plugin(command, console),
        Some(Command::Params(command)) => commands::params(command, console),
        Some(Command::Edit(command)) => commands::edit(command, console),
    }
}
