//! Algebraic loops, told hop by hop.

use std::collections::{HashMap, HashSet, VecDeque};

use blocksim_block::problem::Problem;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::NodeIndex;

use super::order::Order;

impl Order<'_> {
    /// Every algebraic loop with all its hops.
    pub(super) fn loops(&self) -> Vec<Problem> {
        kosaraju_scc(&self.graph)
            .into_iter()
            .filter(|component| component.len() > 1 || self.graph.contains_edge(component[0], component[0]))
            .map(|mut component| {
                component.sort_by_key(|node| self.graph[*node]);
                self.describe(&self.cycle(&component))
            })
            .collect()
    }

    /// A shortest cycle through the first group of a component.
    fn cycle(&self, component: &[NodeIndex]) -> Vec<(usize, usize)> {
        let start = component[0];
        let inside: HashSet<&NodeIndex> = component.iter().collect();
        let mut come_from: HashMap<NodeIndex, NodeIndex> = HashMap::new();
        let mut queue = VecDeque::from([start]);
        while let Some(node) = queue.pop_front() {
            let mut next: Vec<NodeIndex> =
                self.graph.neighbors(node).filter(|n| inside.contains(n)).collect();
            next.sort_by_key(|n| self.graph[*n]);
            for after in next {
                if after == start {
                    let mut path = vec![node];
                    while let Some(before) = path.last().and_then(|last| come_from.get(last)) {
                        path.push(*before);
                    }
                    path.reverse();
                    return path.into_iter().map(|node| self.graph[node]).collect();
                }
                if after != start && !come_from.contains_key(&after) {
                    come_from.insert(after, node);
                    queue.push_back(after);
                }
            }
        }
        component.iter().map(|node| self.graph[*node]).collect()
    }

    fn describe(&self, cycle: &[(usize, usize)]) -> Problem {
        let name = |block: usize| self.flat.blocks[block].path.clone();
        let mut hops: Vec<String> = cycle.iter().map(|(block, _)| name(*block)).collect();
        hops.push(name(cycle[0].0));
        let mut problem = Problem::error("algebraic_loop", format!("algebraic loop: {}", hops.join(" -> ")));
        for (index, (block, group)) in cycle.iter().enumerate() {
            let before = cycle[(index + cycle.len() - 1) % cycle.len()];
            let found = &self.flat.blocks[*block];
            let hop = self.reads(*block, *group).into_iter().find(|(from, _)| *from == before);
            if let Some((_, input)) = hop
                && let Some(source) = &found.inputs[input]
            {
                let from = &self.flat.blocks[source.block].output_names[source.output];
                let input = &self.typed.interfaces[*block].inputs[input].name;
                let to =
                    if found.kind == "Network" { input.clone() } else { format!("{}.{input}", found.path) };
                problem = problem.note(format!("`{from}` is connected to `{to}`")).note(format!(
                    "`{to}` feeds through to the outputs of `{}` ({})",
                    found.path, found.kind
                ));
                if problem.labels.len() < 6 {
                    problem = problem.at(&source.target, "");
                }
            }
        }
        problem.help(
            "put a block without direct feedthrough into the loop: a LowPass, an Integrator or, for sampled signals, a UnitDelay",
        )
    }
}
