//! What is asked of a run while it runs: `{"do":"pause"}`, `go`, `step`, `stop`, `{"do":"set","set":"pid.kp=12"}`,
//! `{"do":"back","t":0.5}`, `drop` to end without results, and `{"do":"speed","speed":0.5}`, times real time, or 0 for as fast as it
//! can.

use std::collections::VecDeque;
use std::io::BufRead;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::running::interrupt;

/// How long a run that waits sleeps before it looks again.
const LOOK: Duration = Duration::from_millis(4);

/// What was asked for last.
pub struct Control {
    paused: AtomicBool,
    /// Rows that a paused run may still go.
    steps: AtomicU32,
    /// A step that began between rows is on its way.
    between: AtomicBool,
    /// Nobody wants the results.
    dropped: AtomicBool,
    /// Something is wished for.
    wished: AtomicBool,
    pace: Mutex<Pace>,
    /// What is wished for.
    wishes: Mutex<VecDeque<Wish>>,
}

/// Something that is done between two steps.
#[derive(Debug, Clone, PartialEq)]
pub enum Wish {
    /// A parameter is set.
    Set(String),
    /// The run goes back to a time, s.
    Back(f64),
}

/// How simulated time follows the clock on the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pace {
    /// Simulated seconds a second; 0 without a limit.
    speed: f64,
    /// When the pace was set, and the simulated time then, once a row has come.
    since: Option<(Instant, f64)>,
}

impl Control {
    fn new(speed: f64) -> Control {
        Control {
            paused: AtomicBool::new(false),
            steps: AtomicU32::new(0),
            between: AtomicBool::new(false),
            dropped: AtomicBool::new(false),
            wished: AtomicBool::new(false),
            pace: Mutex::new(Pace { speed, since: None }),
            wishes: Mutex::default(),
        }
    }

    /// Listens to lines of the standard input, on a thread of its own.
    pub fn of_standard_input(speed: f64, is_paused: bool) -> Arc<Control> {
        let control = Arc::new(Control::new(speed));
        control.paused.store(is_paused, Ordering::Relaxed);
        let told = Arc::clone(&control);
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().lines() {
                let Ok(line) = line else { break };
                if let Ok(asked) = serde_json::from_str(&line) {
                    told.take(&asked);
                }
            }
            // Whoever started the run has gone.
            told.paused.store(false, Ordering::Relaxed);
            interrupt::request();
        });
        control
    }

    fn take(&self, asked: &Value) {
        match asked["do"].as_str() {
            Some("pause") => self.pause(),
            Some("go") => {
                self.pace().since = None;
                self.paused.store(false, Ordering::Relaxed);
            }
            Some("step") => {
                self.steps.fetch_add(1, Ordering::Relaxed);
            }
            Some("speed") => {
                let speed = asked["speed"].as_f64().filter(|speed| speed.is_finite() && *speed >= 0.0);
                *self.pace() = Pace { speed: speed.unwrap_or(0.0), since: None };
            }
            Some("set") => {
                if let Some(set) = asked["set"].as_str() {
                    self.wish_for(Wish::Set(set.to_owned()));
                }
            }
            Some("back") => {
                if let Some(t) = asked["t"].as_f64() {
                    self.wish_for(Wish::Back(t));
                }
            }
            Some("stop") => interrupt::request(),
            Some("drop") => {
                self.dropped.store(true, Ordering::Relaxed);
                interrupt::request();
            }
            _ => {}
        }
    }

    fn pace(&self) -> std::sync::MutexGuard<'_, Pace> {
        self.pace.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wish_for(&self, wish: Wish) {
        self.wishes().push_back(wish);
        self.wished.store(true, Ordering::Relaxed);
    }

    fn wishes(&self) -> std::sync::MutexGuard<'_, VecDeque<Wish>> {
        self.wishes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether nobody wants the results.
    pub fn is_dropped(&self) -> bool {
        self.dropped.load(Ordering::Relaxed)
    }

    /// Whether something is wished for.
    pub fn has_wishes(&self) -> bool {
        self.wished.load(Ordering::Relaxed)
    }

    /// What is wished for next.
    pub fn wish(&self) -> Option<Wish> {
        let mut wishes = self.wishes();
        let wish = wishes.pop_front();
        self.wished.store(!wishes.is_empty(), Ordering::Relaxed);
        wish
    }

    /// The run stands still from now on.
    pub fn pause(&self) {
        self.steps.store(0, Ordering::Relaxed);
        self.paused.store(true, Ordering::Relaxed);
    }

    /// What is wished for of a run that has come to its end; nothing as soon as nobody can wish any more.
    pub fn linger(&self) -> Option<Wish> {
        while !interrupt::is_requested() {
            if let Some(wish) = self.wish() {
                return Some(wish);
            }
            std::thread::sleep(LOOK);
        }
        None
    }

    /// Whether the run has to wait at this time.
    pub fn holds(&self, t: f64) -> bool {
        self.paused.load(Ordering::Relaxed) || self.early(t).is_some()
    }

    /// How much too early the run is at this time; nothing if it is not.
    fn early(&self, t: f64) -> Option<Duration> {
        let mut pace = self.pace();
        if pace.speed == 0.0 {
            return None;
        }
        let (since, begin) = *pace.since.get_or_insert_with(|| (Instant::now(), t));
        let due = Duration::try_from_secs_f64((t - begin) / pace.speed).ok()?;
        due.checked_sub(since.elapsed()).filter(|early| !early.is_zero())
    }

    /// Waits as long as it was asked for; `is_row` says whether the wait stands behind a row, of which a paused run may be allowed some.
    pub fn wait(&self, t: f64, is_row: bool) {
        // What is to be set is set at the end of this instant.
        while !interrupt::is_requested() && !self.has_wishes() {
            if self.paused.load(Ordering::Relaxed) {
                let has_step = self.steps.load(Ordering::Relaxed) > 0;
                // Whoever stood between rows has made the step when the next one comes.
                let arrives = is_row && has_step && self.between.swap(false, Ordering::Relaxed);
                if has_step && (is_row || arrives) {
                    self.steps.fetch_sub(1, Ordering::Relaxed);
                }
                if has_step && !arrives {
                    self.between.store(!is_row, Ordering::Relaxed);
                    return;
                }
                std::thread::sleep(LOOK);
            } else {
                match self.early(t) {
                    Some(early) => std::thread::sleep(early.min(LOOK)),
                    None => return,
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_run_keeps_pace_with_the_clock() {
        let control = Control::new(0.0);
        assert!(!control.holds(5.0));
        control.take(&json!({ "do": "speed", "speed": 10.0 }));
        let begin = Instant::now();
        assert!(!control.holds(1.0), "the pace begins where the run is");
        assert!(control.holds(1.5));
        control.wait(1.5, true);
        let took = begin.elapsed();
        assert!(took >= Duration::from_millis(49), "{took:?}");
        for nonsense in [json!({ "do": "speed", "speed": -1.0 }), json!({ "do": "speed" }), json!(3)] {
            control.take(&nonsense);
        }
        assert!(!control.holds(1e9));
    }

    #[test]
    fn a_paused_run_goes_row_by_row() {
        let control = Control::new(0.0);
        control.take(&json!({ "do": "pause" }));
        assert!(control.holds(0.0));
        let steps = || control.steps.load(Ordering::Relaxed);
        control.take(&json!({ "do": "step" }));
        control.wait(0.0, true);
        assert_eq!(steps(), 0, "from row to row");
        control.take(&json!({ "do": "step" }));
        control.take(&json!({ "do": "step" }));
        control.wait(0.0, false);
        assert_eq!(steps(), 2, "between rows");
        // Arrives at the row with the first, and leaves it with the second.
        control.wait(0.0, true);
        assert_eq!(steps(), 0);
        control.take(&json!({ "do": "go" }));
        control.wait(0.0, true);
    }
}
