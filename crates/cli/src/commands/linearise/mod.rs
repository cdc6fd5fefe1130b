//! `blocksim linearise`: the linear system around an operating point of a model, and what is told of it.

mod data;
mod drawn;
mod facts;
mod matrices;
mod point;
mod signals;
mod told;

use std::io;
use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_linear::Mode;
use blocksim_sim::SimError;

use self::facts::{Way, all_modes, ways};
use self::matrices::{Linearised, NoMatrices, Question};
use self::point::Lost;
use super::tell;
use crate::args::linearise::LineariseArgs;
use crate::args::model::Format;
use crate::disk::write_file;
use crate::exit::Exit;
use crate::loaded::{Loaded, load};
use crate::picture_file::write_pictures;
use crate::running::blame::failure;
use crate::running::interrupt;
use crate::terminal::console::Console;
use crate::terminal::format::short_time;
use crate::terminal::render;

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
/// If the standard output cannot be written.
pub fn linearise(args: &LineariseArgs, console: Console) -> io::Result<Exit> {
    for file in [&args.csv, &args.svg, &args.png].into_iter().flatten() {
        if file.exists() && !args.yes {
            console.say(&format!(
                "error: `{}` is there already\n  = help: name another file, or add --yes to replace it",
                file.display()
            ));
            return Ok(Exit::Files);
        }
    }
    let Some(mut loaded) = load(&args.model, console) else { return Ok(Exit::Files) };
    let format = if args.json { Format::Json } else { Format::Full };
    tell(&loaded.compiled.problems, &loaded.files, format, console)?;
    let Some(schedule) = loaded.compiled.schedule.take() else {
        console.say(&format!("{}; nothing was linearised", render::tally(&loaded.compiled.problems)));
        return Ok(Exit::Model);
    };
    if let Some(understood) = loaded.understood() {
        console.say(&understood);
    }
    let schedule = Arc::new(schedule);
    let question = match asked(args, &schedule) {
        Ok(question) => question,
        Err(mistake) => {
            console.say(&format!("error: {mistake}"));
            return Ok(Exit::Usage);
        }
    };
    interrupt::take_over();
    let found = match found(args, &schedule, question) {
        Ok(found) => found,
        Err(Failure::Said(said)) => {
            console.say(&format!("error: {said}"));
            return Ok(Exit::Failed);
        }
        Err(Failure::Interrupted) => {
            console.say("interrupted; nothing was linearised");
            return Ok(Exit::Interrupted);
        }
        Err(Failure::Simulation(error)) => return failed(&error, &schedule, &loaded, format, console),
    };
    if args.json {
        console.data(&format!("{}\n", data::json(&found)))?;
    } else {
        console.data(&told::text(&found, console, !args.no_plot))?;
    }
    Ok(write(args, &found, console))
}

/// Writes the files that were asked for.
fn write(args: &LineariseArgs, found: &Found, console: Console) -> Exit {
    if let Some(file) = &args.csv {
        if let Err(exit) = write_file(file, data::csv(found).as_bytes(), args.yes, console) {
            return exit;
        }
        console.say(&format!("the frequency response is in {}", file.display()));
    }
    if args.svg.is_none() && args.png.is_none() {
        return Exit::Done;
    }
    let drawing = drawn::drawing(found, args.theme.into());
    match write_pictures(&drawing, args.svg.as_deref(), args.png.as_deref(), args.scale, args.yes) {
        Ok(files) => {
            for file in files {
                console.say(&format!("the drawing is in {}", file.display()));
            }
            Exit::Done
        }
        Err(said) => {
            console.say(&said);
            Exit::Files
        }
    }
}

/// Why nothing was found.
enum Failure {
    Simulation(SimError),
    Interrupted,
    Said(String),
}

impl From<Lost> for Failure {
    fn from(lost: Lost) -> Failure {
        match lost {
            Lost::Simulation(error) => Failure::Simulation(error),
            Lost::Interrupted => Failure::Interrupted,
        }
    }
}

impl From<NoMatrices> for Failure {
    fn from(none: NoMatrices) -> Failure {
        match none {
            NoMatrices::Simulation(error) => Failure::Simulation(error),
            NoMatrices::Said(said) => Failure::Said(said),
        }
    }
}

fn found(args: &LineariseArgs, schedule: &Arc<Schedule>, question: Question) -> Result<Found, Failure> {
    let (frozen, adrift) = point::at(schedule, args.at, args.steady)?;
    let linearised = matrices::linearise(frozen, &question)?;
    let wrong = |error: blocksim_linear::LinearError| Failure::Said(error.to_string());
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
fn asked(args: &LineariseArgs, schedule: &Schedule) -> Result<Question, String> {
    let stop = schedule.settings.stop_time;
    if args.at < 0.0 {
        return Err("--at is an instant of a run, which begins at 0 s".to_owned());
    }
    if args.at > stop {
        return Err(format!(
            "the run is over at {} s, before --at {} s\n  = help: name an earlier instant, or let the diagram run longer with \
             `stop_time`",
            short_time(stop),
            short_time(args.at)
        ));
    }
    let find = |name: &String| signals::find(schedule, name);
    let open = args.open.iter().map(find).collect::<Result<Vec<_>, _>>()?;
    let to = args.to.iter().map(find).collect::<Result<Vec<_>, _>>()?;
    let from = args.from.as_ref().map(find).transpose()?;
    match (from, open.first().cloned()) {
        (Some(from), _) => Ok(Question { from, to, open, is_loop: false }),
        (None, Some(first)) => Ok(Question { to: vec![first.clone()], from: first, open, is_loop: true }),
        (None, None) => Err("name a signal to begin at, --from, or a loop to cut, --open".to_owned()),
    }
}

/// Tells why the simulation could not go on.
fn failed(
    error: &SimError,
    schedule: &Schedule,
    loaded: &Loaded,
    format: Format,
    console: Console,
) -> io::Result<Exit> {
    tell(&[failure(error, schedule)], &loaded.files, format, console)?;
    Ok(Exit::Failed)
}
