//! Hands what a simulation brings to the disk.

use std::sync::{Mutex, PoisonError};

use blocksim_results::{EventRow, RecordingError, Stream};
use blocksim_sim::{Control, Counts, Observer};

use crate::running::interrupt;
use crate::terminal::progress::Progress;

/// Rows and events of a run on their way to the disk, and who is told how far it is.
#[derive(Debug)]
pub struct Recorder {
    /// Where the rows go, in SI.
    pub stream: Stream,
    /// Events.
    pub events: Vec<EventRow>,
    /// Who is told.
    pub progress: Progress,
    /// The first row that did not fit, which would be a mistake of the engine.
    pub misfit: Option<RecordingError>,
    /// Work done when it was asked for last.
    pub counts: Counts,
}

/// A recorder that somebody else may take away, should the run never return.
#[derive(Debug)]
pub struct Shared<'a>(pub &'a Mutex<Option<Recorder>>);

impl Shared<'_> {
    fn with<R>(&self, body: impl FnOnce(&mut Recorder) -> R) -> Option<R> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).as_mut().map(body)
    }
}

impl Observer for Shared<'_> {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.with(|recorder| recorder.row(t, values));
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.with(|recorder| recorder.event(t, path, what));
    }

    fn progress(&mut self, t: f64, counts: &Counts) -> Control {
        self.with(|recorder| recorder.progress(t, counts)).unwrap_or(Control::Stop)
    }
}

impl Recorder {
    /// Nothing yet.
    pub fn new(stream: Stream, progress: Progress) -> Recorder {
        Recorder { stream, events: Vec::new(), progress, misfit: None, counts: Counts::default() }
    }
}

impl Observer for Recorder {
    fn row(&mut self, t: f64, values: &[f64]) {
        if let Err(error) = self.stream.row(t, values) {
            self.misfit.get_or_insert(error);
        }
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.events.push(EventRow { time: t, path: path.to_owned(), what: what.to_owned() });
    }

    fn progress(&mut self, t: f64, counts: &Counts) -> Control {
        self.counts = *counts;
        self.progress.report(t);
        self.stream.tend();
        let ends = interrupt::is_requested() || self.stream.has_failed();
        if ends { Control::Stop } else { Control::Go }
    }
}
