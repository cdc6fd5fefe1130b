//! The order of evaluation, and where every value lies.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use blocksim_block::Interface;
use blocksim_block::problem::Problem;
use blocksim_block::schedule::{Clock, Instance, Rate, Recorded, Schedule, Settings, Signal, Step, When};
use blocksim_signal::SampleTime;
use petgraph::Direction;
use petgraph::algo::tarjan_scc;
use petgraph::graph::{DiGraph, NodeIndex};

use crate::flatten::{Flat, FlatBlock};
use crate::infer::Typed;
use crate::problems::Problems;

/// Output groups and what they wait for.
struct Order<'a> {
    flat: &'a Flat,
    typed: &'a Typed,
    graph: DiGraph<(usize, usize), ()>,
    node_of: HashMap<(usize, usize), NodeIndex>,
}

/// Sorts the output groups and lays out all values.
pub(crate) fn sort(
    title: String,
    flat: &Flat,
    typed: &Typed,
    settings: Settings,
    problems: &mut Problems,
) -> Option<Schedule> {
    let order = Order::new(flat, typed);
    let sorted = match order.topological() {
        Ok(sorted) => sorted,
        Err(loops) => {
            loops.into_iter().for_each(|problem| problems.push(problem));
            return None;
        }
    };
    let clock = clock(flat, typed, problems);
    if problems.any_error() {
        return None;
    }
    Some(lay_out(title, flat, typed, settings, &sorted, clock))
}

impl<'a> Order<'a> {
    fn new(flat: &'a Flat, typed: &'a Typed) -> Self {
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
    fn reads(&self, block: usize, group: usize) -> Vec<((usize, usize), usize)> {
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
    fn topological(&self) -> Result<Vec<(usize, usize)>, Vec<Problem>> {
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

    /// Every algebraic loop with all its hops.
    fn loops(&self) -> Vec<Problem> {
        tarjan_scc(&self.graph)
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
        let mut come_from: HashMap<NodeIndex, NodeIndex> = HashMap::new();
        let mut queue = std::collections::VecDeque::from([start]);
        while let Some(node) = queue.pop_front() {
            let mut next: Vec<NodeIndex> =
                self.graph.neighbors(node).filter(|n| component.contains(n)).collect();
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

/// When each group must be evaluated, in the order of evaluation.
fn when(
    flat: &Flat,
    typed: &Typed,
    sorted: &[(usize, usize)],
    rates: &HashMap<usize, usize>,
) -> HashMap<(usize, usize), When> {
    let mut when: HashMap<(usize, usize), When> = HashMap::new();
    for (block, group) in sorted {
        let interface = &typed.interfaces[*block];
        let found = if let Some(rate) = rates.get(block) {
            When::Sampled(*rate as u32)
        } else if interface.sample_time == Some(SampleTime::Constant) {
            When::Constant
        } else if !interface.states.is_empty() || interface.uses_time {
            When::Continuous
        } else {
            let mut latest =
                if interface.settles || interface.time_events || interface.accepts || interface.jumps {
                    When::Major
                } else {
                    When::Constant
                };
            for (input, source) in flat.blocks[*block].inputs.iter().enumerate() {
                let Some(source) = source else { continue };
                if !interface.reads(*group, input) {
                    continue;
                }
                let from = (source.block, typed.interfaces[source.block].group_of[source.output]);
                latest = match (latest, when.get(&from)) {
                    (When::Continuous, _) | (_, Some(When::Continuous)) => When::Continuous,
                    (latest, Some(When::Constant)) => latest,
                    _ => When::Major,
                };
            }
            latest
        };
        when.insert((*block, *group), found);
    }
    when
}

/// Groups that derivatives, guards or memories depend on.
fn needed_in_minor_steps(order: &Order) -> Vec<(usize, usize)> {
    let mut needed: Vec<(usize, usize)> = Vec::new();
    let mut stack: Vec<(usize, usize)> = Vec::new();
    for (block, interface) in order.typed.interfaces.iter().enumerate() {
        if interface.states.is_empty() && interface.guards.is_empty() && !interface.accepts {
            continue;
        }
        for source in order.flat.blocks[block].inputs.iter().flatten() {
            stack.push((source.block, order.typed.interfaces[source.block].group_of[source.output]));
        }
    }
    while let Some(next) = stack.pop() {
        if !needed.contains(&next) {
            needed.push(next);
            stack.extend(order.reads(next.0, next.1).into_iter().map(|(from, _)| from));
        }
    }
    needed
}

/// Puts all sample times on one integer clock.
fn clock(flat: &Flat, typed: &Typed, problems: &mut Problems) -> Clock {
    let mut times: Vec<(f64, f64, usize)> = Vec::new();
    for (index, interface) in typed.interfaces.iter().enumerate() {
        if let Some(SampleTime::Discrete { period, offset }) = interface.sample_time {
            times.push((period, offset, index));
        }
    }
    let mut tick = 0.0;
    for (period, offset, index) in &times {
        let ok = period.is_finite() && *period > 0.0 && offset.is_finite() && *offset >= 0.0;
        if !ok {
            problems.push(located(
                &flat.blocks[*index],
                Problem::error("sample_time", format!("a sample time of {period} s cannot be kept"))
                    .help("sample times are positive"),
            ));
            return Clock::default();
        }
        tick = common(common(tick, *period), *offset);
    }
    if times.is_empty() {
        return Clock::default();
    }
    if times.iter().any(|(period, offset, _)| period / tick > 1e9 || offset / tick > 1e12) {
        problems.push(located(
            &flat.blocks[times[0].2],
            Problem::error("sample_time", "the sample times have no common clock")
                .help("choose sample times that are multiples of a common time, such as 1 ms and 5 ms"),
        ));
        return Clock::default();
    }
    let mut rates: Vec<Rate> = times
        .iter()
        .map(|(period, offset, _)| Rate {
            period: (period / tick).round() as u64,
            offset: (offset / tick).round() as u64,
        })
        .collect();
    rates.sort_by_key(|rate| (rate.period, rate.offset));
    rates.dedup();
    Clock { tick, rates }
}

/// Greatest common divisor of two times, up to rounding.
fn common(a: f64, b: f64) -> f64 {
    let (mut a, mut b) = (a.max(b), a.min(b));
    let zero = a * 1e-10;
    while b > zero {
        let rest = a - (a / b).round() * b;
        (a, b) = (b, rest.abs());
    }
    a
}

fn located(block: &FlatBlock, problem: Problem) -> Problem {
    match &block.place {
        Some(place) => problem.at(place, format!("in `{}`", block.path)),
        None => problem,
    }
}

fn rate_of(interface: &Interface, clock: &Clock) -> Option<usize> {
    let SampleTime::Discrete { period, offset } = interface.sample_time? else { return None };
    let rate =
        Rate { period: (period / clock.tick).round() as u64, offset: (offset / clock.tick).round() as u64 };
    clock.rates.iter().position(|known| *known == rate)
}

fn lay_out(
    title: String,
    flat: &Flat,
    typed: &Typed,
    settings: Settings,
    sorted: &[(usize, usize)],
    clock: Clock,
) -> Schedule {
    let order = Order::new(flat, typed);
    let rates: HashMap<usize, usize> = typed
        .interfaces
        .iter()
        .enumerate()
        .filter_map(|(block, interface)| rate_of(interface, &clock).map(|rate| (block, rate)))
        .collect();
    let when = when(flat, typed, sorted, &rates);
    let needed = needed_in_minor_steps(&order);

    let mut signals = Vec::new();
    let mut first_signal = Vec::new();
    let mut cells = 0;
    for (block, interface) in flat.blocks.iter().zip(&typed.interfaces) {
        first_signal.push((signals.len(), cells));
        for (output, path) in interface.outputs.iter().zip(&block.output_names) {
            let port_type = output.port_type;
            signals.push(Signal {
                path: path.clone(),
                offset: cells,
                kind: port_type.kind,
                shape: port_type.shape,
                dimension: port_type.dimension,
            });
            cells += port_type.shape.len();
        }
    }
    let mut initial_signals = vec![0.0; cells];

    let mut blocks: Vec<Instance> = Vec::new();
    let (mut x, mut d, mut g) = (0, 0, 0);
    let mut recorded = Vec::new();
    for (index, (block, interface)) in flat.blocks.iter().zip(&typed.interfaces).enumerate() {
        let mut gather = Vec::new();
        let mut inputs = Vec::new();
        let mut at = 0;
        for (input, source) in interface.inputs.iter().zip(&block.inputs) {
            let (cell, length) = match source {
                Some(source) => {
                    let signal = &signals[first_signal[source.block].0 + source.output];
                    (signal.offset, signal.shape.len())
                }
                None => {
                    let length = input.shape.unwrap_or_default().len();
                    let cell = initial_signals.len();
                    initial_signals.extend(std::iter::repeat_n(input.default.unwrap_or(0.0), length));
                    (cell, length)
                }
            };
            gather.push((cell as u32, length as u32));
            inputs.push((at, at + length as u32));
            at += length as u32;
            if let (Some(wanted), Some(source)) = (&interface.recorded, source) {
                let signal = &signals[first_signal[source.block].0 + source.output];
                let name = format!("{}.{}", block.path, input.name);
                push_recorded(&mut recorded, &name, signal, wanted.display.as_deref());
            }
        }
        let (first, y) = first_signal[index];
        let outputs = signals[first..first + interface.outputs.len()]
            .iter()
            .map(|signal| ((signal.offset - y) as u32, (signal.offset - y + signal.shape.len()) as u32))
            .collect();
        blocks.push(Instance {
            path: block.path.clone(),
            kind: block.kind.clone(),
            place: block.place.clone(),
            block: block.block.clone(),
            interface: interface.clone(),
            gather,
            inputs,
            outputs,
            y,
            x,
            d,
            g,
            rate: rates.get(&index).copied(),
        });
        x += interface.states.len();
        d += interface.discrete.len();
        g += interface.guards.len();
    }
    for (name, source) in &flat.recorded {
        let signal = &signals[first_signal[source.block].0 + source.output];
        push_recorded(&mut recorded, name, signal, None);
    }
    let steps = sorted
        .iter()
        .map(|(block, group)| Step {
            block: *block as u32,
            group: *group as u32,
            when: when[&(*block, *group)],
            minor: needed.contains(&(*block, *group)),
        })
        .collect();
    Schedule {
        title,
        blocks,
        steps,
        signals,
        initial_signals,
        states: x,
        discrete: d,
        guards: g,
        clock,
        recorded,
        settings,
    }
}

fn push_recorded(recorded: &mut Vec<Recorded>, name: &str, signal: &Signal, display: Option<&str>) {
    let length = signal.shape.len();
    for element in 0..length {
        let path = if length == 1 { name.to_owned() } else { format!("{name}[{element}]") };
        if recorded.iter().any(|known| known.path == path) {
            continue;
        }
        recorded.push(Recorded {
            path,
            cell: signal.offset + element,
            kind: signal.kind,
            dimension: signal.dimension,
            display: display.map(str::to_owned),
        });
    }
}

/// The longest time that a block has something to show, for `stop_time: Auto`.
pub(crate) fn end_time(flat: &Flat) -> Option<f64> {
    flat.blocks.iter().filter_map(|block| block.block.end_time()).max_by(f64::total_cmp)
}
