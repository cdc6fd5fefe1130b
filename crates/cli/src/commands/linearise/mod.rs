//! `blocksim linearise`: the linear system around an operating point of a model, and what follows from it.

mod bode;
mod data;
mod facts;
mod locus;
mod matrices;
mod nyquist;
mod point;
mod pole_map;
mod report;
mod sampled;
mod signals;

use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_linear::{LinearError, Mode};

use self::facts::{Law, Way, Whole, all_growing, has_circle, ways, whole};
use self::locus::Locus;
use self::matrices::{Linearised, NoMatrices, Question};
use self::point::Lost;
use crate::args::linearise::{Chart, LineariseArgs};
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
    /// States that nothing acts on, by name.
    pub constant: Vec<String>,
    /// States that keep what is added to them, and that nothing else reads, by name.
    pub unread: Vec<String>,
    /// Whether all poles but theirs die out; `None` on the border.
    pub is_stable: Option<bool>,
    /// All poles of the system, without those of the constant states.
    pub modes: Vec<Mode>,
    /// How many of infinitely many poles grow, where dead times are in a model of which nothing but poles is asked.
    pub growing: Option<usize>,
    /// Why that is not known.
    pub undecided: Option<String>,
    /// To each output.
    pub ways: Vec<Way>,
    /// Where the poles go, if that is asked for.
    pub locus: Option<Locus>,
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
    let mut found = found(args, &schedule, question, &loaded)?;
    found.locus = match &args.locus {
        None => None,
        Some(None) => Some(locus::of_gain(&found)?),
        Some(Some(over)) => Some(locus::of_parameter(args, over, console)?),
    };
    let chart = chart(args, &found)?;
    if args.json {
        console.data(&format!("{}\n", data::json(&found, args.curves)))?;
    } else {
        console.data(&report::text(&found, console, !args.no_plot))?;
    }
    write(args, &found, chart, console)?;
    Ok(Exit::Done)
}

/// What is drawn.
fn chart(args: &LineariseArgs, found: &Found) -> Result<Chart, Failure> {
    let is_drawn = args.svg.is_some() || args.png.is_some();
    let fits = match args.chart {
        None if found.locus.is_some() => return Ok(Chart::Locus),
        None if found.question.from.is_none() => return Ok(Chart::Poles),
        None => return Ok(Chart::Bode),
        Some(chart) => chart,
    };
    if !is_drawn {
        return Err(Failure::usage("--chart needs a file").help("name one with --svg FILE or --png FILE"));
    }
    let has_signals = found.question.from.is_some();
    match fits {
        Chart::Locus if found.locus.is_none() => {
            Err(Failure::usage("a root locus needs to know what is varied").help(
                "add --locus for the gain of a loop, or --locus=TARGET=VALUES for a parameter, as in \
                 --locus=pid.kp=1..100/60log",
            ))
        }
        Chart::Bode | Chart::Nyquist if !has_signals => {
            Err(Failure::usage("there is no response without a signal")
                .help("name a loop to cut, --open, or a signal to begin at, --from and --to"))
        }
        Chart::Poles
            if found.ways.iter().any(|way| matches!(&way.law, Law::Dead(dead) if dead.is_circular)) =>
        {
            Err(Failure::usage("there are infinitely many poles, because of a dead time in a loop")
                .help("draw the response instead, --chart bode or --chart nyquist"))
        }
        chart => Ok(chart),
    }
}

/// Writes the files that were asked for.
fn write(args: &LineariseArgs, found: &Found, chart: Chart, console: Console) -> Result<(), Failure> {
    if let Some(file) = &args.csv {
        write_file(file, data::csv(found).as_bytes(), args.yes)?;
        console.say(&format!("the frequency response is in {}", file.display()));
    }
    if args.svg.is_none() && args.png.is_none() {
        return Ok(());
    }
    let theme = args.theme.into();
    let drawing = match chart {
        Chart::Bode => bode::drawing(found, theme),
        Chart::Nyquist => nyquist::drawing(found, theme),
        Chart::Poles => pole_map::drawing(found, theme),
        Chart::Locus => locus::drawing(found, theme),
    };
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
    let none = |none: NoMatrices| match none {
        NoMatrices::Simulation(error) => simulation(error),
        NoMatrices::Said(failure) => failure,
        NoMatrices::Interrupted => Failure::interrupted("nothing was linearised"),
    };
    let (linearised, t, adrift) = match args.sampled {
        Some(period) => {
            let when = sampled::When { at: args.at, period, steady: args.steady };
            sampled::linearise(schedule, &question, when).map_err(none)?
        }
        None => {
            let (frozen, adrift) = point::at(schedule, args.at, args.steady).map_err(|lost| match lost {
                Lost::Simulation(error) => simulation(error),
                Lost::Interrupted => Failure::interrupted("nothing was linearised"),
            })?;
            (matrices::linearise(frozen, &question).map_err(none)?, args.at, adrift)
        }
    };
    let wrong = |error: LinearError| Failure::new(Exit::Failed, "linearise", error.to_string());
    if question.from.is_none() && linearised.names.is_empty() && !has_circle(&linearised) {
        return Err(Failure::usage("the model has no states, and so no poles")
            .help("name a signal to begin at, --from, and some that answer, --to"));
    }
    let Whole { modes, constant, unread, is_stable } = whole(&linearised).map_err(wrong)?;
    let named =
        |states: Vec<usize>| states.into_iter().map(|state| linearised.names[state].clone()).collect();
    let (constant, unread) = (named(constant), named(unread));
    let is_bare = question.from.is_none() && !linearised.dead.is_empty();
    let (growing, undecided) = match is_bare.then(|| all_growing(&linearised)).transpose() {
        Ok(growing) => (growing.flatten(), None),
        // What is known of the rest is told all the same.
        Err(LinearError::Shape(why)) => (None, Some(why)),
        Err(error) => return Err(wrong(error)),
    };
    let ways = ways(&linearised, question.is_loop).map_err(wrong)?;
    let title = if schedule.title.is_empty() {
        args.model.model.file_stem().unwrap_or_default().to_string_lossy().into_owned()
    } else {
        schedule.title.clone()
    };
    let steady = args.steady;
    Ok(Found {
        title,
        question,
        t,
        steady,
        adrift,
        linearised,
        constant,
        unread,
        is_stable,
        modes,
        growing,
        undecided,
        ways,
        locus: None,
    })
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
        (Some(from), _) => Ok(Question { from: Some(from), to, open, is_loop: false }),
        (None, Some(first)) => {
            Ok(Question { to: vec![first.clone()], from: Some(first), open, is_loop: true })
        }
        (None, None) => Ok(Question { from: None, to, open, is_loop: false }),
    }
}
