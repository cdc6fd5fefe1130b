//! `blocksim linearise`: the linear system around an operating point of a model, and what is told of it.

mod bode;
mod data;
mod facts;
mod matrices;
mod point;
mod report;
mod signals;

use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_linear::{LinearError, Mode};

use self::facts::{Way, all_modes, ways};
use self::matrices::{Linearised, NoMatrices, Question};
use self::point::Lost;
use crate::args::linearise::LineariseArgs;
use crate::disk::{free, write_file};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::{Loaded, load_to_watch};
use crate::picture_file::write_pictures;
use crate::running::blame::failure;
use crate::running::interrupt;
use crate::terminal::console::Console;
use crate::terminal::format::short_time;
use crate::trust::Purpose;

/// All that was found.
pub struct Found {
    /// Title of the diagram.
    pub title: String,
    /// What was asked for.
    pub question: Question,
    /// Instant of the operating point, s.
    pub t: f64,
    /// Whether nothing moves there.
    pub steady: bool,
    /// States that move all the same, as nothing depends on them.
    pub adrift: Vec<String>,
    /// The matrices.
    pub linearised: Linearised,
    /// All poles of the system.
    pub modes: Vec<Mode>,
    /// To each output.
    pub ways: Vec<Way>,
}

/// Linearises a model and tells poles, zeros, margins and frequency responses.
///
/// # Errors
/// What is wrong with the command line or the model, or what cannot be written.
pub fn linearise(args: &LineariseArgs, console: Console) -> Outcome {
    for file in [&args.csv, &args.svg, &args.png].into_iter().flatten() {
        free(file, args.yes)?;
    }
    let watched: Vec<String> = args.to.iter().chain(&args.open).chain(&args.from).cloned().collect();
    let mut loaded = load_to_watch(&args.model, Purpose::Run, &watched)?;
    let schedule = loaded.take_schedule("nothing was linearised", console)?;
    if let Some(understood) = loaded.understood() {
        console.say(&understood);
    }
    let schedule = Arc::new(schedule);
    let question = asked(args, &schedule)?;
    interrupt::take_over();
    let found = found(args, &schedule, question, &loaded)?;
    if args.json {
        console.data(&format!("{}\n", data::json(&found)))?;
    } else {
        console.data(&report::text(&found, console, !args.no_plot))?;
    }
    write(args, &found, console)?;
    Ok(Exit::Done)
}

/// Writes the files that were asked for.
fn write(args: &LineariseArgs, found: &Found, console: Console) -> Result<(), Failure> {
    if let Some(file) = &args.csv {
        write_file(file, data::csv(found).as_bytes(), args.yes)?;
        console.say(&format!("the frequency response is in {}", file.display()));
    }
    if args.svg.is_none() && args.png.is_none() {
        return Ok(());
    }
    let drawing = bode::drawing(found, args.theme.into());
    for file in write_pictures(&drawing, args.svg.as_deref(), args.png.as_deref(), args.scale, args.yes)? {
        console.say(&format!("the drawing is in {}", file.display()));
    }
    Ok(())
}

fn found(
    args: &LineariseArgs,
    schedule: &Arc<Schedule>,
    question: Question,
    loaded: &Loaded,
) -> Result<Found, Failure> {
    let simulation = |error| Failure::of(Exit::Failed, vec![failure(&error, schedule)], loaded.files.clone());
    let (frozen, adrift) = point::at(schedule, args.at, args.steady).map_err(|lost| match lost {
        Lost::Simulation(error) => simulation(error),
        Lost::Interrupted => Failure::interrupted("nothing was linearised"),
    })?;
    let linearised = matrices::linearise(frozen, &question).map_err(|none| match none {
        NoMatrices::Simulation(error) => simulation(error),
        NoMatrices::Said(failure) => failure,
    })?;
    let wrong = |error: LinearError| Failure::new(Exit::Failed, "linearise", error.to_string());
    let modes = all_modes(&linearised).map_err(wrong)?;
    let ways = ways(&linearised, question.is_loop).map_err(wrong)?;
    let title = if schedule.title.is_empty() {
        args.model.model.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    } else {
        schedule.title.clone()
    };
    Ok(Found { title, question, t: args.at, steady: args.steady, adrift, linearised, modes, ways })
}

/// What the command line asks for, in terms of the model.
fn asked(args: &LineariseArgs, schedule: &Schedule) -> Result<Question, Failure> {
    let stop = schedule.settings.stop_time;
    if args.at < 0.0 {
        return Err(Failure::usage("--at is an instant of a run, which begins at 0 s"));
    }
    if args.at > stop {
        let said =
            format!("the run is over at {} s, before --at {} s", short_time(stop), short_time(args.at));
        return Err(Failure::usage(said)
            .help("name an earlier instant, or let the diagram run longer with `stop_time`"));
    }
    let find = |name: &String| signals::find(schedule, name);
    let open = args.open.iter().map(find).collect::<Result<Vec<_>, _>>()?;
    let to = args.to.iter().map(find).collect::<Result<Vec<_>, _>>()?;
    let from = args.from.as_ref().map(find).transpose()?;
    match (from, open.first().cloned()) {
        (Some(from), _) => Ok(Question { from, to, open, is_loop: false }),
        (None, Some(first)) => Ok(Question { to: vec![first.clone()], from: first, open, is_loop: true }),
        (None, None) => Err(Failure::usage("name a signal to begin at, --from, or a loop to cut, --open")),
    }
}
