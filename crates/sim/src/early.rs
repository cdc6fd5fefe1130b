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

use std::collections::{HashMap, HashSet};

use blocksim_block::schedule::Schedule;
use blocksim_solve::Failed;

use crate::evaluate::Diagram;
use crate::major::report_jump;
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
            let cone = graph.behind(index);
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

/// Which output group depends on which at the same time.
struct Graph<'a> {
    schedule: &'a Schedule,
    /// Groups that the inputs of each block come from, input by input.
    inputs: Vec<Vec<Vec<(usize, usize)>>>,
    /// The same of all inputs.
    sources: Vec<Vec<(usize, usize)>>,
}

impl<'a> Graph<'a> {
    fn new(schedule: &'a Schedule) -> Self {
        let mut group_of = HashMap::new();
        for (index, block) in schedule.blocks.iter().enumerate() {
            for (port, &(start, end)) in block.outputs.iter().enumerate() {
                let group = block.interface.group_of[port];
                group_of.extend((start..end).map(|cell| (block.y + cell as usize, (index, group))));
            }
        }
        let from = |&(cell, length): &(u32, u32)| -> Vec<(usize, usize)> {
            let cells = cell as usize..(cell + length) as usize;
            cells.filter_map(|cell| group_of.get(&cell).copied()).collect()
        };
        let inputs: Vec<Vec<Vec<(usize, usize)>>> =
            schedule.blocks.iter().map(|block| block.gather.iter().map(from).collect()).collect();
        let sources = inputs.iter().map(|inputs| inputs.concat()).collect();
        Self { schedule, inputs, sources }
    }

    /// All groups that the inputs of a block depend on at the same time.
    fn behind(&self, block: usize) -> HashSet<(usize, usize)> {
        let mut found = HashSet::new();
        let mut stack = self.sources[block].clone();
        while let Some((block, group)) = stack.pop() {
            if found.insert((block, group)) {
                let interface = &self.schedule.blocks[block].interface;
                let inputs = self.inputs[block].iter().enumerate();
                let read = inputs.filter(|(input, _)| interface.reads(group, *input));
                stack.extend(read.flat_map(|(_, from)| from));
                let constraint = interface.constraint.as_ref();
                let rest = constraint.filter(|constraint| constraint.group == group);
                stack.extend(rest.map(|constraint| (block, constraint.rest)));
            }
        }
        found
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
