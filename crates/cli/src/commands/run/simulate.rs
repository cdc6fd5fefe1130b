//! The run itself, from the first step to a recording that can be read.

use std::sync::{Mutex, PoisonError};

use blocksim_block::problem::Problem;
use blocksim_block::schedule::Schedule;
use blocksim_host::{Cause, Death};
use blocksim_recording::{Ended, EventRow, Manifest, ResultsError, Run, STORE, Store, clock};
use blocksim_sim::{Counts, Findings, SimError, Simulation};

use super::prepare::Setup;
use super::{finish, unwritten};
use crate::args::model::RunArgs;
use crate::commands::tell_with;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::running::blame::{failure, reason, warnings};
use crate::running::keep::{self, Seen};
use crate::running::model_text::{self, MODEL};
use crate::running::recorder::{Recorder, Shared, WithChanges};
use crate::running::start::Began;
use crate::running::tuning::{Planned, Tuner};
use crate::running::{manifest, rescue};
use crate::terminal::console::Console;
use crate::terminal::format::short_time;
use crate::terminal::progress::{Progress, Telling};

/// How a run ended, and what it knows of itself.
pub struct End {
    /// In the manifest.
    ended: Ended,
    exit: Exit,
    /// What to tell of it first.
    problem: Option<Problem>,
    /// Work done.
    counts: Counts,
    /// How far it came, s.
    time: f64,
    /// What blocks have to say about approximations that missed the tolerance.
    warnings: Vec<Problem>,
    /// The steady state that it began in, if it did.
    began: Option<Began>,
    /// What an audit has found, if there was one.
    findings: Option<Findings>,
}

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
    /// Work done.
    pub counts: Counts,
    /// What blocks have to say about approximations that missed the tolerance.
    pub warnings: Vec<Problem>,
    /// The steady state that it began in, if it did.
    pub began: Option<Began>,
    /// What an audit has found, if there was one.
    pub findings: Option<Findings>,
    /// Rows, over all of which some signal was recorded.
    pub rows: u64,
    /// Why the recording is not whole, if it is not. This has been told.
    pub lost: Option<ResultsError>,
    /// What the program will say to the shell.
    pub exit: Exit,
}

/// Runs what is prepared, records it, and keeps what there is of it however it ends: also where a plug-in never returns.
///
/// # Errors
/// If nothing can be recorded or kept.
pub fn simulate(args: &RunArgs, mut setup: Setup, mut simulation: Simulation, console: Console) -> Outcome {
    let recorder = Mutex::new(Some(begin(args, &mut setup, console)?));
    let mut tuner = Tuner::new(args, &setup.loaded);
    let setup = Mutex::new(Some(setup));
    let began = Began::of(&simulation);
    let keep = |death: &Death| keep_dead(args, &recorder, &setup, began.clone(), death, console);
    let mut refused = None;
    let outcome = if args.change.is_empty() {
        rescue::during(keep, || simulation.run(&mut Shared(&recorder)))
    } else {
        let mut changes = WithChanges::new(Shared(&recorder), Planned::new(&args.change));
        let outcome = rescue::during(keep, || tuner.run(&mut simulation, &mut changes));
        refused = changes.refused;
        outcome
    };
    let (Some(recorder), Some(setup)) = (taken(&recorder), taken(&setup)) else { return Ok(Exit::Failed) };
    let end = End::of(outcome, refused, &mut simulation, &setup.schedule, began);
    finish(args, setup, recorder, end, console)
}

/// Begins a recording.
///
/// # Errors
/// If it cannot be written.
pub fn begin(args: &RunArgs, setup: &mut Setup, console: Console) -> Result<Recorder, Failure> {
    let telling = match (args.json, args.quiet) {
        _ if args.live.is_some() => Telling::Live,
        (true, _) => Telling::Data,
        (_, true) => Telling::Silent,
        _ => Telling::People,
    };
    // Whoever finds the folder of a run that was ended by force is to know what it was.
    let begun = facts(args, setup, Counts::default(), 0.0, 0.0, Ended::Unfinished);
    let Setup { loaded, schedule, selection, folder, .. } = setup;
    let stream = folder
        .write_manifest(&begun)
        .and_then(|()| {
            folder.write(MODEL, |out| {
                out.write_all(model_text::json(&loaded.on_disk, &loaded.offers).as_bytes())
            })
        })
        .and_then(|()| folder.record(&selection.layout, &selection.sources, schedule.recorded.len()))
        .map_err(|error| unwritten(&error))?;
    Ok(Recorder::new(stream, Progress::new(console, telling, schedule.settings.stop_time)))
}

/// Keeps what there is of a run in which a plug-in died.
pub fn keep_dead(
    args: &RunArgs,
    recorder: &Mutex<Option<Recorder>>,
    setup: &Mutex<Option<Setup>>,
    began: Option<Began>,
    death: &Death,
    console: Console,
) -> Exit {
    let (Some(recorder), Some(setup)) = (taken(recorder), taken(setup)) else { return Exit::Failed };
    let end = End::by_death(death, &setup.schedule, recorder.counts, began);
    finish(args, setup, recorder, end, console).unwrap_or_else(|failure| failure.tell(console))
}

/// What has not been taken away.
pub fn taken<T>(shared: &Mutex<Option<T>>) -> Option<T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner).take()
}

impl End {
    /// That of a run which has returned; `refused` is why a parameter could not be set, and what helps.
    pub fn of(
        outcome: Result<blocksim_sim::Ended, SimError>,
        refused: Option<(String, Option<String>)>,
        simulation: &mut Simulation,
        schedule: &Schedule,
        began: Option<Began>,
    ) -> End {
        let (ended, exit, problem) = match (outcome, refused) {
            (Ok(_), Some((message, help))) => {
                let problem = Problem { help, ..Problem::error("tuning", message.clone()) };
                (Ended::Failed { reason: message }, Exit::Failed, Some(problem))
            }
            (Ok(blocksim_sim::Ended::Finished), None) => (Ended::Complete, Exit::Done, None),
            (Ok(blocksim_sim::Ended::Stopped), None) => {
                let reason = simulation.stop_reason().unwrap_or_default();
                (Ended::Stopped { reason }, Exit::Done, None)
            }
            (Ok(blocksim_sim::Ended::Interrupted), None) => (Ended::Interrupted, Exit::Interrupted, None),
            (Err(_), _) if blocksim_host::was_interrupted() => (Ended::Interrupted, Exit::Interrupted, None),
            (Err(error), _) => {
                (Ended::Failed { reason: reason(&error) }, Exit::Failed, Some(failure(&error, schedule)))
            }
        };
        End {
            ended,
            exit,
            problem,
            counts: simulation.counts(),
            time: simulation.time(),
            warnings: warnings(simulation, schedule),
            began,
            findings: simulation.findings(),
        }
    }

    /// That of a run in which a plug-in died, or did not return when it was to end.
    fn by_death(death: &Death, schedule: &Schedule, counts: Counts, began: Option<Began>) -> End {
        let error = rescue::failure(death, schedule);
        let (ended, exit, problem) = match death.cause {
            Cause::Interrupted => (Ended::Interrupted, Exit::Interrupted, None),
            _ => (Ended::Failed { reason: reason(&error) }, Exit::Failed, Some(failure(&error, schedule))),
        };
        End { ended, exit, problem, counts, time: death.t, warnings: Vec::new(), began, findings: None }
    }
}

/// Ends the recording, tells how the run ended, and reads back what is looked at.
///
/// # Errors
/// If nothing can be read.
pub fn read_back(
    args: &RunArgs,
    setup: &Setup,
    recorder: Recorder,
    end: End,
    console: Console,
) -> Result<Simulated, Failure> {
    let End { mut ended, mut exit, problem, counts, time, warnings, began, findings } = end;
    let Recorder { stream, events, misfit, mut progress, .. } = recorder;
    let wall_time = progress.finish();
    let taken = stream.rows();
    let (file, lost) = stream.finish();
    if let Some(problem) = problem {
        tell_with(&[problem], &setup.loaded.files, Some(Exit::Failed), console)?;
    }
    if let Some(error) = &lost {
        exit = unwritten(error).tell(console);
        ended = Ended::Failed { reason: format!("the recording could not be written: {}", error.reason()) };
    }
    if let Some(misfit) = &misfit {
        console.say(&format!("warning: rows were lost: {misfit}; this is a mistake of blocksim"));
    }
    let store = Store::of_file(file, &setup.folder.partial_path().join(STORE));
    let manifest = facts(args, setup, counts, time, wall_time, ended);
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
    Ok(Simulated { run, seen, events, manifest, counts, warnings, began, findings, rows, lost, exit })
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

fn facts(
    args: &RunArgs,
    setup: &Setup,
    counts: Counts,
    simulated: f64,
    wall_time: f64,
    ended: Ended,
) -> Manifest {
    manifest::of(&manifest::Facts {
        model: &args.model,
        signals: args.signals.iter().map(|wanted| wanted.text.clone()).collect(),
        loaded: &setup.loaded,
        schedule: &setup.schedule,
        layout: &setup.selection.layout,
        counts,
        simulated,
        started: clock::iso(setup.started),
        wall_time,
        ended,
    })
}
