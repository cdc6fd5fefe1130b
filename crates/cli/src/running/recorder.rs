//! Hands what a simulation brings to the disk.

use std::sync::{Mutex, PoisonError};

use blocksim_recording::{EventRow, RecordingError, Stream};
use blocksim_sim::{Control, Counts, Observer};

use crate::running::interrupt;
use crate::running::tuning::{self, Came, Planned, Setting, Tunes};
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

/// A recorder with parameters that change at times that are known before.
pub struct WithChanges<'a> {
    recorder: Shared<'a>,
    planned: Planned,
    /// Why a change was refused, which ends the run.
    pub refused: Option<(String, Option<String>)>,
}

impl<'a> WithChanges<'a> {
    /// Nothing has changed yet.
    pub fn new(recorder: Shared<'a>, planned: Planned) -> WithChanges<'a> {
        WithChanges { recorder, planned, refused: None }
    }
}

impl Observer for WithChanges<'_> {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.recorder.row(t, values);
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.recorder.event(t, path, what);
    }

    fn is_waiting(&self, t: f64) -> bool {
        self.refused.is_some() || self.planned.is_due(t)
    }

    fn progress(&mut self, t: f64, counts: &Counts) -> Control {
        self.recorder.progress(t, counts)
    }
}

impl Tunes for WithChanges<'_> {
    fn planned(&self) -> Option<f64> {
        self.planned.time().filter(|_| self.refused.is_none())
    }

    fn wanted(&mut self, t: f64) -> Option<String> {
        if self.refused.is_some() { None } else { self.planned.next(t).map(|(_, set)| set) }
    }

    fn tuned(&mut self, t: f64, set: &str, came: Came, _: &Setting) {
        match came {
            Ok(without_effect) => {
                let (target, what) = tuning::event(set, &without_effect);
                self.recorder.event(t, target, &what);
            }
            Err((why, help)) => {
                self.refused = Some((tuning::unset(set, t, &why), help));
            }
        }
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
