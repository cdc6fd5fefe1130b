//! `blocksim report`: a run as one HTML file.

mod beside;
pub mod diagram;
mod facts;
pub mod meshes;
mod model;
mod movement;
mod numbers;
mod other_signals;
mod pictures;
mod sections;
mod source_text;
mod tables;
mod titles;

pub use beside::Other;

use std::io;
use std::path::{Path, PathBuf};

use blocksim_blocks::robotics::Surroundings;
use blocksim_diagram::Sources;
use blocksim_recording::{ResultsError, Run, locate, read_foreign_file, write_whole};
use blocksim_report::{BUDGET, Event, Overlay, Report, html};

use self::titles::Titles;
use crate::args::report::{ReportArgs, Section};
use crate::args::values::RUNS;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::mechanism::surroundings;
use crate::signals::measured;
use crate::signals::traces::{Book, Mapping};
use crate::terminal::browser;
use crate::terminal::console::Console;

/// Name of the file in the folder of its run.
pub const NAME: &str = "report.html";
/// Values of all measurements that a page takes.
const MOST_MEASURED: usize = 2_000_000;

/// Writes the report of a run.
///
/// # Errors
/// What cannot be read or written.
pub fn report(args: &ReportArgs, console: Console) -> Outcome {
    let file = written(args, console)?;
    console.data(&format!("{}\n", file.display()))?;
    Ok(Exit::Done)
}

/// Writes the page; returns its place.
///
/// # Errors
/// What cannot be read or written.
pub fn written(args: &ReportArgs, console: Console) -> Result<PathBuf, Failure> {
    let path = locate(&args.run, Path::new(RUNS)).map_err(|error| Failure::of_run(&error))?;
    let target = target(args, &path)?;
    let file = kept(&gathered(args, &path, &[], console)?, &target, console)?;
    if args.open {
        browser::open(&file, console);
    }
    Ok(file)
}

/// The page of a run as text.
///
/// # Errors
/// What cannot be read.
pub fn page(args: &ReportArgs, console: Console) -> Result<String, Failure> {
    Ok(html(&gathered(args, Path::new(&args.run), &[], console)?))
}

/// Writes the page of a recording with another one beside it; returns its place. Its columns are named by `maps`.
///
/// # Errors
/// What cannot be read or written.
pub fn written_beside(
    args: &ReportArgs,
    maps: &[Mapping],
    other: Other,
    console: Console,
) -> Result<PathBuf, Failure> {
    let path = locate(&args.run, Path::new(RUNS)).map_err(|error| Failure::of_run(&error))?;
    let target = target(args, &path)?;
    let mut report = gathered(args, &path, maps, console)?;
    beside::add(&Book::open(&path, maps)?, other, &mut report)?;
    kept(&report, &target, console)
}

/// The page of a run with another one beside it as text.
///
/// # Errors
/// What cannot be read.
pub fn page_beside(args: &ReportArgs, other: Other, console: Console) -> Result<String, Failure> {
    let path = locate(&args.run, Path::new(RUNS)).map_err(|error| Failure::of_run(&error))?;
    let mut report = gathered(args, &path, &[], console)?;
    beside::add(&Book::open(&path, &[])?, other, &mut report)?;
    Ok(html(&report))
}

/// Writes the page.
fn kept(report: &Report, (folder, name): &(PathBuf, String), console: Console) -> Result<PathBuf, Failure> {
    let page = html(report);
    if !report.full && page.len() > BUDGET {
        console.say(&format!(
            "note: the page has {} kB\n  = help: `--no-3d` and fewer recorded signals make it smaller",
            page.len() / 1000
        ));
    }
    write_whole(folder, name, |out| out.write_all(page.as_bytes())).map_err(|error| {
        let reason = match &error {
            ResultsError::Io { source, .. } if source.kind() == io::ErrorKind::NotFound => {
                "nothing can be written there".to_owned()
            }
            _ => error.reason(),
        };
        let file = folder.join(name);
        Failure::unwritable(format!("cannot write `{}`: {reason}", file.display()))
            .help("choose another place with -o")
    })
}

/// Folder and name of the file, which must not be there.
fn target(args: &ReportArgs, run: &Path) -> Result<(PathBuf, String), Failure> {
    let file = match &args.out {
        Some(file) => file.clone(),
        None if run.is_dir() => run.join(NAME),
        None => run.with_extension("html"),
    };
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let refused = |reason: &str, help: &str| {
        Err(Failure::unwritable(format!("cannot write `{}`: {reason}", file.display())).help(help))
    };
    let Some(name) = file.file_name() else { return refused("it names no file", "add a name") };
    if !folder.is_dir() {
        return refused("the folder does not exist", "create it, or choose another place with -o");
    }
    if file.is_dir() {
        return refused("it is a folder", "add the name of a file");
    }
    // The report in the folder of its run is made of nothing but the run; a new one replaces no work.
    if file.exists() && !args.yes && args.out.is_some() {
        return refused("it already exists", "choose another name, or replace it with --yes");
    }
    Ok((folder.to_owned(), name.to_string_lossy().into_owned()))
}

/// All that is shown.
fn gathered(args: &ReportArgs, path: &Path, maps: &[Mapping], console: Console) -> Result<Report, Failure> {
    sections::check(args)?;
    let book = Book::open(path, maps)?;
    let run = Run::open(path).map_err(|error| Failure::of_run(&error))?;
    let mut report = Report { full: args.full, title: book.name.clone(), ..Report::default() };
    if let Some(shortfall) = run.shortfall() {
        report.warnings.push(format!("This run is not whole: {shortfall}."));
    }
    sections::tell(args, &mut report);
    facts::add(&run, path, &mut report);
    let books = [book];
    let text = run.manifest().and_then(|manifest| model::text(path, manifest, &mut report));
    let sources = text.as_ref().map(|text| Sources::new(&*text.reader));
    let known = text.as_ref().zip(sources.as_ref());
    let model = known.and_then(|(text, sources)| model::read(text, sources, &mut report));
    let titles = model.as_ref().map(Titles::of).unwrap_or_default();
    pictures::add(&books, &titles, &movement::joints(path), &mut report)?;
    other_signals::add(&books[0], &mut report)?;
    if let Some((model, (text, sources))) = model.as_ref().zip(known) {
        model::add(model, text, sources, &mut report);
    }
    if args.has(Section::Space) && path.is_dir() {
        let around = around(args, known, &mut report)?;
        match movement::read(
            path,
            &run,
            (&around, args.surroundings.is_some()),
            args.full,
            &mut report.warnings,
        ) {
            Ok(animation) => {
                report.warnings.extend(animation.as_ref().and_then(movement::told));
                report.animation = animation;
            }
            Err(reason) => {
                report.warnings.push(format!("The 3D view is missing: {reason}."));
            }
        }
    }
    match run.events() {
        Ok(events) => {
            let event = |e: blocksim_recording::EventRow| Event { time: e.time, path: e.path, what: e.what };
            report.events = events.into_iter().map(event).collect();
        }
        Err(error) => report.warnings.push(format!("The events cannot be read: {}.", error.reason())),
    }
    let mut values = 0;
    for file in &args.overlay {
        let overlay = overlay(file, &books[0], &mut report.warnings)?;
        values += overlay.time.len() * (overlay.columns.len() + 1);
        if values > MOST_MEASURED {
            let help = format!("leave columns or rows of `{}` away", file.display());
            let said = format!("the measurements have more than {MOST_MEASURED} values");
            return Err(Failure::unreadable(said).help(help));
        }
        report.overlays.push(overlay);
    }
    sections::leave_out(args, &mut report);
    for warning in &report.warnings {
        console.say(&format!("warning: {warning}"));
    }
    Ok(report)
}

/// What stands around the mechanism. What the model says and cannot be read is a warning of the page.
fn around(
    args: &ReportArgs,
    model: Option<(&model::Text, &Sources)>,
    report: &mut Report,
) -> Result<Surroundings, Failure> {
    match (surroundings::read(args.surroundings.as_deref(), model), &args.surroundings) {
        (Ok(around), _) => Ok(around.unwrap_or_default()),
        (Err(reason), Some(file)) => {
            let said = format!("cannot read the surroundings in `{}`: {reason}", file.display());
            Err(Failure::unreadable(said)
                .help("write them as in docs/moves.md, or name a diagram with the parameter `surroundings`"))
        }
        (Err(reason), None) => {
            report.warnings.push(format!("What stands around the mechanism is not shown: {reason}."));
            Ok(Surroundings::default())
        }
    }
}

/// A measurement over a run: a table, or a file that tells what its columns are. What of that does not fit the run is a warning.
fn overlay(file: &Path, book: &Book, warnings: &mut Vec<String>) -> Result<Overlay, Failure> {
    if file.extension().is_some_and(|ending| ending == "ron") {
        let (assignment, folder) = measured::assignment(file)?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let measurement = assignment.read(&folder, &name).map_err(|troubles| {
            let trouble = troubles.into_iter().next();
            let (message, help) = trouble.map(|one| (one.message, one.help)).unwrap_or_default();
            Failure::unreadable(format!("`{}`: {message}", file.display())).help(help)
        })?;
        let (overlay, troubles) = measurement.beside(book);
        warnings.extend(troubles.into_iter().map(|one| format!("The measurement {name}: {}.", one.message)));
        return Ok(overlay);
    }
    let table = read_foreign_file(file, &["time", "t"]).map_err(|error| Failure::of_run(&error))?;
    let factor = if table.time_unit.as_deref() == Some("ms") { 1e-3 } else { 1.0 };
    Ok(Overlay {
        name: file.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        time: table.time.iter().map(|t| t * factor).collect(),
        columns: table.columns.into_iter().map(|c| (c.name, c.unit.unwrap_or_default(), c.values)).collect(),
    })
}
