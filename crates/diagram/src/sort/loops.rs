//! Algebraic loops: cut open so that they can be solved, or told hop by hop.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap, VecDeque};

use blocksim_block::problem::{Problem, Severity};
use blocksim_block::schedule::{LoopPolicy, When};
use blocksim_signal::Kind;
use foldhash::{HashMap, HashMapExt, HashSet};
use petgraph::Direction;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use super::order::{Cell, Group, Order, Sorted};

/// What helps wherever a loop is not meant, or cannot be solved.
const BREAK: &str = "put a block without direct feedthrough into the loop: a LowPass, an Integrator or, for sampled signals, a UnitDelay";

/// Most values of a loop that are found at once.
const MOST_UNKNOWNS: usize = 2000;

/// An algebraic loop.
pub(super) struct Ring {
    /// Its groups, in an order in which each follows those that it reads, but for those that are cut.
    pub groups: Vec<Group>,
    /// Cells of outputs that are guessed, and corrected until they are what their blocks give.
    pub cut: Vec<Cell>,
    /// The same of truth values and whole numbers, which are held and chosen anew.
    pub chosen: Vec<Cell>,
    /// Blocks with constraints, whose unknowns are found together with what is cut.
    pub constraints: Vec<usize>,
    /// A shortest way round.
    cycle: Vec<Group>,
    /// The same of what is a loop even without the constraints.
    slip: Option<Vec<Group>>,
}

impl Order<'_> {
    /// Cuts a loop open, at outputs of few numbers through which many ways go.
    pub(super) fn ring(&self, component: &[NodeIndex]) -> Ring {
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
        let (mut cut, mut chosen) = (Vec::new(), Vec::new());
        loop {
            let closed = kosaraju_scc(&graph).into_iter().find(|part| is_closed(&graph, part));
            let Some(part) = closed else { break };
            slip.get_or_insert_with(|| {
                let mut part: Vec<NodeIndex> = part.iter().map(|node| self.node(graph[*node])).collect();
                part.sort_by_key(|node| self.graph[*node]);
                self.cycle(&part)
            });
            let ways = |node: NodeIndex| {
                let count = |direction| graph.neighbors_directed(node, direction).count();
                count(Direction::Incoming) * count(Direction::Outgoing)
            };
            // Numbers that can be solved for rather than those that can only be tried.
            let cost = |node: &NodeIndex| {
                let cells = read.get(&graph[*node]);
                let tried =
                    cells.map_or(0, |cells| cells.iter().filter(|cell| !self.is_real(**cell)).count());
                (tried, cells.map_or(0, BTreeSet::len), Reverse(ways(*node)), graph[*node])
            };
            // Groups that only choose modes write nothing that could be cut.
            let writes = |node: &&NodeIndex| read.contains_key(&graph[**node]);
            let Some((_, _, _, group)) = part.iter().filter(writes).map(cost).min() else { break };
            for cell in read.get(&group).into_iter().flatten() {
                if self.is_real(*cell) { cut.push(*cell) } else { chosen.push(*cell) }
            }
            graph.retain_edges(|graph, edge| {
                graph.edge_endpoints(edge).is_none_or(|(from, _)| graph[from] != group)
            });
        }
        Ring { groups: self.rests_last(in_order(&graph)), cut, chosen, constraints, cycle, slip }
    }

    /// The same groups with those behind all others that write what is left over of constraints: it stands in the places of the
    /// unknowns, which nobody may read any more. One of them that reads the unknown of another comes before it.
    fn rests_last(&self, groups: Vec<Group>) -> Vec<Group> {
        let (rests, mut groups): (Vec<Group>, Vec<Group>) =
            groups.into_iter().partition(|group| self.is_rest(*group));
        let mut graph: DiGraph<Group, ()> = DiGraph::new();
        let nodes: Vec<NodeIndex> = rests.iter().map(|rest| graph.add_node(*rest)).collect();
        for (reader, (block, group)) in nodes.iter().zip(&rests) {
            let read: HashSet<usize> = self.reads_cells(*block, *group).iter().map(|cell| cell.0).collect();
            let written =
                nodes.iter().zip(&rests).filter(|(_, (other, _))| other != block && read.contains(other));
            written.for_each(|(writer, _)| {
                graph.update_edge(*reader, *writer, ());
            });
        }
        let ordered = in_order(&graph);
        groups.extend(&ordered);
        // Each of two that read each other's unknown at once would see what is left over: such unknowns determine nothing.
        groups.extend(rests.iter().filter(|rest| !ordered.contains(rest)));
        groups
    }

    /// Whether a group gives what is left over of a constraint.
    fn is_rest(&self, (block, group): Group) -> bool {
        self.typed.interfaces[block].constraint.as_ref().is_some_and(|constraint| constraint.rest == group)
    }

    /// Cells of outputs that members of a loop read at the same instant, by the group that writes them.
    fn read_within(&self, inside: &HashSet<Group>) -> HashMap<Group, BTreeSet<Cell>> {
        let mut read: HashMap<Group, BTreeSet<Cell>> = HashMap::new();
        for &(block, group) in inside {
            for cell in self.reads_cells(block, group) {
                let from = (cell.0, self.group_of(cell));
                if inside.contains(&from) {
                    read.entry(from).or_default().insert(cell);
                }
            }
        }
        read
    }

    fn is_real(&self, cell: Cell) -> bool {
        self.typed.interfaces[cell.0].outputs[self.output_of(cell)].port_type.kind == Kind::Real
    }

    /// Tells of the loops that are solved, unless they are to be refused, and refuses those whose members are not evaluated at the same
    /// times and those that are too large.
    pub(super) fn judge(&self, sorted: &Sorted, when: &[When], policy: LoopPolicy) -> Vec<Problem> {
        // Elements of a vector that go the same way make a loop each, and one problem.
        let mut alike: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
        let way = |ring: &Ring| ring.cycle.iter().map(|(block, _)| *block).collect::<Vec<usize>>();
        sorted.rings.iter().for_each(|ring| *alike.entry(way(ring)).or_default() += 1);
        let judged = sorted.rings.iter().enumerate().filter_map(|(number, ring)| {
            let count = alike.remove(&way(ring))?;
            let mut times = ring.groups.iter().map(|group| when[self.number(*group)]);
            let first = times.next();
            if times.any(|other| Some(other) != first) {
                let reason = "its blocks are evaluated at different times: some at samples, others always or at other samples";
                return Some(self.describe(&ring.cycle).note(reason).help(BREAK));
            }
            let unknowns = ring.cut.len() + ring.chosen.len();
            if unknowns > MOST_UNKNOWNS {
                let reason = format!("{unknowns} values would have to be found at once, more than {MOST_UNKNOWNS}");
                return Some(self.describe(&ring.cycle).note(reason).help(BREAK));
            }
            // Who draws a constraint means the loop through it.
            let told = self.describe(ring.slip.as_ref()?);
            let told = if count > 1 { told.note(format!("there are {count} such loops, of single elements")) } else { told };
            Some(match policy {
                LoopPolicy::Refuse => told
                    .note("`algebraic_loops: Refuse` under `simulation` refuses such loops")
                    .help(format!("{BREAK}; or have the loop solved, by `algebraic_loops: Solve`")),
                LoopPolicy::Solve => {
                    let message = format!("{}; solved at every instant", told.message);
                    let help = format!(
                        "nothing is to be done if the loop is meant; else {BREAK}; `blocksim graph --loop {}` draws it",
                        number + 1
                    );
                    Problem { severity: Severity::Note, message, ..told }.help(help)
                }
            })
        });
        let judged: Vec<Problem> = judged.collect();
        judged.into_iter().chain(self.idle(sorted)).collect()
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
        let writes = |node: &&NodeIndex| {
            let (block, group) = self.graph[**node];
            self.laws.blocks[block].values().is_some()
                || self.typed.interfaces[block].group_of.contains(&group)
        };
        let start = component.iter().find(writes).copied().unwrap_or(component[0]);
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
