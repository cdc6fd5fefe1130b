//! Which sample hits need rows on both sides, because a recorded signal jumps there.

use blocksim_block::schedule::{OutputTimes, Schedule, When};

use crate::program::spread::spread;

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
    spread(schedule, &mut jumping, |step, read| {
        let sampled = schedule.blocks[step.block as usize].rate == Some(rate);
        step.when != When::Constant && (sampled || read)
    });
    jumping
}
