//! Which sample hits need rows on both sides, because a recorded signal jumps there.

use blocksim_block::schedule::{Instance, OutputTimes, Schedule, When};

/// What is known of the jumps of recorded signals at sample hits.
#[derive(Debug, Clone)]
pub(crate) struct Sides {
    /// Whether each recorded signal is held from row to row, so that one row tells its jump.
    pub held: Vec<bool>,
    /// Whether a recorded signal can jump at the hits of each rate, in a way that the rows due there do not tell.
    pub rates: Vec<bool>,
}

impl Sides {
    /// Rows at every major step need two at a hit where a signal jumps that is not held. A grid of output times has no
    /// rows between its points but those of rates that are hit less often than it.
    pub fn new(schedule: &Schedule) -> Self {
        let held: Vec<bool> = schedule.recorded.iter().map(|recorded| recorded.held).collect();
        let clock = &schedule.clock;
        let rates = (0..clock.rates.len()).map(|rate| {
            let period = clock.rates[rate].period as f64 * clock.tick;
            let (seldom, held_too) = match schedule.settings.output {
                OutputTimes::Steps => (true, false),
                OutputTimes::Every(spacing) => (period > spacing * (1.0 + 1e-9), true),
            };
            seldom && {
                let jumping = jumping(schedule, rate);
                let mut cells = schedule.recorded.iter().zip(&held);
                cells.any(|(recorded, held)| (held_too || !held) && jumping[recorded.cell])
            }
        });
        Self { rates: rates.collect(), held }
    }
}

/// Which cells may jump at the hits of a rate: what is sampled then, and what follows from it at the same instant.
fn jumping(schedule: &Schedule, rate: usize) -> Vec<bool> {
    let mut jumping = vec![false; schedule.initial_signals.len()];
    for step in &schedule.steps {
        let (block, group) = (&schedule.blocks[step.block as usize], step.group as usize);
        let sampled = block.rate == Some(rate);
        if step.when != When::Constant && (sampled || reads(block, group, &jumping)) {
            let outputs = block.outputs.iter().zip(&block.interface.group_of).filter(|(_, of)| **of == group);
            for (&(from, to), _) in outputs {
                jumping[block.y + from as usize..block.y + to as usize].fill(true);
            }
        }
    }
    jumping
}

/// Whether an output group depends at once on one of these cells.
fn reads(block: &Instance, group: usize, cells: &[bool]) -> bool {
    let inputs = block.gather.iter().enumerate().filter(|(input, _)| block.interface.reads(group, *input));
    inputs.into_iter().any(|(_, &(from, len))| cells[from as usize..(from + len) as usize].contains(&true))
}
