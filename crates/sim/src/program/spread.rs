//! What depends at once on some signals.

use blocksim_block::schedule::{Schedule, Step};

/// Marks cells that depend at the same instant on marked `cells`. A step is asked whether it passes changes on, and told
/// whether it, or one of the loop that it belongs to, reads a marked cell. Returns what each step was told.
pub(crate) fn spread(
    schedule: &Schedule,
    cells: &mut [bool],
    passes: impl Fn(&Step, bool) -> bool,
) -> Vec<bool> {
    let mut told = Vec::with_capacity(schedule.steps.len());
    while let Some(step) = schedule.steps.get(told.len()) {
        let found = schedule.loops.iter().find(|found| found.first == told.len());
        let together = found.map_or(std::slice::from_ref(step), |found| {
            &schedule.steps[found.first..found.first + found.count]
        });
        let reads = together.iter().any(|step| reads(schedule, step, cells));
        // A member of a loop that is reached some other way reaches the others.
        let reached = reads || together.len() > 1 && together.iter().any(|step| passes(step, false));
        for step in together {
            if passes(step, reached) {
                written(schedule, step).for_each(|cell| cells[cell] = true);
            }
            told.push(reached);
        }
    }
    told
}

/// Whether a step depends at once on one of these cells.
fn reads(schedule: &Schedule, step: &Step, cells: &[bool]) -> bool {
    let block = &schedule.blocks[step.block as usize];
    block.read(step.group as usize).any(|cell| cells[cell])
}

/// Cells that a group of outputs writes.
pub(crate) fn written<'a>(schedule: &'a Schedule, step: &'a Step) -> impl Iterator<Item = usize> + 'a {
    schedule.blocks[step.block as usize].written(step.group as usize)
}
