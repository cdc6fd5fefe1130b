//! `blocksim compare`: whether two recordings agree.

mod table;
mod verdict;

use blocksim_analysis::{Series, lag};
use blocksim_picture::{Theme, svg};
use blocksim_recording::{ALWAYS, Column};

use self::table::Comparison;
use self::verdict::judge;
use super::plot::{no_signal, nothing_common, open};
use super::report::{Other, page_beside, written_beside};
use crate::args::plot::{Align, CompareArgs};
use crate::args::report::ReportArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::picture_file::{page, write_pictures};
use crate::signals::differences::tell_apart;
use crate::signals::naming::fits;
use crate::signals::other::other_values;
use crate::signals::traces::{Book, Mapping, check_mappings, mappings};
use crate::terminal::console::Console;

/// Most signals whose correlation is taken.
const ALIGNED_BY: usize = 6;

/// Compares two recordings.
///
/// # Errors
/// What cannot be read, compared or written.
pub fn compare(args: &CompareArgs, console: Console) -> Outcome {
    let (text, exit) = compared(args, console)?;
    console.data(&text)?;
    Ok(exit)
}

/// A page with a run and another one in thinner lines, as far as both go.
///
/// # Errors
/// What cannot be read or compared.
pub fn page_of_both(baseline: &str, other: &str, console: Console) -> Result<String, Failure> {
    let args = CompareArgs::of(baseline.to_owned(), other.to_owned());
    let (books, title) = books(&args, &[], console)?;
    let outcome = comparison(&args, &books, title, console)?;
    let other = Other { book: &books[1], shift: outcome.shift, compared: outcome.compared() };
    page_beside(&ReportArgs::of(args.baseline.clone()), other, console)
}

/// Both recordings, and what a picture of them is called.
fn books(args: &CompareArgs, maps: &[Mapping], console: Console) -> Result<([Book; 2], String), Failure> {
    let mut books = [open(&args.baseline, maps)?, open(&args.other, maps)?];
    check_mappings(maps, &books)?;
    let title = tell_apart(&mut books);
    for book in &books {
        book.warnings().iter().for_each(|line| console.say(line));
        if book.span().is_none() {
            let said = format!("`{}` has no values", book.name);
            return Err(Failure::unreadable(said).help("run the model, or export the table, again"));
        }
    }
    Ok((books, title))
}

fn comparison<'a>(
    args: &'a CompareArgs,
    books: &'a [Book; 2],
    title: String,
    console: Console,
) -> Result<Comparison<'a>, Failure> {
    let chosen = chosen(args, books)?;
    say_units(&chosen, books, console);
    let shift = shift(args, books, &chosen)?;
    let found: Result<Vec<_>, Failure> = chosen.iter().map(|&at| judge(args, books, at, shift)).collect();
    let extra = books[1].traces.iter().map(|trace| &trace.path).filter(|path| books[0].find(path).is_none());
    let extra = if args.signals.is_empty() { extra.cloned().collect() } else { Vec::new() };
    Ok(Comparison { args, books, title, found: found?, shift, extra })
}

fn compared(args: &CompareArgs, console: Console) -> Result<(String, Exit), Failure> {
    let maps = mappings(&args.map)?;
    let (books, title) = books(args, &maps, console)?;
    let outcome = comparison(args, &books, title, console)?;

    let mut text = if args.json { format!("{}\n", outcome.json()) } else { outcome.text() };
    if args.svg.is_some() || args.png.is_some() {
        let drawing = svg(&page(&outcome.figure()?, args.page, console)?, Theme::from(args.theme));
        let written = write_pictures(&drawing, args.svg.as_deref(), args.png.as_deref(), 2.0, args.yes);
        for file in written? {
            let line = format!("{}\n", file.display());
            if args.json { console.say(line.trim_end()) } else { text.push_str(&line) }
        }
    }
    if let Some(file) = &args.html {
        let page =
            ReportArgs { out: Some(file.clone()), yes: args.yes, ..ReportArgs::of(args.baseline.clone()) };
        let other = Other { book: &books[1], shift: outcome.shift, compared: outcome.compared() };
        let file = written_beside(&page, &maps, other, console)?;
        let line = format!("{}\n", file.display());
        if args.json { console.say(line.trim_end()) } else { text.push_str(&line) }
    }
    Ok((text, if outcome.agrees() { Exit::Done } else { Exit::Failed }))
}

/// Signals of the baseline that are compared.
fn chosen(args: &CompareArgs, books: &[Book; 2]) -> Result<Vec<usize>, Failure> {
    let paths: Vec<&str> = books[0].traces.iter().map(|trace| trace.path.as_str()).collect();
    if let Some(lost) = args.signals.iter().find(|pattern| !paths.iter().any(|path| fits(path, pattern))) {
        return Err(no_signal(lost, &books[0]));
    }
    let wanted =
        |path: &str| args.signals.is_empty() || args.signals.iter().any(|pattern| fits(path, pattern));
    let chosen: Vec<usize> = (0..paths.len()).filter(|&at| wanted(paths[at])).collect();
    if !chosen.iter().any(|&at| books[1].find(paths[at]).is_some()) {
        return Err(nothing_common(&books[1], chosen.first().map_or("PATH", |&at| paths[at])));
    }
    Ok(chosen)
}

/// Says which columns without a unit are taken to be in which.
fn say_units(chosen: &[usize], books: &[Book; 2], console: Console) {
    for (without, with) in [(1, 0), (0, 1)] {
        let bare = chosen.iter().filter_map(|&at| {
            let trace = &books[0].traces[at];
            let there = books[1].find(&trace.path).filter(|&there| books[1].is_readable(there))?;
            let both = [trace, &books[1].traces[there]];
            let unit = both[with].unit.to_string();
            let is_assumed = both[with].has_unit && !both[without].has_unit && unit != "1";
            is_assumed.then(|| format!("`{}` in {unit}", trace.path))
        });
        let bare: Vec<String> = bare.collect();
        if !bare.is_empty() {
            let more = if bare.len() > 4 { " and so on" } else { "" };
            let some = bare.iter().take(4).cloned().collect::<Vec<_>>().join(", ");
            console.say(&format!("note: `{}` has no units; assuming {some}{more}", books[without].name));
        }
    }
}

/// What to add to the times of the other recording, s.
fn shift(args: &CompareArgs, books: &[Book; 2], chosen: &[usize]) -> Result<f64, Failure> {
    let begin = |book: &Book| book.span().map_or(0.0, |span| span.0);
    match args.align {
        None => Ok(args.shift.unwrap_or(0.0)),
        Some(Align::Start) => Ok(begin(&books[0]) - begin(&books[1])),
        Some(Align::Correlation) => {
            let mut columns: Vec<(Column, Column)> = Vec::new();
            for &at in chosen {
                let trace = &books[0].traces[at];
                if let Some(there) = books[1].find(&trace.path)
                    && columns.len() < ALIGNED_BY
                {
                    let a = books[0].read(at, &ALWAYS)?;
                    let b = other_values(&books[1], there, trace, 0.0)?;
                    // A constant tells nothing about time.
                    if a.values.iter().any(|value| *value != a.values[0]) {
                        columns.push((a, b));
                    }
                }
            }
            let pairs: Vec<(Series, Series)> = columns
                .iter()
                .map(|(a, b)| (Series::new(&a.time, &a.values), Series::new(&b.time, &b.values)))
                .collect();
            lag(&pairs).ok_or_else(|| {
                Failure::usage("the signals are constant, so their time shift cannot be found")
                    .help("choose others with --signals, or give --shift")
            })
        }
    }
}
