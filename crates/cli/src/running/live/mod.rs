//! A run that somebody looks at while it runs: what scopes, the panel and the 3D view show goes out as lines of JSON, and lines that come
//! in make it pause, go on by steps or in time with the clock on the wall, and end.
//!
//! Nothing of this changes a number of the run: rows are told after they were recorded, and time passes between them. Where the run goes
//! back into its past, it is kept as it was, and another one begins that has the same past.

mod control;
mod feed;
mod history;
pub mod mechanism;
pub mod panel;
mod scopes;

use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_diagram::PanelItem;
use blocksim_sim::{Control as Answer, Counts, Observer, SimError, Simulation};

pub use scopes::scopes;

use self::control::{Control, Wish};
use self::feed::Feed;
use self::history::{Back, History};
use self::mechanism::Mechanism;
use crate::running::recorder::Shared;
use crate::running::tuning::{self, Came, Planned, Setting, Tunes, When};
use crate::terminal::console::Console;

/// Hands all to the recorder, and to who looks.
pub struct Live<'a> {
    recorder: Shared<'a>,
    feed: Feed,
    control: Arc<Control>,
    planned: Planned,
    history: History,
    /// A parameter is being set, since when: the rows of that come all at once, also where the run is paused.
    tuning: Option<When>,
    /// The run is to go back to this time.
    leaves: Option<f64>,
    /// It is on its way there again, which nobody sees.
    until: Option<f64>,
    /// The way there was not as before.
    pub strayed: Option<f64>,
    /// Another run of the model has come so far: up to there this one neither waits nor does what is wished for.
    catch_up: Option<f64>,
}

impl<'a> Live<'a> {
    /// Tells which scopes, which panel and which mechanism there are, and listens to the standard input from now on. `speed` is
    /// that at first, times real time, with whether the run stands still; the time behind both is where another run of the model was, to
    /// be caught up with.
    pub fn begin(
        recorder: Shared<'a>,
        schedule: &Schedule,
        (items, mechanism): (&[PanelItem], &Mechanism),
        planned: Planned,
        (speed, is_paused, catch_up): (f64, bool, Option<f64>),
        console: Console,
    ) -> Live<'a> {
        let scopes = scopes(schedule, items);
        let shown = panel::shown(items, schedule);
        let feed = Feed::begin(&scopes, (items, &shown), mechanism, schedule.settings.stop_time, console);
        Live {
            recorder,
            feed,
            control: Control::of_standard_input(speed, is_paused),
            planned,
            history: History::new(schedule.recorded.len()),
            tuning: None,
            leaves: None,
            until: None,
            strayed: None,
            catch_up,
        }
    }

    /// Whether the run is still on its way to where another one was: the rows of that up to there had been shown, it stood behind them.
    fn hurries(&self, t: f64) -> bool {
        self.catch_up.is_some_and(|reached| t <= reached)
    }

    /// Whether nobody wants the results.
    pub fn is_dropped(&self) -> bool {
        self.control.is_dropped()
    }

    /// Tells what has not been told.
    pub fn finish(&mut self) {
        self.feed.tell();
    }

    /// The time to go back to, if the run is to: that was wished for while it ran, or is wished for now that it has ended. Waits for
    /// that, and gives nothing as soon as nobody can wish any more.
    pub fn linger(&mut self, now: f64) -> Option<f64> {
        loop {
            if let Some(t) = self.leaves.take() {
                return Some(t);
            }
            match self.control.linger()? {
                Wish::Back(t) => self.consider(t, now),
                // The next run begins with it.
                Wish::Set(_) => {}
            }
        }
    }

    /// Has the run go back, if it can.
    fn consider(&mut self, t: f64, now: f64) {
        match self.history.refusal(t, now) {
            Some(refused) => self.feed.stays(t, &refused),
            None => {
                self.feed.leaves(now);
                self.leaves = Some(t);
            }
        }
    }

    /// The run at the last snapshot before a time, on its way there.
    ///
    /// # Errors
    /// If a simulation cannot be made, which has been made before.
    pub fn go_back(&mut self, t: f64) -> Result<Option<(Simulation, Setting)>, SimError> {
        let Some(Back { simulation, setting, changes, planned }) = self.history.back(t)? else {
            return Ok(None);
        };
        self.planned.add(changes);
        self.planned.add(planned);
        (self.until, self.catch_up) = (Some(t), None);
        // What was before goes to the recorder of the other future as well.
        self.history.replay(&mut self.recorder);
        Ok(Some((simulation, setting)))
    }
}

impl Observer for Live<'_> {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.recorder.row(t, values);
        self.history.row(t, values);
        if self.until.is_some() {
            return;
        }
        if self.tuning.is_none() && !self.hurries(t) && self.control.holds(t) {
            // Who looks at a run that stands still is to see all that was before.
            self.feed.tell();
            self.control.wait(t, true);
        }
        self.feed.row(t, values);
    }

    fn event(&mut self, t: f64, path: &str, what: &str) {
        self.recorder.event(t, path, what);
        self.history.event(t, path, what);
    }

    fn is_waiting(&self, t: f64) -> bool {
        let wished = match self.until {
            Some(until) => t >= until,
            None => !self.hurries(t) && self.control.has_wishes(),
        };
        wished || self.planned.is_due(t) || self.history.is_due()
    }

    fn progress(&mut self, t: f64, counts: &Counts) -> Answer {
        if self.until.is_none() && !self.hurries(t) {
            self.control.wait(t, false);
        }
        self.recorder.progress(t, counts)
    }
}

impl Tunes for Live<'_> {
    fn planned(&self) -> Option<f64> {
        self.planned.time()
    }

    fn stopped(&mut self, simulation: &Simulation, setting: &Setting) {
        let t = simulation.time();
        if self.until.is_some_and(|until| t >= until) {
            self.until = None;
            if !self.history.arrive() {
                self.strayed = Some(t);
                return;
            }
            self.control.pause();
            self.feed.is_back(t, setting, self.history.last());
        }
        self.history.remember(simulation, setting);
    }

    fn goes_back(&self) -> bool {
        self.until.is_some()
    }

    fn wanted(&mut self, t: f64) -> Option<String> {
        self.tuning = None;
        if self.leaves.is_some() || self.strayed.is_some() {
            return None;
        }
        if let Some((when, set)) = self.planned.next(t) {
            self.tuning = Some(when);
            return Some(set);
        }
        while self.until.is_none() && !self.hurries(t) {
            match self.control.wish()? {
                Wish::Set(set) => {
                    self.tuning = Some(When::After(t));
                    return Some(set);
                }
                Wish::Back(to) => {
                    self.consider(to, t);
                    if self.leaves.is_some() {
                        return None;
                    }
                }
            }
        }
        None
    }

    fn goes_on(&self, _has_set: bool) -> bool {
        self.leaves.is_none() && self.strayed.is_none()
    }

    fn tuned(&mut self, t: f64, set: &str, came: Came, setting: &Setting) {
        let when = self.tuning.take().unwrap_or(When::After(t));
        if let Ok(without_effect) = &came {
            let (target, what) = tuning::event(set, without_effect);
            self.event(t, target, &what);
            self.history.changed(when, set);
        }
        if self.until.is_none() {
            self.feed.tuned(t, set, came, &setting.panel);
        }
    }
}
