//! `blocksim sweep`: a model over values of its parameters.

mod combinations;
mod kept;
mod measure;
mod rows;
mod told;

use std::io;

use blocksim_block::problem::Severity;

use self::combinations::Combinations;
use self::measure::{Failure, Measured, measure};
use super::tell;
use crate::args::model::{Format, ModelArgs};
use crate::args::sweep::SweepArgs;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::loaded::{Loaded, load};
use crate::running::{interrupt, parallel};
use crate::terminal::console::Console;
use crate::terminal::render::{self, plural};

/// One run: a value for each parameter, and what became of it.
pub struct Row<'a> {
    /// The values, in the order of the parameters.
    pub values: Vec<&'a str>,
    /// Its numbers.
    pub outcome: Result<Vec<Measured>, Failure>,
}

/// Runs a model over values of its parameters and tables what comes out.
///
/// # Errors
/// If the standard output cannot be written.
pub fn sweep(args: &SweepArgs, console: Console) -> io::Result<Exit> {
    let random = args.random.map(usize::from);
    let plan = match Combinations::of(&args.over, random, args.seed.unwrap_or(0)) {
        Ok(plan) => plan,
        Err(mistake) => {
            console.say(&format!("error: {mistake}"));
            return Ok(Exit::Usage);
        }
    };
    let runs = plan.runs();
    if let Some(file) = args.out.as_ref().filter(|file| file.exists() && !args.yes) {
        console.say(&format!(
            "error: `{}` is there already\n  = help: name another file, or add --yes to replace it",
            file.display()
        ));
        return Ok(Exit::Files);
    }
    // What is wrong with the model, and not with a value, is told once and before anything is run.
    let Some(first) = load(&model(args, &plan.values(0)), console) else { return Ok(Exit::Files) };
    let format = if args.json { Format::Json } else { Format::Full };
    tell(&first.compiled.problems, &first.files, format, console)?;
    if first.compiled.schedule.is_none() {
        console.say(&format!("{}; nothing was run", render::tally(&first.compiled.problems)));
        return Ok(Exit::Model);
    }
    if let Some(understood) = first.understood() {
        console.say(&format!("first run: {understood}"));
    }
    if let Some(Err(message)) = args.keep.as_deref().map(kept::folder) {
        console.say(&message);
        return Ok(Exit::Files);
    }
    interrupt::take_over();
    let numbers: Vec<usize> = (0..runs).collect();
    let workers = args.jobs.map_or_else(parallel::processors, usize::from);
    let live = console.live && !args.json;
    let rows = parallel::all(
        &numbers,
        workers,
        |number| one(args, &plan, *number, console),
        |done| {
            if live {
                console.rewrite(&format!("  {done} of {}", plural(runs, "run")));
            }
        },
    );
    if live {
        console.rewrite("");
    }
    finish(args, &rows, console)
}

/// Tells what came out of all runs.
fn finish(args: &SweepArgs, rows: &[Row], console: Console) -> io::Result<Exit> {
    // A variant may lack what others have; what fits no run at all is a mistake of the command line.
    let mistakes: Vec<&String> = rows
        .iter()
        .filter_map(|row| match &row.outcome {
            Err(Failure::Usage(mistake)) => Some(mistake),
            _ => None,
        })
        .collect();
    if let Some(mistake) = mistakes.first().filter(|_| mistakes.len() == rows.len()) {
        console.say(&format!("error: {mistake}"));
        return Ok(Exit::Usage);
    }
    let interrupted = rows.iter().any(|row| row.outcome == Err(Failure::Interrupted));
    let is_failed = |row: &&Row| matches!(row.outcome, Err(Failure::Simulation(_) | Failure::Usage(_)));
    let failed = rows.iter().filter(is_failed).count();
    let table = told::Sheet::of(&args.over, rows, args.keep.is_some());
    console.data(&if args.json {
        format!("{}\n", table.json())
    } else {
        table.text(console.width, args.random.is_some())
    })?;
    if let Some(file) = &args.out {
        if let Err(exit) = write_file(file, table.csv().as_bytes(), args.yes, console) {
            return Ok(exit);
        }
        console.say(&format!("the table is in {}", file.display()));
    }
    if let Some(folder) = &args.keep {
        console.say(&format!("the runs are in {0}; `blocksim runs {0}` lists them", folder.display()));
    }
    if interrupted {
        console.say("interrupted; runs without numbers were not finished");
        return Ok(Exit::Interrupted);
    }
    if failed > 0 {
        console.say(&format!("{} of {} have no numbers", failed, plural(rows.len(), "run")));
        return Ok(Exit::Failed);
    }
    Ok(Exit::Done)
}

/// Runs one combination.
fn one<'a>(args: &SweepArgs, plan: &'a Combinations, number: usize, console: Console) -> Row<'a> {
    let values = plan.values(number);
    if interrupt::is_requested() {
        return Row { values, outcome: Err(Failure::Interrupted) };
    }
    let model = model(args, &values);
    let place = args.keep.as_ref().map(|folder| folder.join(kept::name(number, plan.runs())));
    let outcome = match load(&model, console) {
        Some(mut loaded) => match loaded.compiled.schedule.take() {
            Some(schedule) => measure(&loaded, schedule, args, &model, place, console),
            None => Err(Failure::Simulation(refused(&loaded))),
        },
        None => Err(Failure::Simulation("the model can no longer be read".to_owned())),
    };
    Row { values, outcome }
}

/// The first error of a model.
fn refused(loaded: &Loaded) -> String {
    let problems = &loaded.compiled.problems;
    let first = problems.iter().find(|problem| problem.severity == Severity::Error).or(problems.first());
    first.map_or_else(|| "the model has errors".to_owned(), |problem| problem.message.clone())
}

/// The model with these values.
fn model(args: &SweepArgs, values: &[&str]) -> ModelArgs {
    let varied = args.over.iter().zip(values).map(|(over, value)| format!("{}={value}", over.target));
    ModelArgs { model: args.model.model.clone(), set: args.model.set.iter().cloned().chain(varied).collect() }
}
