//! Output groups in an order in which every one follows those that it reads.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use blocksim_block::problem::Problem;
use petgraph::Direction;
use petgraph::graph::{DiGraph, NodeIndex};

use crate::flatten::Flat;
use crate::infer::Typed;

/// Output groups and what they wait for.
pub(super) struct Order<'a> {
    pub flat: &'a Flat,
    pub typed: &'a Typed,
    pub graph: DiGraph<(usize, usize), ()>,
    pub node_of: HashMap<(usize, usize), NodeIndex>,
}

impl<'a> Order<'a> {
    pub(super) fn new(flat: &'a Flat, typed: &'a Typed) -> Self {
        let mut graph = DiGraph::new();
        let mut node_of = HashMap::new();
        for (block, interface) in typed.interfaces.iter().enumerate() {
            for group in 0..interface.groups.len() {
                node_of.insert((block, group), graph.add_node((block, group)));
            }
        }
        let mut order = Self { flat, typed, graph, node_of };
        for block in 0..flat.blocks.len() {
            for group in 0..typed.interfaces[block].groups.len() {
                for (from, _) in order.reads(block, group) {
                    let (a, b) = (order.node_of[&from], order.node_of[&(block, group)]);
                    order.graph.update_edge(a, b, ());
                }
            }
        }
        order
    }

    /// Groups that a group reads at the same instant, with the input.
    pub(super) fn reads(&self, block: usize, group: usize) -> Vec<((usize, usize), usize)> {
        let interface = &self.typed.interfaces[block];
        let mut reads = Vec::new();
        for (input, source) in self.flat.blocks[block].inputs.iter().enumerate() {
            if let Some(source) = source
                && interface.reads(group, input)
            {
                let from = (source.block, self.typed.interfaces[source.block].group_of[source.output]);
                reads.push((from, input));
            }
        }
        reads
    }

    /// Groups in an order in which every one follows those that it reads; ties go by path, then group, so that
    /// the order of the file does not matter.
    pub(super) fn topological(&self) -> Result<Vec<(usize, usize)>, Vec<Problem>> {
        let mut waiting: HashMap<NodeIndex, usize> = HashMap::new();
        let mut ready = BinaryHeap::new();
        for node in self.graph.node_indices() {
            let count = self.graph.neighbors_directed(node, Direction::Incoming).count();
            waiting.insert(node, count);
            if count == 0 {
                ready.push(Reverse(self.graph[node]));
            }
        }
        // Blocks are sorted by path, so their index is their rank.
        let mut sorted = Vec::with_capacity(self.graph.node_count());
        while let Some(Reverse(next)) = ready.pop() {
            sorted.push(next);
            for after in self.graph.neighbors_directed(self.node_of[&next], Direction::Outgoing) {
                if let Some(count) = waiting.get_mut(&after) {
                    *count -= 1;
                    if *count == 0 {
                        ready.push(Reverse(self.graph[after]));
                    }
                }
            }
        }
        if sorted.len() == self.graph.node_count() { Ok(sorted) } else { Err(self.loops()) }
    }
}
