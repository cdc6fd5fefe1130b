//! What a run that somebody looks at remembers, so that it can go back: its rows, its events, what was set, and snapshots.

use std::sync::Arc;
use std::time::{Duration, Instant};

use blocksim_block::schedule::Schedule;
use blocksim_recording::EventRow;
use blocksim_sim::{Counts, Observer, SimError, Simulation, Snapshot};

use crate::running::tuning::{Setting, When};

/// Numbers of rows that are kept, 256 MB; a run with more of them cannot go back.
const ROOM: usize = 32 << 20;
/// Events that are kept; a run with more of them cannot go back either.
const EVENTS: usize = 1 << 20;
/// Snapshots that are kept; as soon as there are so many, every second is left.
const MOMENTS: usize = 64;
/// Time on the wall between two snapshots.
const EVERY: Duration = Duration::from_millis(200);

/// The past of a run.
pub struct History {
    /// Values of a row.
    width: usize,
    /// Times and values, row by row.
    rows: Vec<f64>,
    /// What happened.
    events: Vec<EventRow>,
    /// What was set, in the order in which it was.
    changes: Vec<(When, String)>,
    moments: Vec<Moment>,
    taken: Instant,
    every: Duration,
    is_full: bool,
    /// Rows that are made once more, of which the first ones are known, and how many of them have come.
    again: Option<Again>,
}

/// A snapshot, and how much was known when it was taken.
struct Moment {
    snapshot: Snapshot,
    schedule: Arc<Schedule>,
    counts: Counts,
    setting: Setting,
    rows: usize,
    events: usize,
    changes: usize,
}

struct Again {
    rows: Vec<f64>,
    seen: usize,
    differs: bool,
}

/// A run at an instant of its past.
pub struct Back {
    /// It.
    pub simulation: Simulation,
    /// What was set until then.
    pub setting: Setting,
    /// What is to be set from there on to come to the time that was asked for.
    pub changes: Vec<(When, String)>,
    /// What was planned before the run, and lies ahead again.
    pub planned: Vec<(When, String)>,
}

impl History {
    /// Nothing has happened yet.
    pub fn new(width: usize) -> History {
        History {
            width,
            rows: Vec::new(),
            events: Vec::new(),
            changes: Vec::new(),
            moments: Vec::new(),
            taken: Instant::now(),
            every: EVERY,
            is_full: false,
            again: None,
        }
    }

    /// Whether it is time for a snapshot.
    pub fn is_due(&self) -> bool {
        !self.is_full && (self.moments.is_empty() || self.taken.elapsed() >= self.every)
    }

    /// Takes a snapshot, if it is time for one.
    pub fn remember(&mut self, simulation: &Simulation, setting: &Setting) {
        if !self.is_due() || self.moments.last().is_some_and(|last| last.snapshot.time() >= simulation.time())
        {
            return;
        }
        if self.moments.len() == MOMENTS {
            let mut at = 0;
            self.moments.retain(|_| {
                at += 1;
                at % 2 == 1
            });
            self.every *= 2;
        }
        self.moments.push(Moment {
            snapshot: simulation.snapshot(),
            schedule: simulation.shared_schedule(),
            counts: simulation.counts(),
            setting: setting.clone(),
            rows: self.rows.len(),
            events: self.events.len(),
            changes: self.changes.len(),
        });
        self.taken = Instant::now();
    }

    /// Takes a row in SI.
    pub fn row(&mut self, t: f64, values: &[f64]) {
        if self.is_full {
            return;
        }
        if self.rows.len() + values.len() + 1 > ROOM {
            self.give_up();
            return;
        }
        if let Some(again) = &mut self.again {
            let known = again.rows.get(again.seen..again.seen + self.width + 1);
            let is_same = known.is_none_or(|known| {
                known[0].to_bits() == t.to_bits()
                    && known[1..].iter().zip(values).all(|(one, other)| one.to_bits() == other.to_bits())
            });
            again.differs |= !is_same;
            again.seen += self.width + 1;
        }
        self.rows.push(t);
        self.rows.extend_from_slice(values);
    }

    /// Takes an event.
    pub fn event(&mut self, t: f64, path: &str, what: &str) {
        if self.events.len() == EVENTS {
            self.give_up();
        }
        if !self.is_full {
            self.events.push(EventRow { time: t, path: path.to_owned(), what: what.to_owned() });
        }
    }

    /// Keeps nothing any more.
    fn give_up(&mut self) {
        self.is_full = true;
        (self.rows, self.events, self.moments) = (Vec::new(), Vec::new(), Vec::new());
    }

    /// Something was set.
    pub fn changed(&mut self, when: When, set: &str) {
        self.changes.push((when, set.to_owned()));
    }

    /// Why the run cannot go back to a time, if it cannot; the present one is `now`.
    pub fn refusal(&self, t: f64, now: f64) -> Option<String> {
        if self.is_full {
            let most = ROOM * 8 / 1_000_000;
            return Some(format!(
                "this run has more than {most} MB of rows or {EVENTS} events, which are not kept in memory; record fewer signals, or repeat it from the start"
            ));
        }
        if !(t.is_finite() && t >= 0.0 && t < now) {
            return Some(format!("a run can go back to a time from 0 to {now} s, not to {t} s"));
        }
        self.moments.is_empty().then(|| "the run has only begun".to_owned())
    }

    /// The run at the last snapshot at or before a time; what was known later is forgotten.
    ///
    /// # Errors
    /// If a simulation cannot be made, which has been made before.
    pub fn back(&mut self, t: f64) -> Result<Option<Back>, SimError> {
        let count = self.moments.partition_point(|moment| moment.snapshot.time() <= t);
        let Some(moment) = count.checked_sub(1).and_then(|last| self.moments.get(last)) else {
            return Ok(None);
        };
        let simulation = Simulation::resume(Arc::clone(&moment.schedule), &moment.snapshot, moment.counts)?;
        let setting = moment.setting.clone();
        // What was set at the time itself belongs to the future that is left.
        let later = self.changes.split_off(moment.changes);
        let is_before = |change: &&(When, String)| change.0.time() < t;
        let changes = later.iter().filter(is_before).cloned().collect();
        let is_ahead = |change: &&(When, String)| !is_before(change) && matches!(change.0, When::At(_));
        let planned = later.iter().filter(is_ahead).cloned().collect();
        self.again = Some(Again { rows: self.rows.split_off(moment.rows), seen: 0, differs: false });
        self.events.truncate(moment.events);
        self.moments.truncate(count);
        self.taken = Instant::now();
        Ok(Some(Back { simulation, setting, changes, planned }))
    }

    /// All rows and events, to somebody who has not seen them.
    pub fn replay(&self, observer: &mut dyn Observer) {
        for row in self.rows.chunks_exact(self.width + 1) {
            observer.row(row[0], &row[1..]);
        }
        for EventRow { time, path, what } in &self.events {
            observer.event(*time, path, what);
        }
    }

    /// The last rows of one time.
    pub fn last(&self) -> impl Iterator<Item = (f64, &[f64])> {
        let stride = self.width + 1;
        let end = self.rows.len().checked_sub(stride).map(|at| self.rows[at]);
        let begins = self.rows.chunks_exact(stride).rev().take_while(|row| Some(row[0]) == end).count();
        self.rows[self.rows.len() - begins * stride..].chunks_exact(stride).map(|row| (row[0], &row[1..]))
    }

    /// The time that was asked for has been reached again. Whether the rows on the way were those of before, to the bit.
    pub fn arrive(&mut self) -> bool {
        !self.again.take().is_some_and(|again| again.differs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_made_once_more_must_be_those_of_before() {
        let again = |rows: &[[f64; 2]]| {
            let known = Again { rows: vec![0.0, 1.0, 0.1, 2.0], seen: 0, differs: false };
            let mut history = History { again: Some(known), ..History::new(1) };
            rows.iter().for_each(|[t, value]| history.row(*t, &[*value]));
            history.arrive()
        };
        assert!(again(&[[0.0, 1.0], [0.1, 2.0]]));
        assert!(again(&[[0.0, 1.0], [0.1, 2.0], [0.2, 7.0]]), "what comes behind is new");
        assert!(!again(&[[0.0, 1.0], [0.1, 2.0_f64.next_up()]]));
        assert!(!again(&[[0.0, 1.0], [0.05, 2.0]]), "another time");
    }

    #[test]
    fn a_run_with_too_many_events_cannot_go_back() {
        let mut history = History::new(1);
        history.row(0.0, &[1.0]);
        for _ in 0..EVENTS {
            history.event(0.0, "b", "turns");
        }
        assert!(!history.is_full && history.is_due());
        history.event(0.1, "b", "turns");
        assert!(history.rows.is_empty() && history.events.is_empty() && !history.is_due());
        let refused = history.refusal(0.0, 1.0).expect("a reason");
        assert!(refused.contains("1048576 events"), "{refused}");
    }
}
