//! Which output group depends on which at the same time.

use std::collections::{HashMap, HashSet};

use blocksim_block::schedule::Schedule;

/// Output groups, each named by its block and its number there, and what they come from.
pub(crate) struct Graph<'a> {
    schedule: &'a Schedule,
    /// The block and group that write each cell among the signals.
    group_of: HashMap<usize, (usize, usize)>,
    /// Groups that the inputs of each block come from, input by input.
    inputs: Vec<Vec<Vec<(usize, usize)>>>,
    /// The same of all inputs.
    pub sources: Vec<Vec<(usize, usize)>>,
}

impl<'a> Graph<'a> {
    pub fn new(schedule: &'a Schedule) -> Self {
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
        Self { schedule, group_of, inputs, sources }
    }

    /// The block and group that write a cell among the signals.
    pub fn writer(&self, cell: usize) -> Option<(usize, usize)> {
        self.group_of.get(&cell).copied()
    }

    /// These groups and all that they depend on at the same time.
    pub fn behind(&self, mut stack: Vec<(usize, usize)>) -> HashSet<(usize, usize)> {
        let mut found = HashSet::new();
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
