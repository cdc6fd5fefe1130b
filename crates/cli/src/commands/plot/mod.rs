//! `blocksim plot`: signals of runs and tables over time, in the terminal and as files.

pub mod curves;
pub mod groups;
pub mod metrics;
pub mod panels;
mod terminal;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use blocksim_picture::{Theme, svg};
use blocksim_recording::Column;
use blocksim_signal::closest;

use self::curves::{Drawn, add_once, read};
use self::groups::{chosen, groups};
use self::panels::{figure, panel};
use crate::args::plot::PlotArgs;
use crate::args::values::RUNS;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::mechanism::recorded;
use crate::picture_file::{page, write_pictures};
use crate::signals::differences::tell_apart;
use crate::signals::traces::{Book, Mapping, check_mappings, mappings};
use crate::terminal::console::Console;

/// Most pictures in one file.
const PANELS: usize = 60;

/// Draws a run.
///
/// # Errors
/// What cannot be read, drawn or written.
pub fn plot(args: &PlotArgs, console: Console) -> Outcome {
    console.data(&drawn(args, console)?)?;
    Ok(Exit::Done)
}

fn drawn(args: &PlotArgs, console: Console) -> Result<String, Failure> {
    let maps = mappings(&args.map)?;
    let mut books = Vec::new();
    for name in std::iter::once(&args.run).chain(&args.with) {
        let mut book = open(name, &maps)?;
        book.show_in(&args.units);
        book.warnings().iter().for_each(|line| console.say(line));
        books.push(book);
    }
    check_mappings(&maps, &books)?;
    let title = tell_apart(&mut books);
    if books[0].traces.is_empty() && !args.json {
        let help = "add a Scope, or `record: [\"...\"]`, to its diagram and run it again";
        return Err(Failure::usage(format!("`{}` has no signals to draw", books[0].name)).help(help));
    }
    let range = range(args, &books)?;
    let selected = chosen(&books[0], &args.signals).map_err(|lost| no_signal(lost, &books[0]))?;
    for book in &books[1..] {
        let paths = || selected.iter().map(|&at| books[0].traces[at].path.as_str());
        if !paths().any(|path| book.find(path).is_some()) {
            return Err(nothing_common(book, paths().next().unwrap_or_default()));
        }
    }
    let mut all: Vec<Drawn> = Vec::new();
    let groups = groups(&books[0], &selected, args.layout);
    let left = groups.len().saturating_sub(PANELS);
    for group in groups.into_iter().take(PANELS) {
        add_once(&mut all, read(group, &books, &range)?);
    }
    if args.signals.is_empty() {
        leave_joints(&mut all, &books[0], &joints(&args.run));
    }
    if left > 0 {
        console.say(&format!("note: {left} more pictures are left out; choose signals to see them"));
    }
    // Who names a signal wants its numbers, whether it follows another one or not.
    let alone = !args.signals.is_empty() || all.iter().all(|drawn| drawn.group.pairs.is_empty());
    let rows =
        if args.metrics || args.json { metrics::rows(&all, &books, &range, alone)? } else { Vec::new() };
    let mut text = String::new();
    if args.svg.is_some() || args.png.is_some() {
        let panels = all.iter().map(|drawn| panel(drawn, &books, &range)).collect();
        let time = (*range.start(), *range.end());
        let figure = figure(panels, title, time, args.columns, args.width);
        let drawing = svg(&page(&figure, args.page, console)?, Theme::from(args.theme));
        let written =
            write_pictures(&drawing, args.svg.as_deref(), args.png.as_deref(), args.scale, args.yes);
        for file in written? {
            text.push_str(&format!("{}\n", file.display()));
        }
    } else if !args.json && !args.metrics {
        text = terminal::plots(&all, &books, console);
    }
    if args.json {
        return Ok(format!("{}\n", metrics::json(&rows)));
    }
    if args.metrics {
        if rows.is_empty() {
            console.say("note: none of these signals has two values or more in this time");
        } else {
            text.push_str(&metrics::table(&rows, books.len() > 1));
        }
    }
    Ok(text)
}

/// Opens a run or a table by path or name.
///
/// # Errors
/// Why it cannot be read.
pub fn open(name: &str, maps: &[Mapping]) -> Result<Book, Failure> {
    let path: PathBuf = locate(name)?;
    Book::open(&path, maps)
}

fn locate(name: &str) -> Result<PathBuf, Failure> {
    blocksim_recording::locate(name, Path::new(RUNS)).map_err(|error| Failure::of_run(&error))
}

/// Signals that only the 3D view of a run needs.
fn joints(run: &str) -> Vec<String> {
    let scene = locate(run).ok().and_then(|folder| recorded::scene(&folder).ok().flatten());
    scene.and_then(|scene| recorded::signals(&scene).ok()).unwrap_or_default()
}

/// Leaves pictures of joints away whose positions other pictures show: nobody asked for them.
fn leave_joints(all: &mut Vec<Drawn>, book: &Book, joints: &[String]) {
    let is_joint =
        |drawn: &Drawn| drawn.group.traces.iter().all(|&at| joints.contains(&book.traces[at].path));
    let (asked, unasked): (Vec<Drawn>, Vec<Drawn>) = all.drain(..).partition(|drawn| !is_joint(drawn));
    let is_shown = |drawn: &Drawn, column: &Column| {
        let same = |other: &Column| other.time == column.time && other.values == column.values;
        asked.iter().any(|other| other.group.unit == drawn.group.unit && other.columns.iter().any(same))
    };
    let new = |drawn: &Drawn| !drawn.columns.iter().all(|column| is_shown(drawn, column));
    let rest: Vec<Drawn> = unasked.into_iter().filter(new).collect();
    *all = asked.into_iter().chain(rest).collect();
}

/// What is shown: what the options say, else all that there is.
fn range(args: &PlotArgs, books: &[Book]) -> Result<RangeInclusive<f64>, Failure> {
    let spans: Vec<(f64, f64)> = books.iter().filter_map(Book::span).collect();
    let Some(span) = spans.into_iter().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else {
        let help = "run the model, or export the table, again";
        return Err(Failure::unreadable(format!("`{}` has no values", books[0].name)).help(help));
    };
    let (from, to) = (args.from.unwrap_or(span.0), args.to.unwrap_or(span.1));
    if from > to || from > span.1 || to < span.0 {
        let asked = match (args.from, args.to) {
            (Some(from), Some(to)) => format!("from {from} s to {to} s"),
            (Some(from), None) => format!("from {from} s on"),
            _ => format!("up to {to} s"),
        };
        let help = format!("`{}` goes from {} s to {} s", books[0].name, span.0, span.1);
        return Err(Failure::usage(format!("there are no values {asked}")).help(help));
    }
    Ok(from..=to)
}

/// Tells that no signal fits a pattern.
pub fn no_signal(lost: &str, book: &Book) -> Failure {
    let paths: Vec<&str> = book.traces.iter().map(|trace| trace.path.as_str()).collect();
    // Who names a part of a path may have mistyped that.
    let parts = paths.iter().flat_map(|path| path.split(['/', '.']));
    let help = match closest(lost, paths.iter().copied().chain(parts)) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => {
            let more = if paths.len() > 5 { ", ..." } else { "" };
            format!("it has {}{more}", paths.iter().take(5).copied().collect::<Vec<_>>().join(", "))
        }
    };
    Failure::usage(format!("no signal of `{}` fits `{lost}`", book.name)).help(help)
}

/// Tells that a recording has none of the signals.
pub fn nothing_common(book: &Book, example: &str) -> Failure {
    let names: Vec<String> = book.traces.iter().take(8).map(|trace| format!("`{}`", trace.path)).collect();
    let column = book.traces.first().map_or("COLUMN", |trace| trace.path.as_str());
    Failure::usage(format!("`{}` has none of the requested signals", book.name))
        .help(format!("it has {}; name them, such as --map '{column}={example}'", names.join(", ")))
}
