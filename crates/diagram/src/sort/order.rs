//! Output groups in an order in which every one follows those that it reads.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use crate::flatten::{Flat, Source};
use crate::infer::Typed;

use super::laws::Laws;
use super::loops::Ring;

/// A block and one of its output groups.
pub(super) type Group = (usize, usize);

/// A block and a cell of its outputs.
pub(super) type Cell = (usize, u32);

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
    pub laws: &'a Laws,
    /// The groups in the order of their numbers, see [`number`](Self::number).
    pub graph: DiGraph<Group, ()>,
    /// Number of the first group of each block.
    first: Vec<usize>,
    /// Groups that each group reads at the same instant, one behind the other, and where those of each end.
    read: Vec<Group>,
    read_to: Vec<usize>,
    /// Its strongly connected components.
    components: Vec<Vec<NodeIndex>>,
}

impl<'a> Order<'a> {
    pub(super) fn new(flat: &'a Flat, typed: &'a Typed, laws: &'a Laws) -> Self {
        let mut order = Self {
            flat,
            typed,
            laws,
            graph: DiGraph::with_capacity(flat.blocks.len(), flat.blocks.len()),
            first: Vec::with_capacity(flat.blocks.len()),
            read: Vec::new(),
            read_to: Vec::new(),
            components: Vec::new(),
        };
        for block in 0..flat.blocks.len() {
            order.first.push(order.graph.node_count());
            for group in 0..order.groups(block) {
                order.graph.add_node((block, group));
            }
        }
        // The reader that each group has got an edge to last: many may read one, so that the graph is not asked.
        let mut last = vec![None; order.graph.node_count()];
        for block in 0..flat.blocks.len() {
            for group in 0..order.groups(block) {
                let reader = order.node((block, group));
                for (from, _) in order.reads(block, group) {
                    order.read.push(from);
                    if last[order.number(from)].replace(reader) != Some(reader) {
                        order.graph.add_edge(order.node(from), reader, ());
                    }
                }
                order.read_to.push(order.read.len());
            }
            for (from, to) in &typed.interfaces[block].before {
                order.graph.update_edge(order.node((block, *from)), order.node((block, *to)), ());
            }
            if let Some(constraint) = &typed.interfaces[block].constraint {
                let (rest, group) = ((block, constraint.rest), (block, constraint.group));
                order.graph.update_edge(order.node(rest), order.node(group), ());
            }
        }
        order.components = kosaraju_scc(&order.graph);
        order
    }

    /// The number of a group among all groups.
    pub(super) fn number(&self, (block, group): Group) -> usize {
        self.first[block] + group
    }

    /// The node of a group in the graph.
    pub(super) fn node(&self, group: Group) -> NodeIndex {
        NodeIndex::new(self.number(group))
    }

    /// Groups that a group reads at the same instant.
    pub(super) fn read(&self, group: Group) -> &[Group] {
        let number = self.number(group);
        let start = number.checked_sub(1).map_or(0, |before| self.read_to[before]);
        &self.read[start..self.read_to[number]]
    }

    /// Number of output groups of a block.
    pub(super) fn groups(&self, block: usize) -> usize {
        self.laws.blocks[block].values().map_or(self.typed.interfaces[block].groups.len(), <[_]>::len)
    }

    /// Groups that a group reads at the same instant, with the input.
    pub(super) fn reads(&self, block: usize, group: usize) -> Vec<(Group, usize)> {
        let mut reads = Vec::new();
        self.each_read(block, group, |source, element, input| match element {
            Some(element) => reads.push((self.writer(source, element), input)),
            None => reads.extend(self.writers(source.block, source.output).map(|from| (from, input))),
        });
        reads.dedup();
        reads
    }

    /// Cells among the outputs of blocks that a group reads at the same instant.
    pub(super) fn reads_cells(&self, block: usize, group: usize) -> Vec<Cell> {
        let mut reads = Vec::new();
        self.each_read(block, group, |source, element, _| {
            let (start, end) = self.laws.blocks[source.block].outputs[source.output];
            let cells = element.map_or(start..end, |element| start + element..start + element + 1);
            reads.extend(cells.map(|cell| (source.block, cell)));
        });
        reads
    }

    /// What a group reads at the same instant: whole outputs, or single elements where it is one by values, with the input.
    fn each_read(&self, block: usize, group: usize, mut read: impl FnMut(&Source, Option<u32>, usize)) {
        let inputs = &self.flat.blocks[block].inputs;
        let known = &self.laws.blocks[block];
        if let Some(values) = known.values() {
            for (input, element) in values[group].reads.iter().filter_map(|cell| known.input(*cell)) {
                inputs[input].iter().for_each(|source| read(source, Some(element), input));
            }
            return;
        }
        let interface = &self.typed.interfaces[block];
        for (input, source) in inputs.iter().enumerate().filter(|(input, _)| interface.reads(group, *input)) {
            source.iter().for_each(|source| read(source, None, input));
        }
    }

    /// The groups that write cells of the inputs of a block.
    pub(super) fn writers_of(&self, block: usize, cells: &[u32]) -> Vec<Group> {
        let known = &self.laws.blocks[block];
        let read = cells.iter().filter_map(|cell| known.input(*cell));
        let inputs = &self.flat.blocks[block].inputs;
        read.filter_map(|(input, element)| Some(self.writer(inputs[input].as_ref()?, element))).collect()
    }

    /// The group that writes an element of an output.
    fn writer(&self, source: &Source, element: u32) -> Group {
        let (start, _) = self.laws.blocks[source.block].outputs[source.output];
        (source.block, self.group_of((source.block, start + element)))
    }

    /// The groups that write an output.
    pub(super) fn writers(&self, block: usize, output: usize) -> impl Iterator<Item = Group> + use<> {
        let known = &self.laws.blocks[block];
        let (one, mut several) = match (&known.law, known.values()) {
            (Some(law), Some(_)) => {
                let (start, end) = known.outputs[output];
                (None, law.group_of[start as usize..end as usize].to_vec())
            }
            _ => (Some(self.typed.interfaces[block].group_of[output]), Vec::new()),
        };
        several.sort_unstable();
        several.dedup();
        one.into_iter().chain(several).map(move |group| (block, group))
    }

    /// The group that writes a cell of the outputs of a block.
    pub(super) fn group_of(&self, (block, cell): Cell) -> usize {
        let known = &self.laws.blocks[block];
        match (&known.law, known.values()) {
            (Some(law), Some(_)) => law.group_of[cell as usize],
            _ => self.typed.interfaces[block].group_of[self.output_of((block, cell))],
        }
    }

    /// The output that a cell of the outputs of a block belongs to.
    pub(super) fn output_of(&self, (block, cell): Cell) -> usize {
        self.laws.blocks[block].outputs.partition_point(|(_, end)| *end <= cell)
    }

    /// Blocks that seem to need their own outputs at the same instant.
    pub(super) fn in_loops(&self) -> Vec<usize> {
        let is_closed =
            |nodes: &&Vec<NodeIndex>| nodes.len() > 1 || self.graph.contains_edge(nodes[0], nodes[0]);
        let bound = self.components.iter().filter(is_closed).flatten();
        let mut blocks: Vec<usize> = bound.map(|node| self.graph[*node].0).collect();
        blocks.sort_unstable();
        blocks.dedup();
        blocks
    }

    /// Groups in an order in which every one follows those that it reads; ties go by path, then group, so that the order of
    /// the file does not matter. Those of an algebraic loop stand together.
    pub(super) fn topological(&self) -> Sorted {
        let components = &self.components;
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
        let mut sorted = Sorted::default();
        while let Some(Reverse((group, part))) = ready.pop() {
            let nodes = &components[part];
            if nodes.len() == 1 && !self.graph.contains_edge(nodes[0], nodes[0]) {
                sorted.groups.push(group);
            } else {
                let ring = self.ring(nodes);
                sorted.groups.extend(&ring.groups);
                sorted.rings.push(ring);
            }
            for after in leaving(part) {
                waiting[after] -= 1;
                if waiting[after] == 0 {
                    ready.extend(rank(after).map(Reverse));
                }
            }
        }
        sorted
    }
}
