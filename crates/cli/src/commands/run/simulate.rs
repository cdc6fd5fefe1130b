//! The run itself, from the first step to a recording that can be read.

use blocksim_results::{Ended, EventRow, Manifest, ResultsError, Run, STORE, Store, clock};

use super::prepare::Prepared;
use super::unwritten;
use crate::args::model::RunArgs;
use crate::commands::tell_with;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::running::blame::{failure, reason};
use crate::running::keep::{self, Seen};
use crate::running::manifest;
use crate::running::model_text::{self, MODEL};
use crate::running::recorder::Recorder;
use crate::terminal::console::Console;
use crate::terminal::format::short_time;
use crate::terminal::progress::{Progress, Telling};

/// A run that has ended.
pub struct Simulated {
    /// Its recording.
    pub run: Run,
    /// What is looked at of it.
    pub seen: Seen,
    /// What happened.
    pub events: Vec<EventRow>,
    /// What was run, and how it ended.
    pub manifest: Manifest,
    /// Rows, over all of which some signal was recorded.
    pub rows: u64,
    /// Why the recording is not whole, if it is not. This has been told.
    pub lost: Option<ResultsError>,
    /// What the program will say to the shell.
    pub exit: Exit,
}

/// Runs what is prepared and records it.
///
/// # Errors
/// If nothing can be recorded. A simulation that cannot go on is told, and what there is of it is kept.
pub fn simulate(args: &RunArgs, prepared: &mut Prepared, console: Console) -> Result<Simulated, Failure> {
    let telling = match (args.json, args.quiet) {
        (true, _) => Telling::Data,
        (_, true) => Telling::Silent,
        _ => Telling::People,
    };
    // Whoever finds the folder of a run that was ended by force is to know what it was.
    let begun = facts(args, prepared, 0.0, Ended::Unfinished);
    let Prepared { loaded, schedule, simulation, selection, folder, .. } = prepared;
    let stream = folder
        .write_manifest(&begun)
        .and_then(|()| {
            folder.write(MODEL, |out| {
                out.write_all(model_text::json(&loaded.on_disk, &loaded.offers).as_bytes())
            })
        })
        .and_then(|()| folder.record(&selection.layout, &selection.sources, schedule.recorded.len()))
        .map_err(|error| unwritten(&error))?;
    let progress = Progress::new(console, telling, schedule.settings.stop_time);
    let mut recorder = Recorder::new(stream, progress);
    let outcome = simulation.run(&mut recorder);
    let wall_time = recorder.progress.finish();
    let Recorder { stream, events, misfit, .. } = recorder;
    let taken = stream.rows();
    let (file, lost) = stream.finish();

    let (mut ended, mut exit) = match outcome {
        Ok(blocksim_sim::Ended::Finished) => (Ended::Complete, Exit::Done),
        Ok(blocksim_sim::Ended::Interrupted) => (Ended::Interrupted, Exit::Interrupted),
        Err(error) => {
            tell_with(&[failure(&error, schedule)], &loaded.files, Some(Exit::Failed), console)?;
            (Ended::Failed { reason: reason(&error) }, Exit::Failed)
        }
    };
    if let Some(error) = &lost {
        exit = unwritten(error).tell(console);
        ended = Ended::Failed { reason: format!("the recording could not be written: {}", error.reason()) };
    }
    if let Some(misfit) = &misfit {
        console.say(&format!("warning: rows were lost: {misfit}; this is a mistake of blocksim"));
    }
    let store = Store::of_file(file, &folder.partial_path().join(STORE));
    let manifest = facts(args, prepared, wall_time, ended);
    let (run, seen) =
        store.map(Run::of).and_then(|run| keep::seen(&run).map(|seen| (run, seen))).map_err(|error| {
            // A disk that is full from the start may not even have taken the header, which has been told.
            if lost.is_some() { Failure::told(Exit::Files) } else { unwritten(&error) }
        })?;
    let rows = match &lost {
        None => taken,
        Some(_) => {
            console.say(&kept_in_spite(&run));
            (0..run.rates().len()).map(|base| run.rows(base)).max().unwrap_or(0)
        }
    };
    Ok(Simulated { run, seen, events, manifest, rows, lost, exit })
}

/// What is there of a recording that could not be written to its end.
fn kept_in_spite(run: &Run) -> String {
    match run.span() {
        Some((from, to)) => {
            format!("  = note: what was recorded from {} s to {} s is kept", short_time(from), short_time(to))
        }
        None => "  = note: nothing could be recorded".to_owned(),
    }
}

fn facts(args: &RunArgs, prepared: &Prepared, wall_time: f64, ended: Ended) -> Manifest {
    manifest::of(&manifest::Facts {
        model: &args.model,
        signals: args.signals.iter().map(|wanted| wanted.text.clone()).collect(),
        loaded: &prepared.loaded,
        schedule: &prepared.schedule,
        layout: &prepared.selection.layout,
        simulation: &prepared.simulation,
        started: clock::iso(prepared.started),
        wall_time,
        ended,
    })
}
