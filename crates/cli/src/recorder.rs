//! Keeps what a simulation brings.

use blocksim_block::schedule::{OutputTimes, Recorded, Settings};
use blocksim_results::{EventRow, Recording, RecordingError};
use blocksim_sim::{Control, Counts, Observer};

use crate::interrupt;
use crate::progress::Progress;
use crate::shown;

/// Most rows for which room is made beforehand.
const ROOM: usize = 1_000_000;

/// Rows and events of a run, and who is told how far it is.
#[derive(Debug)]
pub struct Recorder {
    /// Signals in SI.
    pub recording: Recording,
    /// Events.
    pub events: Vec<EventRow>,
    /// Who is told.
    pub progress: Progress,
    /// The first row that did not fit, which would be a mistake of the engine.
    pub misfit: Option<RecordingError>,
}

impl Recorder {
    /// Nothing yet.
    pub fn new(recorded: &[Recorded], settings: &Settings, progress: Progress) -> Recorder {
        let mut recording = shown::recording(recorded);
        if let OutputTimes::Every(spacing) = settings.output {
            // A float that is too large for usize becomes the largest one.
            recording.reserve(((settings.stop_time / spacing) as usize).saturating_add(2).min(ROOM));
        }
        Recorder { recording, events: Vec::new(), progress, misfit: None }
    }
}

impl Observer for Recorder {
    fn row(&mut self, t: f64, values: &[f64]) {
        if let Err(error) = self.recording.push_row(t, values) {
            self.misfit.get_or_insert(error);
        }
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.events.push(EventRow { time: t, path: path.to_owned(), what: what.to_owned() });
    }

    fn progress(&mut self, t: f64, _counts: &Counts) -> Control {
        self.progress.report(t);
        if interrupt::is_requested() { Control::Stop } else { Control::Go }
    }
}
