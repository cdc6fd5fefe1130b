//! Was anything passed over? Every guard is looked at on a fine grid within each step that was kept.
//!
//! The search for events chooses where it looks; the audit looks everywhere, at a price. Between the ends of a step no
//! guard may cross zero in the way that it watches, because the step would have been cut there.

use blocksim_block::Crossing;
use blocksim_solve::Failed;

use crate::evaluate::Diagram;
use crate::guards::{Guards, Stride};

/// Points within a step.
const POINTS: u32 = 64;
/// Part of the largest value that a guard has had, below which it is zero but for rounding.
const ROUNDING: f64 = 1e-10;
/// Findings that are kept; all are counted.
const KEPT: usize = 100;

/// A change of a watched condition that a run has passed over.
#[derive(Debug, Clone, PartialEq)]
pub struct Missed {
    /// When the guard was seen on the other side, s.
    pub t: f64,
    /// The block.
    pub path: String,
    /// Its guard.
    pub guard: String,
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
    /// The first hundred of them.
    pub missed: Vec<Missed>,
}

/// An audit of a run in progress.
#[derive(Debug, Clone, Default)]
pub(crate) struct Audit {
    pub findings: Findings,
    /// Guards at the start of the step, and at the last point.
    start: Vec<f64>,
    last: Vec<f64>,
    /// Largest magnitude of each guard so far.
    scale: Vec<f64>,
    /// Guards that crossed unseen in this step, with place and value.
    hits: Vec<(usize, f64, f64)>,
}

impl Audit {
    /// Notes the guards at the start of a step.
    pub fn begin(&mut self, start: &[f64]) {
        self.start.clear();
        self.start.extend_from_slice(start);
        self.scale.resize(start.len(), 0.0);
    }

    /// Looks at a step that ends at `end`, at an event if `cut`.
    pub fn look(
        &mut self,
        guards: &mut Guards,
        diagram: &mut Diagram,
        stride: &Stride,
        end: f64,
    ) -> Result<(), Failed> {
        let h = end - stride.t0;
        self.last.clone_from(&self.start);
        self.hits.clear();
        for k in 1..POINTS {
            let t = stride.t0 + h * (f64::from(k) / f64::from(POINTS));
            if t <= stride.t0 || t >= end {
                continue;
            }
            guards.at(t, diagram, stride)?;
            self.findings.looks += 1;
            for (i, &value) in guards.trial.iter().enumerate() {
                self.scale[i] = self.scale[i].max(value.abs());
                let near = value.abs() <= ROUNDING * self.scale[i];
                let crosses = |events: Crossing| events.happens(self.last[i], value);
                if !near && crosses(guards.events[i]) {
                    self.hits.push((i, t, value.abs()));
                }
                if !near {
                    self.last[i] = value;
                }
            }
        }
        Ok(())
    }

    /// Takes down what the last step has passed over; `name` says which block and guard a number means.
    pub fn report(&mut self, mut name: impl FnMut(usize) -> Option<(String, String)>) {
        for &(i, t, beyond) in &self.hits {
            self.findings.count += 1;
            if self.findings.missed.len() < KEPT
                && let Some((path, guard)) = name(i)
            {
                self.findings.missed.push(Missed { t, path, guard, beyond });
            }
        }
    }
}
