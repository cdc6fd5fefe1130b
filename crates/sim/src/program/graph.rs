//! Which output group depends on which at the same time.

use std::collections::{HashMap, HashSet};

use blocksim_block::schedule::Schedule;

/// Output groups, each named by its block and its number there, and what they come from.
pub(crate) struct Graph<'a> {
    schedule: &'a Schedule,
    /// The block and group that write each cell among the signals.
    group_of: HashMap<usize, (usize, usize)>,
    /// Groups that the inputs of each block come from.
    pub sources: Vec<Vec<(usize, usize)>>,
}

impl<'a> Graph<'a> {
    pub fn new(schedule: &'a Schedule) -> Self {
        let mut group_of = HashMap::new();
        for (index, block) in schedule.blocks.iter().enumerate() {
            for group in 0..block.groups() {
                group_of.extend(block.written(group).map(|cell| (cell, (index, group))));
            }
        }
        let from = |&(cell, length): &(u32, u32)| -> Vec<(usize, usize)> {
            let cells = cell as usize..(cell + length) as usize;
            cells.filter_map(|cell| group_of.get(&cell).copied()).collect()
        };
        let sources = schedule.blocks.iter().map(|block| block.gather.iter().flat_map(from).collect());
        Self { schedule, sources: sources.collect(), group_of }
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
                let instance = &self.schedule.blocks[block];
                stack.extend(instance.read(group).filter_map(|cell| self.writer(cell)));
                let interface = &instance.interface;
                let constraint = interface.constraint.as_ref();
                let rest = constraint.filter(|constraint| constraint.group == group);
                stack.extend(rest.map(|constraint| (block, constraint.rest)));
            }
        }
        found
    }
}
