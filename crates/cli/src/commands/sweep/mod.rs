//! `blocksim sweep`: a model over values of its parameters.

mod combinations;
mod measure;
mod rows;
mod runs;
mod sensitivity;
mod table;

use std::io;

use blocksim_block::problem::Problem;
use blocksim_block::shell::quoted;
use serde_json::json;

use self::combinations::Combinations;
use self::measure::{Lost, Measured, measure};
use crate::args::model::ModelArgs;
use crate::args::sweep::SweepArgs;
use crate::commands::tell;
use crate::disk::{free, write_file};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::{Loaded, load};
use crate::running::{interrupt, parallel};
use crate::terminal::console::Console;
use crate::terminal::render::plural;
use crate::trust::Purpose;

/// One run: a value for each parameter, and what became of it.
pub struct Row<'a> {
    /// The values, in the order of the parameters.
    pub values: Vec<&'a str>,
    /// Its numbers.
    pub outcome: Result<Vec<Measured>, Lost>,
}

/// Runs a model over values of its parameters and tables what comes out.
///
/// # Errors
/// What is wrong with the command line or the model, or what cannot be written.
pub fn sweep(args: &SweepArgs, console: Console) -> Outcome {
    if !args.sensitivity.is_empty() {
        return sensitivity::sensitivity(args, console);
    }
    if !args.of.is_empty() || args.svg.is_some() || args.png.is_some() {
        return Err(Failure::usage("--of, --svg and --png belong to --sensitivity")
            .help("measure with --metric, or name parameters with --sensitivity"));
    }
    let random = args.random.map(usize::from);
    let plan = Combinations::of(&args.over, random, args.seed.unwrap_or(0))?;
    let runs = plan.runs();
    if let Some(file) = &args.out {
        free(file, args.yes)?;
    }
    // What is wrong with the model, and not with a value, is told once and before anything is run.
    let first = sound(args, &plan, console)?;
    if let Some(understood) = first.understood() {
        console.say(&format!("first run: {understood}"));
    }
    args.keep.as_deref().map(runs::folder).transpose()?;
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
            if args.progress {
                console.say(&json!({ "v": 1, "type": "progress", "done": done, "of": runs }).to_string());
            }
        },
    );
    if live {
        console.rewrite("");
    }
    let (rows, warnings): (Vec<Row>, Vec<Vec<Problem>>) = rows.into_iter().unzip();
    tell_warnings(&warnings, console)?;
    finish(args, rows, console)
}

/// The model with the first values that it accepts, of some all over the combinations; where it accepts none, what is wrong with the first.
fn sound(args: &SweepArgs, plan: &Combinations, console: Console) -> Result<Loaded, Failure> {
    let runs = plan.runs();
    let tries = runs.min(TRIES);
    let numbers = (0..tries).map(|k| k * (runs - 1) / (tries - 1).max(1));
    let mut wrong = None;
    for number in numbers {
        let loaded = load(&model(args, &plan.values(number)), Purpose::Run);
        let sound = loaded.and_then(|mut loaded| match loaded.compiled.schedule {
            Some(_) => Ok(loaded),
            // Warnings are told of the model that is taken alone.
            None => loaded.take_schedule("nothing was run", console).map(|_| loaded),
        });
        match sound {
            Ok(mut loaded) => {
                loaded.take_schedule("nothing was run", console)?;
                return Ok(loaded);
            }
            Err(failure) => wrong = wrong.or(Some(failure)),
        }
    }
    wrong.map_or_else(|| Err(Failure::usage("there is nothing to run")), Err)
}

/// Combinations that are tried to tell a wrong value from a wrong model.
const TRIES: usize = 9;

/// Tells what blocks say of their approximations in the first run in which they say something, and in how many they do.
fn tell_warnings(of_runs: &[Vec<Problem>], console: Console) -> io::Result<()> {
    let mut found = of_runs.iter().filter(|warnings| !warnings.is_empty());
    let Some(first) = found.next() else { return Ok(()) };
    let note = format!("something like it in {} of {}", 1 + found.count(), plural(of_runs.len(), "run"));
    // Each run has read the texts anew, in which the places lie.
    let plain = |warning: &Problem| Problem { labels: Vec::new(), ..warning.clone() }.note(&*note);
    tell(&first.iter().map(plain).collect::<Vec<_>>(), &[], console)
}

/// Tells what came out of all runs.
fn finish(args: &SweepArgs, mut rows: Vec<Row>, console: Console) -> Outcome {
    // A variant may lack what others have; what fits no run at all is a mistake of the command line.
    let is_usage = |row: &Row| matches!(row.outcome, Err(Lost::Usage(_)));
    if !rows.is_empty()
        && rows.iter().all(is_usage)
        && let Err(Lost::Usage(problems)) = rows.swap_remove(0).outcome
    {
        return Err(Failure::of(Exit::Usage, problems, Vec::new()));
    }
    let interrupted = rows.iter().any(|row| matches!(row.outcome, Err(Lost::Interrupted)));
    let is_failed = |row: &&Row| matches!(row.outcome, Err(Lost::Simulation(_) | Lost::Usage(_)));
    let failed = rows.iter().filter(is_failed).count();
    let table = table::Sheet::of(&args.over, &rows, args.keep.is_some());
    console.data(&if args.json {
        format!("{}\n", table.json())
    } else {
        table.text(console.width, args.random.is_some())
    })?;
    if let Some(file) = &args.out {
        write_file(file, table.csv().as_bytes(), args.yes)?;
        console.say(&format!("the table is in {}", file.display()));
    }
    if let Some(folder) = &args.keep {
        console.say(&format!(
            "the runs are in {}; `blocksim runs {}` lists them",
            folder.display(),
            quoted(folder)
        ));
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
fn one<'a>(
    args: &SweepArgs,
    plan: &'a Combinations,
    number: usize,
    console: Console,
) -> (Row<'a>, Vec<Problem>) {
    let values = plan.values(number);
    if interrupt::is_requested() {
        return (Row { values, outcome: Err(Lost::Interrupted) }, Vec::new());
    }
    let model = model(args, &values);
    let place = args.keep.as_ref().map(|folder| folder.join(runs::name(number, plan.runs())));
    let mut warnings = Vec::new();
    let outcome = match load(&model, Purpose::Run) {
        Ok(mut loaded) => match loaded.compiled.schedule.take() {
            Some(schedule) => measure(&loaded, schedule, args, &model, place, &mut warnings, console),
            None => Err(Lost::Simulation(loaded.first_error())),
        },
        Err(failure) => Err(Lost::Simulation(failure.message())),
    };
    (Row { values, outcome }, warnings)
}

/// The model with these values.
fn model(args: &SweepArgs, values: &[&str]) -> ModelArgs {
    let varied = args.over.iter().zip(values).map(|(over, value)| format!("{}={value}", over.target));
    ModelArgs {
        model: args.model.model.clone(),
        set: args.model.set.iter().cloned().chain(varied).collect(),
        plugins: args.model.plugins,
    }
}
