//! Output groups in an order in which every one follows those that it reads.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use blocksim_block::problem::Problem;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use crate::flatten::Flat;
use crate::infer::Typed;

use super::loops::Ring;

/// A block and one of its output groups.
pub(super) type Group = (usize, usize);

/// Output groups in the order of evaluation.
#[derive(Default)]
pub(super) struct Sorted {
    pub groups: Vec<Group>,
    /// Algebraic loops; their groups stand one behind the other in `groups`.
    pub rings: Vec<Ring>,
}

/// Output groups and what they wait for.
pub(super) struct Order<'a> {
    pub flat: &'a Flat,
    pub typed: &'a Typed,
    pub graph: DiGraph<Group, ()>,
    pub node_of: HashMap<Group, NodeIndex>,
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
            if let Some(constraint) = &typed.interfaces[block].constraint {
                let (rest, group) = ((block, constraint.rest), (block, constraint.group));
                order.graph.update_edge(order.node_of[&rest], order.node_of[&group], ());
            }
        }
        order
    }

    /// Groups that a group reads at the same instant, with the input.
    pub(super) fn reads(&self, block: usize, group: usize) -> Vec<(Group, usize)> {
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

    /// Groups in an order in which every one follows those that it reads; ties go by path, then group, so that the order of
    /// the file does not matter. Those of an algebraic loop stand together.
    ///
    /// # Errors
    /// Each loop that cannot be solved.
    pub(super) fn topological(&self) -> Result<Sorted, Vec<Problem>> {
        let components = kosaraju_scc(&self.graph);
        let mut part_of = vec![0; self.graph.node_count()];
        for (part, nodes) in components.iter().enumerate() {
            nodes.iter().for_each(|node| part_of[node.index()] = part);
        }
        let mut waiting = vec![0_usize; components.len()];
        let leaving = |part: usize| {
            let edges = components[part].iter().flat_map(|node| self.graph.neighbors(*node));
            edges.map(|after| part_of[after.index()]).filter(move |after| *after != part)
        };
        for part in 0..components.len() {
            leaving(part).for_each(|after| waiting[after] += 1);
        }
        // Blocks are sorted by path, so their index is their rank.
        let rank = |part: usize| {
            components[part].iter().map(|node| self.graph[*node]).min().map(|first| (first, part))
        };
        let first = (0..components.len()).filter(|part| waiting[*part] == 0).filter_map(rank);
        let mut ready: BinaryHeap<_> = first.map(Reverse).collect();
        let (mut sorted, mut problems) = (Sorted::default(), Vec::new());
        while let Some(Reverse((group, part))) = ready.pop() {
            let nodes = &components[part];
            if nodes.len() == 1 && !self.graph.contains_edge(nodes[0], nodes[0]) {
                sorted.groups.push(group);
            } else {
                match self.ring(nodes) {
                    Ok(ring) => {
                        sorted.groups.extend(&ring.groups);
                        sorted.rings.push(ring);
                    }
                    Err(problem) => problems.push(problem),
                }
            }
            for after in leaving(part) {
                waiting[after] -= 1;
                if waiting[after] == 0 {
                    ready.extend(rank(after).map(Reverse));
                }
            }
        }
        if problems.is_empty() { Ok(sorted) } else { Err(problems) }
    }
}
