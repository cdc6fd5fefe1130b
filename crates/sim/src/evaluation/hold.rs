//! Copies of outputs, for blocks that do not always run and hold what they gave last.

use crate::evaluation::evaluate::Diagram;

impl Diagram {
    /// Copies the outputs of the blocks that hold them to their discrete states. The signals must be those of a whole
    /// evaluation. A block that does not run gives its copy, so nothing changes for it.
    pub fn hold_outputs(&mut self) {
        let Self { plan, schedule, signals, d, .. } = self;
        for &block in &plan.holding {
            let unit = &plan.units[block];
            let Some(first) = schedule.blocks[block].interface.holds else { continue };
            let from = unit.d.start as usize + first;
            d[from..from + unit.y.len()].copy_from_slice(&signals[unit.y.range()]);
        }
    }
}
