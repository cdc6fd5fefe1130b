//! Outputs that change at major steps alone: whether they did at this one.

use std::ops::Range;

use blocksim_block::schedule::{Schedule, When};

use crate::evaluate::Diagram;

/// Outputs that are evaluated at major steps alone, and what they were before the present one.
#[derive(Default)]
pub(crate) struct Stepwise {
    cells: Vec<Range<usize>>,
    before: Vec<f64>,
}

impl Stepwise {
    pub fn new(schedule: &Schedule) -> Self {
        let mut cells = Vec::new();
        for step in schedule.steps.iter().filter(|step| step.when == When::Major) {
            let block = &schedule.blocks[step.block as usize];
            let ports = block.outputs.iter().zip(&block.interface.group_of);
            let own = ports.filter(|(_, group)| **group == step.group as usize).map(|(port, _)| port);
            cells.extend(own.map(|&(start, end)| block.y + start as usize..block.y + end as usize));
        }
        let before = vec![0.0; cells.iter().map(Range::len).sum()];
        Self { cells, before }
    }
}

impl Diagram {
    /// Remembers the outputs before a major step.
    pub fn hold_steps(&mut self) {
        let Stepwise { cells, before } = &mut self.stepwise;
        let values = cells.iter().flat_map(|range| &self.signals[range.clone()]);
        before.iter_mut().zip(values).for_each(|(before, value)| *before = *value);
    }

    /// Whether any of them is another now.
    pub fn has_stepped(&self) -> bool {
        let Stepwise { cells, before } = &self.stepwise;
        let values = cells.iter().flat_map(|range| &self.signals[range.clone()]);
        before.iter().zip(values).any(|(before, value)| before.to_bits() != value.to_bits())
    }
}
