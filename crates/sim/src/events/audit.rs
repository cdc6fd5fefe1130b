//! Was anything passed over? Every guard is looked at on a fine grid within each step that was kept.
//!
//! The search for events chooses where it looks; the audit looks everywhere, at a price. Between the ends of a step no
//! guard may cross zero in the way that it watches, because the step would have been cut there.

use blocksim_block::schedule::Schedule;
use blocksim_solve::Failed;

use crate::diagnose::guard_of;
use crate::evaluation::evaluate::Diagram;
use crate::events::crossings::summary;
use crate::events::guards::{Guards, Stride};
use crate::program::influence::Undeclared;

/// Points within a step.
const POINTS: u32 = 64;
/// Part of the largest value that a guard has had, below which it is zero but for rounding.
const ROUNDING: f64 = 1e-10;
/// Findings that are kept; all are counted.
const KEPT: usize = 1000;

/// A change of a watched condition that a run has passed over.
#[derive(Debug, Clone, PartialEq)]
pub struct Missed {
    /// When the guard was seen on the other side, s.
    pub t: f64,
    /// The part.
    pub path: String,
    /// What it does there, in words that go behind its path.
    pub what: String,
    /// How far the guard was beyond zero there.
    pub beyond: f64,
}

/// What an audit has found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// Points at which all guards were looked at.
    pub looks: u64,
    /// Changes that were passed over.
    pub count: u64,
    /// The first thousand of them.
    pub missed: Vec<Missed>,
    /// Derivatives that depend on more at the present time than blocks and connections say.
    pub undeclared: Vec<Undeclared>,
}

/// An audit of a run in progress.
#[derive(Debug, Clone, Default)]
pub(crate) struct Audit {
    looks: u64,
    /// Guards at the start of the step, and at the last point.
    start: Vec<f64>,
    last: Vec<f64>,
    /// Largest magnitude of each guard so far.
    scale: Vec<f64>,
    /// Guards that crossed unseen, with time and value; and how many more.
    hits: Vec<(usize, f64, f64)>,
    more: u64,
}

impl Audit {
    /// Notes the guards at the start of a step.
    pub fn begin(&mut self, start: &[f64]) {
        self.start.clear();
        self.start.extend_from_slice(start);
        self.scale.resize(start.len(), 0.0);
        for (scale, start) in self.scale.iter_mut().zip(start) {
            *scale = scale.max(start.abs());
        }
    }

    /// Looks at a step that ends at `end`, at an event if it was cut.
    pub fn look(
        &mut self,
        guards: &mut Guards,
        diagram: &mut Diagram,
        stride: &Stride,
        end: f64,
    ) -> Result<(), Failed> {
        let h = end - stride.t0;
        self.last.clone_from(&self.start);
        for k in 1..POINTS {
            let t = stride.t0 + h * (f64::from(k) / f64::from(POINTS));
            // What is seen at the time of the event itself is that event.
            if t <= stride.t0 || t >= end - guards.resolution.same(end) {
                continue;
            }
            guards.at(t, diagram, stride)?;
            self.looks += 1;
            for (i, &value) in guards.trial.iter().enumerate() {
                self.scale[i] = self.scale[i].max(value.abs());
                if value.abs() <= ROUNDING * self.scale[i] {
                    continue;
                }
                if guards.events[i].happens(self.last[i], value) {
                    if self.hits.len() < KEPT {
                        self.hits.push((i, t, value.abs()));
                    } else {
                        self.more += 1;
                    }
                }
                self.last[i] = value;
            }
        }
        Ok(())
    }

    /// What was passed over so far. What is rounding, the whole run decides.
    pub fn findings(&self, schedule: &Schedule) -> Findings {
        let counts = |&&(guard, _, beyond): &&(usize, f64, f64)| beyond > ROUNDING * self.scale[guard];
        let missed: Vec<Missed> = self
            .hits
            .iter()
            .filter(counts)
            .filter_map(|&(guard, t, beyond)| {
                let (block, guard) = guard_of(schedule, guard)?;
                let path = guard.subject.part.as_ref().unwrap_or(&block.path).clone();
                Some(Missed { t, path, what: summary(block, guard), beyond })
            })
            .collect();
        Findings { looks: self.looks, count: missed.len() as u64 + self.more, missed, undeclared: Vec::new() }
    }
}
