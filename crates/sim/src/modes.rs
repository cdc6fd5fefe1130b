//! Changes of modes under methods of fixed step, which choose them at their steps and locate no event: told as the
//! located ones are, by the name that guard and mode share (dry friction that sticks or slips).

use blocksim_block::schedule::{Schedule, Solver};

use crate::{Observer, Simulation};

/// Modes that are looked at.
#[derive(Debug, Clone, Default)]
pub(crate) struct Modes {
    /// Block, guard and place among all discrete states.
    watched: Vec<(usize, usize, usize)>,
    /// What they were before the instant.
    before: Vec<f64>,
}

impl Modes {
    pub fn new(schedule: &Schedule) -> Self {
        let mut watched = Vec::new();
        if let Solver::Fixed { .. } = schedule.settings.solver {
            for (index, block) in schedule.blocks.iter().enumerate() {
                for (guard, named) in block.interface.guards.iter().enumerate() {
                    let mode = block.interface.discrete.iter().position(|state| state.name == named.name);
                    watched.extend(mode.map(|mode| (index, guard, block.d + mode)));
                }
            }
        }
        Self { before: vec![0.0; watched.len()], watched }
    }

    /// Notes what they are.
    pub fn note(&mut self, d: &[f64]) {
        self.before.iter_mut().zip(&self.watched).for_each(|(before, &(.., cell))| *before = d[cell]);
    }
}

impl Simulation {
    /// Tells the modes that have changed since they were noted.
    pub(crate) fn tell_modes(&self, observer: &mut dyn Observer) {
        for (&(block, guard, cell), before) in self.modes.watched.iter().zip(&self.modes.before) {
            if self.diagram.d[cell] != *before {
                let block = &self.schedule.blocks[block];
                observer.event(self.t, &block.path, &block.interface.guards[guard].name);
            }
        }
    }
}
