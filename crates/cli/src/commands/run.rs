use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use blocksim_block::schedule::Recorded;
use blocksim_results::format::ordinal;
use blocksim_results::{Ended, ResultsError, Run, RunFolder, STORE, Store, clock, probe};
use blocksim_scene::Scene;
use blocksim_sim::Simulation;

use super::tell;
use crate::args::model::{Format, RunArgs};
use crate::args::report::ReportArgs;
use crate::args::values::RUNS;
use crate::exit::Exit;
use crate::loaded::load;
use crate::running::blame::{failure, reason};
use crate::running::keep::{self, Csv, Kept, Rest, is_csv_written, keep};
use crate::running::model_text::{self, MODEL};
use crate::running::recorder::Recorder;
use crate::running::report::{Report, log};
use crate::running::selection::select;
use crate::running::{interrupt, manifest, solver};
use crate::scene;
use crate::terminal::console::Console;
use crate::terminal::format::short_time;
use crate::terminal::progress::{Progress, Telling};
use crate::terminal::render::{self, plural};

/// Simulates a model, keeps the results and shows them.
///
/// # Errors
/// If the standard output cannot be written.
pub fn run(args: &RunArgs, console: Console) -> io::Result<Exit> {
    let Some(mut loaded) = load(&args.model, console) else { return Ok(Exit::Files) };
    let format = if args.json { Format::Json } else { Format::Full };
    let problems = &loaded.compiled.problems;
    tell(problems, &loaded.files, format, console)?;
    let Some(mut schedule) = loaded.compiled.schedule.take() else {
        console.say(&format!("{}; nothing was run", render::tally(problems)));
        return Ok(Exit::Model);
    };
    if let Err(mistake) = solver::apply(&args.solver, &mut schedule.settings) {
        console.say(&format!("error: {mistake}"));
        return Ok(Exit::Usage);
    }
    let scene = loaded.compiled.scene.as_ref().filter(|scene| !scene.shapes.is_empty());
    let poses = scene.map(Scene::signals).unwrap_or_default();
    let selection = match select(&schedule.recorded, &args.signals, &poses, &schedule.settings) {
        Ok(selection) => selection,
        Err(mistake) => {
            console.say(&format!("error: {mistake}"));
            return Ok(Exit::Usage);
        }
    };
    interrupt::take_over();
    let started = SystemTime::now();
    let mut folder = match results_folder(args, started) {
        Ok(folder) => folder,
        Err(error) => {
            console.say(&refused(&error));
            return Ok(Exit::Files);
        }
    };
    let schedule = Arc::new(schedule);
    let mut simulation = match Simulation::new(Arc::clone(&schedule)) {
        Ok(simulation) => simulation,
        Err(error) => {
            tell(&[failure(&error, &schedule)], &loaded.files, format, console)?;
            console.say("nothing was run");
            return Ok(Exit::Failed);
        }
    };

    let telling = match (args.json, args.quiet) {
        (true, _) => Telling::Data,
        (_, true) => Telling::Silent,
        _ => Telling::People,
    };
    let facts = |simulation: &Simulation, wall_time, ended| {
        manifest::of(&manifest::Facts {
            args,
            loaded: &loaded,
            schedule: &schedule,
            layout: &selection.layout,
            simulation,
            started: clock::iso(started),
            wall_time,
            ended,
        })
    };
    // Whoever finds the folder of a run that was ended by force is to know what it was.
    let begun = facts(&simulation, 0.0, Ended::Unfinished);
    let partial = folder.partial_path().display().to_string();
    let stream = folder
        .write_manifest(&begun)
        .and_then(|()| folder.write(MODEL, |out| out.write_all(model_text::json(&loaded.on_disk).as_bytes())))
        .and_then(|()| folder.record(&selection.layout, &selection.sources, schedule.recorded.len()));
    let stream = match stream {
        Ok(stream) => stream,
        Err(error) => {
            console.say(&refused(&error));
            return Ok(Exit::Files);
        }
    };
    let progress = Progress::new(console, telling, schedule.settings.stop_time);
    let mut recorder = Recorder::new(stream, progress);
    let outcome = simulation.run(&mut recorder);
    let wall_time = recorder.progress.finish();
    let Recorder { stream, events, misfit, .. } = recorder;
    let rows = stream.rows();
    let (file, lost) = stream.finish();

    let (ended, mut exit) = match outcome {
        Ok(blocksim_sim::Ended::Finished) => (Ended::Complete, Exit::Done),
        Ok(blocksim_sim::Ended::Interrupted) => (Ended::Interrupted, Exit::Interrupted),
        Err(error) => {
            tell(&[failure(&error, &schedule)], &loaded.files, format, console)?;
            (Ended::Failed { reason: reason(&error) }, Exit::Failed)
        }
    };
    let ended = match &lost {
        None => ended,
        Some(error) => {
            console.say(&refused(error));
            exit = Exit::Files;
            Ended::Failed { reason: format!("the recording could not be written: {}", error.reason()) }
        }
    };
    if let Some(misfit) = &misfit {
        console.say(&format!("warning: rows were lost: {misfit}; this is a mistake of blocksim"));
    }
    let manifest = facts(&simulation, wall_time, ended);
    let store = Store::of_file(file, &folder.partial_path().join(STORE));
    let (run, seen) = match store.map(Run::of).and_then(|run| keep::seen(&run).map(|seen| (run, seen))) {
        Ok(both) => both,
        Err(error) => {
            // A disk that is full from the start may not even have taken the header.
            if lost.is_none() {
                console.say(&refused(&error));
            }
            return Ok(Exit::Files);
        }
    };
    if lost.is_some() {
        console.say(&match run.span() {
            Some((from, to)) => {
                format!(
                    "  = note: what was recorded from {} s to {} s is kept",
                    short_time(from),
                    short_time(to)
                )
            }
            None => "  = note: nothing could be recorded".to_owned(),
        });
    }
    let recorded: Vec<Recorded> =
        seen.signals.iter().map(|&at| schedule.recorded[selection.sources[at]].clone()).collect();
    let report = Report {
        schedule: &schedule,
        manifest: &manifest,
        counts: simulation.counts(),
        recorded: &recorded,
        recording: &seen.recording,
        signals: run.signals().len(),
        rows: if lost.is_none() {
            rows
        } else {
            (0..run.rates().len()).map(|base| run.rows(base)).max().unwrap_or(0)
        },
    };
    let log = log(&report, &loaded, &events);
    for file in scene.into_iter().flat_map(scene::missing_meshes) {
        console.say(&format!(
            "warning: the mesh `{file}` is missing and will not be drawn\n  = help: put it there, or correct `file` of the shape"
        ));
    }
    let csv = match (args.csv, args.no_csv) {
        (true, _) => Csv::Always,
        (_, true) => Csv::Never,
        _ => Csv::Sensibly,
    };
    let rest = Rest { csv, events: &events, log: &log, manifest: &manifest, scene };
    let Kept { folder: place, untold } = match keep(folder, &run, rest) {
        Ok(kept) => kept,
        Err(error) => {
            // A disk that is full is told once.
            if lost.is_none() {
                console.say(&refused(&error));
            }
            if Path::new(&partial).exists() {
                console.say(&format!("what was recorded is kept in {partial}"));
            }
            // What was recorded can at least be seen.
            if !args.quiet && !args.json {
                console.data(&report.text(None, args, console))?;
            }
            return Ok(Exit::Files);
        }
    };
    // As the user wrote it, where they did.
    let place = args.out.as_ref().unwrap_or(&place).display().to_string();
    console.data(&match (args.json, args.quiet) {
        (true, _) => format!("{}\n", report.json(&place)),
        (_, true) => format!("{place}\n"),
        _ => report.text(Some(&place), args, console),
    })?;
    if let Some(warning) = report.plot_warning(args) {
        console.say(&warning);
    }
    if seen.stride > 1 {
        console.say(&format!("note: pictures and tables are of every {} row", ordinal(seen.stride)));
    }
    if selection.unasked > 0 {
        console.say(&format!(
            "note: {} of joints are recorded as well, for the view in space",
            plural(selection.unasked, "position")
        ));
    }
    if csv == Csv::Sensibly && !is_csv_written(&run, csv) {
        console.say(&format!(
            "note: no signals.csv, as it would be very large; `blocksim export {place} --csv FILE` writes it"
        ));
    }
    // A disk that is full is told once.
    if let Some(error) = untold.filter(|_| lost.is_none()) {
        console.say(&refused(&error));
        console.say(&format!(
            "  = note: all signals are in {place}/{STORE}; `blocksim export {place} --csv FILE` writes them as text"
        ));
        exit = Exit::Files;
    }
    if args.report {
        match super::report::written(&ReportArgs::of(place), console) {
            Ok(page) => console.say(&format!("the page of the run is {}", page.display())),
            Err(message) => {
                console.say(&message);
                return Ok(if exit == Exit::Done { Exit::Files } else { exit });
            }
        }
    }
    Ok(exit)
}

/// Tries the place of the results before the run, so that a long one does not fail at its end.
fn results_folder(args: &RunArgs, started: SystemTime) -> Result<RunFolder, ResultsError> {
    if let Some(out) = &args.out {
        let folder = RunFolder::create_exactly(out)?;
        let parent = out.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        probe(parent)?;
        return Ok(folder);
    }
    let parent = PathBuf::from(RUNS);
    probe(&parent)?;
    let name = args.model.model.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    RunFolder::create_at_time(&parent, &name, started)
}

/// A failure of the file system: place, reason, remedy.
fn refused(error: &ResultsError) -> String {
    format!(
        "error: cannot write the results to `{}`: {}\n  = help: {}",
        error.place().display(),
        error.reason(),
        error.remedy()
    )
}
