//! Resets from outside, before anything else of that time.
//!
//! When a pulse resets an integrator, the value before the reset belongs to the time before, like the pulse that was still
//! low. Evaluated in one pass, everything else would see the pulse that is high beside the old value of the integrator, a
//! state that never was, and logic would count it. So blocks whose reset does not depend on their own output at the same
//! time jump first: what their inputs come from is evaluated alone, they jump, and only then the whole diagram is
//! evaluated.
//!
//! A reset that follows from the output itself (an integrator that sets itself back at a limit) has a value before it
//! that has been reached: the diagram sees it, then the jump.

use std::collections::HashSet;

use blocksim_block::schedule::Schedule;
use blocksim_solve::Failed;

use crate::evaluation::evaluate::Diagram;
use crate::program::graph::Graph;
use crate::stepping::major::report_jump;
use crate::{Observer, SimError, Simulation};

/// Who jumps early, and what must be known for it.
#[derive(Debug, Default)]
pub(crate) struct Early {
    /// Blocks in the order of evaluation.
    pub jumping: Vec<usize>,
    /// Calls, as indices among those of a major step.
    pub calls: Vec<usize>,
}

impl Early {
    pub fn new(schedule: &Schedule) -> Self {
        let graph = Graph::new(schedule);
        let mut early = Self::default();
        let mut wanted = HashSet::new();
        for (index, block) in schedule.blocks.iter().enumerate() {
            // A network jumps with what its own evaluation has brought.
            if !block.interface.jumps || !block.parts.is_empty() {
                continue;
            }
            let cone = graph.behind(graph.sources[index].clone());
            if cone.is_empty() || cone.iter().any(|&(from, _)| from == index) {
                continue;
            }
            early.jumping.push(index);
            wanted.extend(cone);
        }
        let steps = schedule.steps.iter().enumerate();
        early.calls = steps
            .filter(|(_, step)| wanted.contains(&(step.block as usize, step.group as usize)))
            .map(|(call, _)| call)
            .collect();
        // One whose inputs come from another one jumps after it.
        let first = |block: usize| {
            early.calls.iter().rposition(|&call| {
                let step = &schedule.steps[call];
                graph.sources[block].contains(&(step.block as usize, step.group as usize))
            })
        };
        early.jumping.sort_by_key(|&block| (first(block), block));
        early
    }
}

impl Diagram {
    /// Evaluates what the blocks that jump early depend on.
    pub fn before_jumps(&mut self, t: f64, x: &[f64], due: &[bool], first: bool) -> Result<(), Failed> {
        self.place(t, x);
        let mut behind = 0;
        for i in 0..self.plan.early.calls.len() {
            // All calls of a loop are among these, if one is.
            if self.plan.early.calls[i] >= behind {
                behind = self.call(self.plan.early.calls[i], due, first)?;
            }
        }
        Ok(())
    }
}

impl Simulation {
    /// Lets those jump whose jumps come from outside. Returns whether any did.
    pub(crate) fn jump_early(&mut self, first: bool, observer: &mut dyn Observer) -> Result<bool, SimError> {
        if self.diagram.plan.early.jumping.is_empty() {
            return Ok(false);
        }
        if !first && self.hits.due.contains(&true) && !self.rows.knows_before() {
            self.look_back(true)?;
        }
        let mut any = false;
        for k in 0..self.diagram.plan.early.jumping.len() {
            let block = self.diagram.plan.early.jumping[k];
            // Those further on may see the states of those that have jumped.
            if k == 0 || any {
                let known = self.diagram.before_jumps(self.t, &self.x, &self.hits.due, first);
                self.held(known)?;
            }
            let jumped = self.diagram.jump_one(block, &mut self.x);
            if self.held(jumped)? {
                any = true;
                if !first {
                    report_jump(&self.schedule.blocks[block], self.t, observer);
                }
            }
        }
        Ok(any)
    }
}
