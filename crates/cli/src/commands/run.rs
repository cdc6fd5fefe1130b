use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use blocksim_block::schedule::Schedule;
use blocksim_results::{Ended, Manifest, ResultsError, RunFolder, clock, probe};
use blocksim_scene::Scene;
use blocksim_sim::Simulation;

use super::{load, tell};
use crate::args::{Format, RunArgs};
use crate::blame::{failure, reason};
use crate::console::Console;
use crate::exit::Exit;
use crate::progress::{Progress, Telling};
use crate::recorder::Recorder;
use crate::report::{Report, log};
use crate::{interrupt, manifest, render, scene, shown, solver};

/// Where runs are kept unless somebody says otherwise.
pub const RUNS: &str = "runs";

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
    if let Err(mistake) = solver::apply(args, &mut schedule.settings) {
        console.say(&format!("error: {mistake}"));
        return Ok(Exit::Usage);
    }
    interrupt::take_over();
    let started = SystemTime::now();
    let folder = match results_folder(args, started) {
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
    let progress = Progress::new(console, telling, schedule.settings.stop_time);
    let mut recorder = Recorder::new(&schedule.recorded, &schedule.settings, progress);
    let outcome = simulation.run(&mut recorder);
    let wall_time = recorder.progress.finish();

    let (ended, exit) = match outcome {
        Ok(blocksim_sim::Ended::Finished) => (Ended::Complete, Exit::Done),
        Ok(blocksim_sim::Ended::Interrupted) => (Ended::Interrupted, Exit::Interrupted),
        Err(error) => {
            tell(&[failure(&error, &schedule)], &loaded.files, format, console)?;
            (Ended::Failed { reason: reason(&error) }, Exit::Failed)
        }
    };
    if let Some(misfit) = &recorder.misfit {
        console.say(&format!("warning: rows were lost: {misfit}; this is a mistake of blocksim"));
    }
    let manifest = manifest::of(&manifest::Facts {
        args,
        loaded: &loaded,
        schedule: &schedule,
        simulation: &simulation,
        started: clock::iso(started),
        wall_time,
        ended,
    });
    let report = Report {
        schedule: &schedule,
        manifest: &manifest,
        counts: simulation.counts(),
        recording: &recorder.recording,
    };
    let log = log(&report, &loaded, &recorder.events);
    let scene = loaded.compiled.scene.as_ref().filter(|scene| !scene.shapes.is_empty());
    for file in scene.into_iter().flat_map(scene::missing_meshes) {
        console.say(&format!(
            "warning: the mesh `{file}` is missing and will not be drawn\n  = help: put it there, or correct `file` of the shape"
        ));
    }
    let place = match keep(folder, &schedule, &recorder, &manifest, &log, scene) {
        Ok(place) => place,
        Err(error) => {
            console.say(&refused(&error));
            // What is in memory can at least be seen.
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

/// Writes all files of a run; returns its folder.
fn keep(
    folder: RunFolder,
    schedule: &Schedule,
    recorder: &Recorder,
    manifest: &Manifest,
    log: &[String],
    scene: Option<&Scene>,
) -> Result<PathBuf, ResultsError> {
    folder.write_recording(&shown::layout(&schedule.recorded), &recorder.recording)?;
    folder.write_signals(&recorder.recording)?;
    folder.write_events(&recorder.events)?;
    folder.write_log(log)?;
    if let Some(scene) = scene {
        folder.write("scene.json", |out| out.write_all(scene::json(scene).as_bytes()))?;
    }
    folder.write_manifest(manifest)?;
    folder.finish()
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
