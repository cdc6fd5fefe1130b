//! Runs of a sweep that are kept, as `blocksim run` keeps one.

use blocksim_block::problem::Problem;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use blocksim_block::schedule::Schedule;
use blocksim_recording::{
    Ended, EventRow, Manifest, Recording, ResultsError, Run, RunFolder, STORE, Store, clock, probe,
};
use blocksim_scene::Scene;
use blocksim_sim::Simulation;

use crate::args::model::ModelArgs;
use crate::failure::Failure;
use crate::loaded::Loaded;
use crate::running::keep::{Csv, Rest, keep};
use crate::running::manifest::{self, Facts};
use crate::running::model_text::{self, MODEL};
use crate::running::recorder::Recorder;
use crate::running::report::{Report, log};
use crate::running::selection::{Selection, select};
use crate::running::start::Began;
use crate::terminal::console::Console;
use crate::terminal::progress::{Progress, Telling};

/// The folder of all runs, which must be new or empty.
///
/// # Errors
/// Why they cannot be kept there.
pub fn folder(place: &Path) -> Result<(), Failure> {
    let refused = |reason: String, help: &str| {
        Err(Failure::unwritable(format!("cannot keep runs in `{}`: {reason}", place.display())).help(help))
    };
    match std::fs::read_dir(place).map(|mut inside| inside.next().is_some()) {
        Ok(true) => return refused("there is something in it".to_owned(), "name a new folder"),
        Ok(false) => {}
        Err(_) => {
            if let Err(error) = std::fs::create_dir_all(place) {
                return refused(error.to_string(), "choose another place");
            }
        }
    }
    probe(place).or_else(|error| refused(error.reason(), "choose another place"))
}

/// Name of a run among so many: `007`.
pub fn name(run: usize, of: usize) -> String {
    let digits = of.to_string().len();
    format!("{:0digits$}", run + 1)
}

/// A run that is being recorded beside what is measured of it.
pub struct Keeping<'a> {
    folder: RunFolder,
    pub(super) recorder: Recorder,
    selection: Selection,
    loaded: &'a Loaded,
    model: &'a ModelArgs,
    started: SystemTime,
}

impl<'a> Keeping<'a> {
    /// Makes the folder, with the text of the model.
    ///
    /// # Errors
    /// Why that cannot be.
    pub fn begin(
        place: PathBuf,
        loaded: &'a Loaded,
        model: &'a ModelArgs,
        schedule: &Schedule,
        console: Console,
    ) -> Result<Keeping<'a>, String> {
        let poses = loaded.scene().map(Scene::signals).unwrap_or_default();
        let selection = select(&schedule.recorded, &[], &poses, &schedule.settings)
            .map_err(|failure| failure.message())?;
        let told = |error: ResultsError| format!("it cannot be kept: {}", error.reason());
        let mut folder = RunFolder::create_exactly(&place).map_err(told)?;
        folder
            .write(MODEL, |out| out.write_all(model_text::json(&loaded.on_disk, &loaded.offers).as_bytes()))
            .map_err(told)?;
        let stream =
            folder.record(&selection.layout, &selection.sources, schedule.recorded.len()).map_err(told)?;
        let progress = Progress::new(console, Telling::Silent, schedule.settings.stop_time);
        let recorder = Recorder::new(stream, progress);
        Ok(Keeping { folder, recorder, selection, loaded, model, started: SystemTime::now() })
    }

    /// Writes all that belongs to a run.
    ///
    /// # Errors
    /// Why that cannot be.
    pub fn end(
        self,
        schedule: &Arc<Schedule>,
        simulation: &Simulation,
        recording: &Recording,
        warnings: Vec<Problem>,
        ended: Ended,
    ) -> Result<(), String> {
        let Keeping { folder, mut recorder, selection, loaded, model, started } = self;
        let told = |error: ResultsError| format!("it cannot be kept: {}", error.reason());
        let wall_time = recorder.progress.finish();
        let Recorder { stream, events, .. } = recorder;
        let rows = stream.rows();
        let (file, lost) = stream.finish();
        let run = Store::of_file(file, &folder.partial_path().join(STORE)).map(Run::of).map_err(told)?;
        let manifest: Manifest = manifest::of(&Facts {
            model,
            signals: Vec::new(),
            loaded,
            schedule,
            layout: &selection.layout,
            counts: simulation.counts(),
            simulated: simulation.time(),
            started: clock::iso(started),
            wall_time,
            ended,
        });
        let events: &[EventRow] = &events;
        let report = Report {
            schedule,
            manifest: &manifest,
            counts: simulation.counts(),
            recorded: &schedule.recorded,
            recording,
            signals: run.signals().len(),
            rows,
            warnings,
            began: Began::of(simulation),
            events,
        };
        let log = log(&report, loaded);
        let scene = loaded.scene();
        let kept =
            keep(folder, &run, Rest { csv: Csv::Sensibly, events, log: &log, manifest: &manifest, scene });
        match lost {
            Some(error) => Err(told(error)),
            None => kept.map_err(told).and_then(|kept| kept.untold.map_or(Ok(()), |error| Err(told(error)))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_runs_sort_as_they_were_run() {
        assert_eq!((name(0, 9), name(0, 10), name(99, 100)), ("1".into(), "01".into(), "100".into()));
    }
}
