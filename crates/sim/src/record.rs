//! Rows of recorded values, and who gets them.

use blocksim_block::schedule::{OutputTimes, Schedule};

use crate::Counts;
use crate::clock::Grid;

/// Who is told what a simulation brings.
pub trait Observer {
    /// A row: time in s and one value, in SI units, for each entry of `Schedule::recorded`. Times do not decrease; two
    /// rows of one time stand around a jump.
    fn row(&mut self, t: f64, values: &[f64]);

    /// A guard of the block at `path` crossed zero, or the block jumped (`what` is then `jump`).
    fn event(&mut self, _t: f64, _path: &str, _what: &str) {}

    /// Asked about every 256 steps whether to go on.
    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        Control::Go
    }
}

/// Whether to go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Go,
    /// Stop here; the simulation may be continued later.
    Stop,
}

/// What is recorded, and when.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    cells: Vec<usize>,
    /// The present row.
    pub values: Vec<f64>,
    /// The grid, unless all major steps are recorded.
    pub grid: Option<Grid>,
}

impl Rows {
    pub fn new(schedule: &Schedule) -> Self {
        let cells: Vec<usize> = schedule.recorded.iter().map(|recorded| recorded.cell).collect();
        Self {
            values: vec![0.0; cells.len()],
            cells,
            grid: match schedule.settings.output {
                OutputTimes::Steps => None,
                OutputTimes::Every(spacing) => Some(Grid::new(spacing)),
            },
        }
    }

    /// Takes the present row from the signals; returns whether all of it is finite.
    pub fn take(&mut self, signals: &[f64]) -> bool {
        for (value, &cell) in self.values.iter_mut().zip(&self.cells) {
            *value = signals[cell];
        }
        self.values.iter().all(|value| value.is_finite())
    }

    /// Whether a row is due at a major step for the sake of its time.
    pub fn are_due(&mut self, t: f64) -> bool {
        self.grid.as_mut().is_none_or(|grid| grid.pass(t))
    }

    /// The next point of the grid, if it lies before `end` (or at it).
    pub fn next_before(&self, end: f64) -> Option<f64> {
        self.grid.as_ref().map(Grid::time).filter(|&t| t <= end)
    }
}
