//! Algebraic loops: cut open so that they can be solved, or told hop by hop.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap, HashSet, VecDeque};

use blocksim_block::problem::{Problem, Severity};
use blocksim_block::schedule::When;
use blocksim_signal::Kind;
use petgraph::Direction;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::order::{Group, Order, Sorted};

/// What helps wherever a loop is not meant, or cannot be solved.
const BREAK: &str = "put a block without direct feedthrough into the loop: a LowPass, an Integrator or, for sampled signals, a UnitDelay";

/// An algebraic loop.
pub(super) struct Ring {
    /// Its groups, in an order in which each follows those that it reads, but for those that are cut.
    pub groups: Vec<Group>,
    /// Outputs, by block and number, that are guessed, and corrected until they are what their blocks give.
    pub cut: Vec<(usize, usize)>,
    /// Blocks with constraints, whose unknowns are found together with what is cut.
    pub constraints: Vec<usize>,
    /// A shortest way round.
    cycle: Vec<Group>,
    /// The same of what is a loop even without the constraints.
    slip: Option<Vec<Group>>,
}

impl Order<'_> {
    /// Cuts a loop open, at outputs of few numbers through which many ways go.
    pub(super) fn ring(&self, component: &[NodeIndex]) -> Result<Ring, Problem> {
        let mut component = component.to_vec();
        component.sort_by_key(|node| self.graph[*node]);
        let cycle = self.cycle(&component);
        let inside: HashSet<Group> = component.iter().map(|node| self.graph[*node]).collect();
        let mut graph: DiGraph<Group, ()> = DiGraph::new();
        let node_of: HashMap<Group, NodeIndex> =
            component.iter().map(|node| (self.graph[*node], graph.add_node(self.graph[*node]))).collect();
        for node in &component {
            for after in self.graph.neighbors(*node).filter_map(|after| node_of.get(&self.graph[after])) {
                graph.update_edge(node_of[&self.graph[*node]], *after, ());
            }
        }
        let read = self.read_within(&inside);
        let constraints: Vec<usize> = component
            .iter()
            .map(|node| self.graph[*node])
            .filter(|group| self.is_rest(*group))
            .map(|(block, _)| block)
            .collect();
        graph.retain_edges(|graph, edge| {
            graph.edge_endpoints(edge).is_none_or(|(from, _)| !self.is_rest(graph[from]))
        });
        let mut slip = None;
        let mut cut = Vec::new();
        loop {
            let closed = kosaraju_scc(&graph).into_iter().find(|part| is_closed(&graph, part));
            let Some(part) = closed else { break };
            slip.get_or_insert_with(|| {
                let mut part: Vec<NodeIndex> = part.iter().map(|node| self.node_of[&graph[*node]]).collect();
                part.sort_by_key(|node| self.graph[*node]);
                self.cycle(&part)
            });
            let ways = |node: NodeIndex| {
                let count = |direction| graph.neighbors_directed(node, direction).count();
                count(Direction::Incoming) * count(Direction::Outgoing)
            };
            let best = part
                .iter()
                .filter_map(|node| {
                    Some((self.width(graph[*node], &read)?, Reverse(ways(*node)), graph[*node]))
                })
                .min();
            let Some((_, _, group)) = best else {
                return Err(self.describe(&cycle).note("only real numbers can be solved for").help(BREAK));
            };
            cut.extend(self.of_group(group, &read));
            graph.retain_edges(|graph, edge| {
                graph.edge_endpoints(edge).is_none_or(|(from, _)| graph[from] != group)
            });
        }
        Ok(Ring { groups: in_order(&graph), cut, constraints, cycle, slip })
    }

    /// Whether a group gives what is left over of a constraint.
    fn is_rest(&self, (block, group): Group) -> bool {
        self.typed.interfaces[block].constraint.as_ref().is_some_and(|constraint| constraint.rest == group)
    }

    /// Outputs, by block and number, that members of a loop read at the same instant.
    fn read_within(&self, inside: &HashSet<Group>) -> HashSet<(usize, usize)> {
        let mut read = HashSet::new();
        for &(block, group) in inside {
            let inputs = self.flat.blocks[block].inputs.iter().enumerate();
            let seen = inputs.filter(|(input, _)| self.typed.interfaces[block].reads(group, *input));
            let sources = seen.filter_map(|(_, source)| source.as_ref());
            read.extend(sources.map(|source| (source.block, source.output)).filter(|&(block, output)| {
                inside.contains(&(block, self.typed.interfaces[block].group_of[output]))
            }));
        }
        read
    }

    /// Those of the outputs that belong to a group.
    fn of_group(&self, (block, group): Group, read: &HashSet<(usize, usize)>) -> Vec<(usize, usize)> {
        let outputs = self.typed.interfaces[block].group_of.iter().enumerate();
        let own = outputs.filter(|(_, of)| **of == group).map(|(output, _)| (block, output));
        own.filter(|output| read.contains(output)).collect()
    }

    /// How many numbers of a group the others read, if all of them are real.
    fn width(&self, group: Group, read: &HashSet<(usize, usize)>) -> Option<usize> {
        let ports = self.of_group(group, read).into_iter();
        ports
            .map(|(block, output)| {
                let port = &self.typed.interfaces[block].outputs[output].port_type;
                (port.kind == Kind::Real).then(|| port.shape.len())
            })
            .sum()
    }

    /// Warns of the loops that are solved, and refuses those whose members are not evaluated at the same times.
    pub(super) fn judge(&self, sorted: &Sorted, when: &HashMap<Group, When>) -> Vec<Problem> {
        let judged = sorted.rings.iter().filter_map(|ring| {
            let mut times = ring.groups.iter().map(|group| when.get(group));
            let first = times.next();
            if times.any(|other| Some(other) != first) {
                let reason = "its blocks are evaluated at different times: some at samples, others always or at other samples";
                return Some(self.describe(&ring.cycle).note(reason).help(BREAK));
            }
            // Who draws a constraint means the loop through it.
            let told = self.describe(ring.slip.as_ref()?);
            let message = format!("{}; solved at every instant", told.message);
            let help = format!("nothing is to be done if the loop is meant; else {BREAK}");
            Some(Problem { severity: Severity::Warning, message, ..told }.help(help))
        });
        judged.chain(self.idle(sorted)).collect()
    }

    /// Constraints on which their unknowns have no influence.
    fn idle(&self, sorted: &Sorted) -> impl Iterator<Item = Problem> {
        let bound = |block: usize| sorted.rings.iter().any(|ring| ring.constraints.contains(&block));
        let blocks = self.flat.blocks.iter().zip(&self.typed.interfaces).enumerate();
        blocks.filter(move |(block, (_, interface))| interface.constraint.is_some() && !bound(*block)).map(
            |(_, (block, interface))| {
                let (input, output) = (&interface.inputs[0].name, &interface.outputs[0].name);
                let message = format!(
                    "`{path}.{input}` does not depend on `{path}.{output}` at the same instant, so no value of it could make `{input}` zero",
                    path = block.path
                );
                let problem = Problem::error("algebraic_loop", message).help(format!(
                    "lead `{output}` to `{input}` through blocks that pass it on at once; behind an Integrator, a LowPass or a delay it comes \
                     too late"
                ));
                match block.inputs.first() {
                    Some(Some(source)) => problem.at(&source.target, ""),
                    _ => problem,
                }
            },
        )
    }

    /// A shortest cycle through the first group of a component.
    fn cycle(&self, component: &[NodeIndex]) -> Vec<Group> {
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

    fn describe(&self, cycle: &[Group]) -> Problem {
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
        problem
    }
}

/// Whether there is a way round among the nodes of a component.
fn is_closed(graph: &DiGraph<Group, ()>, part: &[NodeIndex]) -> bool {
    part.len() > 1 || graph.contains_edge(part[0], part[0])
}

/// Groups of a graph without loops, each behind those that it reads; ties go by block and group.
fn in_order(graph: &DiGraph<Group, ()>) -> Vec<Group> {
    let mut waiting: Vec<usize> = graph
        .node_indices()
        .map(|node| graph.neighbors_directed(node, Direction::Incoming).count())
        .collect();
    let first = graph.node_indices().filter(|node| waiting[node.index()] == 0);
    let mut ready: BinaryHeap<_> = first.map(|node| Reverse((graph[node], node))).collect();
    let mut sorted = Vec::with_capacity(graph.node_count());
    while let Some(Reverse((group, node))) = ready.pop() {
        sorted.push(group);
        for after in graph.neighbors(node) {
            waiting[after.index()] -= 1;
            if waiting[after.index()] == 0 {
                ready.push(Reverse((graph[after], after)));
            }
        }
    }
    sorted
}
