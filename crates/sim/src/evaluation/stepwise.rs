//! Outputs that change at major steps alone: whether they did at this one.

use blocksim_block::schedule::{Schedule, When};

use crate::evaluation::evaluate::Diagram;
use crate::program::spread::written;

/// Outputs that are evaluated at major steps alone and on which derivatives, guards or memories depend, and what they were before the
/// present one.
#[derive(Default)]
pub(crate) struct Stepwise {
    cells: Vec<usize>,
    before: Vec<f64>,
}

impl Stepwise {
    pub fn new(schedule: &Schedule) -> Self {
        let steps = schedule.steps.iter().filter(|step| step.when == When::Major && step.acts);
        let cells: Vec<usize> = steps.flat_map(|step| written(schedule, step)).collect();
        Self { before: vec![0.0; cells.len()], cells }
    }
}

impl Diagram {
    /// Remembers the outputs before a major step.
    pub fn hold_steps(&mut self) {
        let Stepwise { cells, before } = &mut self.stepwise;
        before.iter_mut().zip(cells).for_each(|(before, cell)| *before = self.signals[*cell]);
    }

    /// Whether any of them is another now.
    pub fn has_stepped(&self) -> bool {
        let Stepwise { cells, before } = &self.stepwise;
        before.iter().zip(cells).any(|(before, cell)| before.to_bits() != self.signals[*cell].to_bits())
    }
}
