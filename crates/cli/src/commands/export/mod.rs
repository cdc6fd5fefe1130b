mod c;

use std::io::{self, Write};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use blocksim_export::{resampled, write_mat, write_run_csv};
use blocksim_recording::{ResultsError, Run, locate, write_whole};

use crate::args::export::{ExportArgs, ExportWhat};
use crate::args::values::RUNS;
use crate::disk::unwritable;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::signals::naming;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Writes the signals of a run for other programs.
///
/// # Errors
/// What cannot be read or written.
pub fn export(args: &ExportArgs, console: Console) -> Outcome {
    if let Some(ExportWhat::C(args)) = &args.what {
        return c::export(args, console);
    }
    #[cfg(not(feature = "parquet"))]
    if let Some(file) = &args.parquet {
        let done = format!("cannot write `{}`", file.display());
        return Err(crate::left_out::failure(&done, "Parquet (CSV and MAT are there)", "parquet"));
    }
    // Required where nothing else is exported.
    let name = args.run.as_deref().unwrap_or("latest");
    let run =
        locate(name, Path::new(RUNS)).and_then(|path| Run::open(&path)).map_err(|error| told(&error))?;
    let signals = chosen(&run, &args.signals)?;
    if let Some(shortfall) = run.shortfall() {
        console.say(&format!("note: the run is not complete: {shortfall}"));
    }
    let range = args.from.unwrap_or(f64::NEG_INFINITY)..=args.to.unwrap_or(f64::INFINITY);
    let written = match args.every {
        None => write(args, &run, &signals, &range),
        // On the grid all that was chosen is there, in the order chosen.
        Some(every) => resampled(&run, &signals, &range, every).and_then(|grid| {
            let all: Vec<usize> = (0..signals.len()).collect();
            write(args, &grid, &all, &range)
        }),
    };
    let files = written.map_err(|error| told(&error))?;
    console.data(&files.iter().map(|file| format!("{}\n", file.display())).collect::<String>())?;
    console.say(&format!("{} of {}", plural(signals.len(), "signal"), run.name()));
    Ok(Exit::Done)
}

/// Why a file cannot be read or written.
fn told(error: &ResultsError) -> Failure {
    let ResultsError::Io { path, doing: "write", source } = error else { return Failure::of_run(error) };
    // What cannot be read is not the fault of the file that is written.
    match source.get_ref().and_then(|inner| inner.downcast_ref()) {
        Some(error) => Failure::of_run(error),
        None => unwritable(path, error),
    }
}

/// Positions of the signals that fit one of the patterns, all if there are none.
fn chosen(run: &Run, patterns: &[String]) -> Result<Vec<usize>, Failure> {
    let paths = || run.signals().iter().map(|signal| signal.path.as_str());
    if let Some(lost) = patterns.iter().find(|pattern| !paths().any(|path| naming::fits(path, pattern))) {
        let some: Vec<&str> = paths().take(5).collect();
        let more = if paths().count() > some.len() { ", ..." } else { "" };
        let said = format!("no signal of `{}` fits `{lost}`", run.name());
        return Err(Failure::usage(said).help(format!("it has {}{more}", some.join(", "))));
    }
    let fits = |path: &str| patterns.is_empty() || patterns.iter().any(|pattern| naming::fits(path, pattern));
    Ok((0..run.signals().len()).filter(|&at| fits(&run.signals()[at].path)).collect())
}

/// Writes the files asked for; returns their names.
fn write(
    args: &ExportArgs,
    run: &Run,
    signals: &[usize],
    range: &RangeInclusive<f64>,
) -> Result<Vec<PathBuf>, ResultsError> {
    if let Some(file) = &args.mat {
        return Ok(vec![fresh(file, |w| write_mat(w, run, signals, range))?]);
    }
    let Some(file) = args.csv.as_ref().or(args.parquet.as_ref()) else { return Ok(Vec::new()) };
    let mut bases: Vec<usize> = signals.iter().map(|&at| run.signals()[at].base).collect();
    bases.sort_unstable();
    bases.dedup();
    if bases.is_empty() {
        bases.push(0);
    }
    let mut files = Vec::new();
    for (number, base) in bases.into_iter().enumerate() {
        let of_base: Vec<usize> =
            signals.iter().copied().filter(|&at| run.signals()[at].base == base).collect();
        let file = if number == 0 { file.clone() } else { numbered(file, number + 1) };
        files.push(fresh(&file, |w| match args.parquet {
            #[cfg(feature = "parquet")]
            Some(_) => blocksim_export::write_parquet(w, run, base, &of_base, range),
            _ => write_run_csv(w, run, base, &of_base, range),
        })?);
    }
    Ok(files)
}

/// `arm-2.csv` of `arm.csv`.
fn numbered(file: &Path, number: usize) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let ending = file.extension().map_or(String::new(), |ending| format!(".{}", ending.to_string_lossy()));
    file.with_file_name(format!("{stem}-{number}{ending}"))
}

/// Writes a file that is not there yet, whole or not at all.
fn fresh(
    file: &Path,
    content: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<PathBuf, ResultsError> {
    if file.exists() {
        return Err(ResultsError::io("write", file, io::ErrorKind::AlreadyExists.into()));
    }
    let name = file
        .file_name()
        .ok_or_else(|| ResultsError::io("write", file, io::ErrorKind::InvalidFilename.into()))?;
    write_whole(file.parent().unwrap_or(Path::new("")), &name.to_string_lossy(), content)?;
    Ok(file.to_owned())
}
