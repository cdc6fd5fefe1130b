//! A run that somebody looks at while it runs: what scopes show goes out as lines of JSON, and lines that come in make it pause, go
//! on by steps or in time with the clock on the wall, and end.
//!
//! Nothing of this changes a number of the run: rows are told after they were recorded, and time passes between them.

mod control;
mod feed;
mod scopes;

use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_sim::{Control as Answer, Counts, Observer};

pub use scopes::scopes;

use self::control::Control;
use self::feed::Feed;
use crate::running::recorder::Shared;
use crate::running::tuning::{self, Came, Planned, Tunes};
use crate::terminal::console::Console;

/// Hands all to the recorder, and to who looks.
pub struct Live<'a> {
    recorder: Shared<'a>,
    feed: Feed,
    control: Arc<Control>,
    planned: Planned,
    /// A parameter is being set: the rows of that come all at once, also where the run is paused.
    tuning: bool,
}

impl<'a> Live<'a> {
    /// Tells which scopes there are, and listens to the standard input from now on; `speed` is that at first, times real time.
    pub fn begin(
        recorder: Shared<'a>,
        schedule: &Schedule,
        planned: Planned,
        speed: f64,
        console: Console,
    ) -> Live<'a> {
        let scopes = scopes(schedule);
        let feed = Feed::begin(&scopes, schedule.settings.stop_time, console);
        Live { recorder, feed, control: Control::of_standard_input(speed), planned, tuning: false }
    }

    /// Tells what has not been told.
    pub fn finish(&mut self) {
        self.feed.tell();
    }
}

impl Observer for Live<'_> {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.recorder.row(t, values);
        if !self.tuning && self.control.holds(t) {
            // Who looks at a run that stands still is to see all that was before.
            self.feed.tell();
            self.control.wait(t, true);
        }
        self.feed.row(t, values);
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.recorder.event(t, path, what);
    }

    fn is_waiting(&self, _t: f64) -> bool {
        self.control.has_wishes()
    }

    fn progress(&mut self, t: f64, counts: &Counts) -> Answer {
        if !self.is_waiting(t) {
            self.control.wait(t, false);
        }
        let answer = self.recorder.progress(t, counts);
        if self.is_waiting(t) { Answer::Stop } else { answer }
    }
}

impl Tunes for Live<'_> {
    fn planned(&self) -> Option<f64> {
        self.planned.time()
    }

    fn wanted(&mut self, t: f64) -> Option<String> {
        let wish = self.planned.next(t).or_else(|| self.control.wish());
        self.tuning = wish.is_some();
        wish
    }

    fn tuned(&mut self, t: f64, set: &str, came: Came) {
        self.tuning = false;
        if let Ok(without_effect) = &came {
            let (target, what) = tuning::event(set, without_effect);
            self.recorder.event(t, target, &what);
        }
        self.feed.tuned(t, set, came);
    }
}
