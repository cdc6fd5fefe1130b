//! Angles of which only the remainder of a turn counts: no step goes further than an eighth of a turn.
//!
//! What turns steadily has no error that a step could be too long for, while a condition on its sine comes true with
//! each turn: steps over many turns would pass over all but a few. So the way that each angle has gone is looked at after
//! every step. A step that went too far is made once more, shorter, and the next one begins no longer than the present
//! speed allows.

use blocksim_block::schedule::{Schedule, Solver};

use crate::{SimError, Simulation};

/// Longest way within a step, rad.
const LONGEST: f64 = std::f64::consts::FRAC_PI_4;
/// Part of the longest way that a step is made for.
const AIM: f64 = 0.95;
/// How far beyond the longest way a step may go before it is made once more.
const SLACK: f64 = 1.5;
/// Repetitions of one step, at most.
const REPEATS: u32 = 60;

/// The angles of a diagram, and how far they go.
#[derive(Debug, Clone, Default)]
pub(crate) struct Angles {
    /// States that are angles.
    states: Vec<usize>,
    /// Cells of signals that are angles.
    cells: Vec<usize>,
    /// Their values at the start of the step.
    before: Vec<f64>,
    /// How fast the fastest one went in the last step, rad/s.
    pub rate: f64,
}

impl Angles {
    pub fn new(schedule: &Schedule) -> Self {
        if matches!(schedule.settings.solver, Solver::Fixed { .. }) {
            return Self::default();
        }
        let (mut states, mut cells) = (Vec::new(), Vec::new());
        for (i, block) in schedule.blocks.iter().enumerate() {
            let matters = |minor: bool| minor || schedule.states == 0;
            let seen = schedule.steps.iter().any(|step| step.block as usize == i && matters(step.minor));
            if !seen && !block.watched {
                continue;
            }
            states.extend(block.interface.turning_states.iter().map(|state| block.x + state));
            // Where each input of the block comes from.
            let sources = block.gather.iter().flat_map(|&(from, len)| from..from + len);
            let sources: Vec<usize> = sources.map(|cell| cell as usize).collect();
            for &input in &block.interface.turning_inputs {
                let (start, end) = block.inputs[input];
                cells.extend_from_slice(&sources[start as usize..end as usize]);
            }
        }
        cells.sort_unstable();
        cells.dedup();
        let before = vec![0.0; states.len() + cells.len()];
        Self { states, cells, before, rate: 0.0 }
    }

    /// Whether there are any.
    pub fn are_seen(&self) -> bool {
        !self.before.is_empty()
    }

    fn values<'a>(&'a self, x: &'a [f64], signals: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.states.iter().map(|&i| x[i]).chain(self.cells.iter().map(|&i| signals[i]))
    }

    /// Takes the values at the start of a step.
    fn begin(&mut self, x: &[f64], signals: &[f64]) {
        let mut before = std::mem::take(&mut self.before);
        before.iter_mut().zip(self.values(x, signals)).for_each(|(before, value)| *before = value);
        self.before = before;
    }

    /// The longest way that any of them has gone, rad. What is not a number has gone nowhere.
    fn way(&self, x: &[f64], signals: &[f64]) -> f64 {
        let ways =
            self.before.iter().zip(self.values(x, signals)).map(|(before, value)| (value - before).abs());
        ways.fold(0.0, f64::max)
    }
}

impl Simulation {
    /// One step of the solver, in which no angle goes far.
    pub(crate) fn step_by_angles(&mut self, limit: f64) -> Result<(), SimError> {
        if !self.angles.are_seen() {
            return self.step(limit);
        }
        let t0 = self.t;
        self.evaluate_here()?;
        self.angles.begin(&self.x, &self.diagram.signals);
        let mut longest = AIM * LONGEST / self.angles.rate;
        for repeat in 0..=REPEATS {
            let end = limit.min(t0 + longest);
            // Too short to be told apart: as it would be without.
            let end = if end > t0 { end } else { limit };
            if repeat == 0 {
                self.step(end)?
            } else {
                self.repeat(t0, end)?
            }
            self.evaluate_here()?;
            let way = self.angles.way(&self.x, &self.diagram.signals);
            self.angles.rate = way / (self.t - t0);
            if way <= SLACK * LONGEST || !way.is_finite() {
                break;
            }
            longest = AIM * LONGEST / self.angles.rate;
        }
        Ok(())
    }

    /// Evaluates the signals that are angles; states are known as they are.
    fn evaluate_here(&mut self) -> Result<(), SimError> {
        if self.angles.cells.is_empty() {
            return Ok(());
        }
        let evaluated = self.diagram.continuous(self.t, &self.x);
        self.held(evaluated)
    }
}
