//! Where every value lies: signals, inputs, states, memories, guards and what is recorded.

use blocksim_block::Interface;
use blocksim_block::schedule::{
    Clock, Instance, Keep, Loop, Recorded, Schedule, Settings, Signal, Step, When,
};
use blocksim_signal::Kind;
use foldhash::{HashMap, HashSet};

use super::order::{Group, Order, Sorted};
use super::when::{acting, watched};
use crate::flatten::Source;

/// The schedule, but for names, places and interfaces, see [`hand_over`](super::hand_over).
pub(super) fn lay_out(
    title: String,
    order: &Order,
    settings: Settings,
    sorted: &Sorted,
    clock: Clock,
    rates: &HashMap<usize, usize>,
    when: &[When],
) -> Schedule {
    let (flat, typed) = (order.flat, order.typed);
    let watched = watched(order, when, rates);
    let acting = acting(order, when, &watched);

    let mut signals = Vec::with_capacity(flat.blocks.len());
    let mut first_signal = Vec::with_capacity(flat.blocks.len());
    let mut cells = 0;
    for (block, interface) in flat.blocks.iter().zip(&typed.interfaces) {
        first_signal.push((signals.len(), cells));
        for (output, _) in interface.outputs.iter().zip(&block.output_names) {
            let port_type = output.port_type;
            signals.push(Signal {
                path: String::new(),
                offset: cells,
                kind: port_type.kind,
                shape: port_type.shape,
                dimension: port_type.dimension,
            });
            cells += port_type.shape.len();
        }
    }
    let mut initial_signals = vec![0.0; cells];

    let mut blocks: Vec<Instance> = Vec::with_capacity(flat.blocks.len());
    let (mut x, mut d, mut g) = (0, 0, 0);
    let mut recorded = Columns::default();
    let held = |source: &Source| {
        let signal = &signals[first_signal[source.block].0 + source.output];
        let mut groups = order.writers(source.block, source.output);
        // Nothing is between true and false.
        signal.kind == Kind::Bool || groups.all(|group| when[order.number(group)] != When::Continuous)
    };
    for (index, (block, interface)) in flat.blocks.iter().zip(&typed.interfaces).enumerate() {
        let mut gather = Vec::new();
        let across = interface.recorded.as_ref().and_then(|recorded| recorded.over).and_then(|input| {
            let source = block.inputs.get(input)?.as_ref()?;
            let wide = signals[first_signal[source.block].0 + source.output].shape.len() > 1;
            Some((input, format!("{}.{}", block.path, interface.inputs[input].name), wide))
        });
        let over = across.as_ref().map(|(input, name, wide)| (*input, name.as_str(), *wide));
        for (number, (input, source)) in interface.inputs.iter().zip(&block.inputs).enumerate() {
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
            if let (Some(wanted), Some(source)) = (&interface.recorded, source) {
                let signal = &signals[first_signal[source.block].0 + source.output];
                let name = format!("{}.{}", block.path, input.name);
                let called = Called {
                    held: held(source),
                    display: wanted
                        .displays
                        .get(number)
                        .unwrap_or(&None)
                        .as_deref()
                        .or(wanted.display.as_deref()),
                    title: &block.title,
                    legend: wanted.legend.get(number).map(String::as_str),
                    over: over.filter(|(across, ..)| *across != number).map(|(_, name, wide)| (name, wide)),
                };
                recorded.push(&name, signal, &called);
            }
        }
        let (_, y) = first_signal[index];
        let known = &order.laws.blocks[index];
        blocks.push(Instance {
            path: String::new(),
            kind: String::new(),
            place: None,
            parts: Vec::new(),
            block: known.block.clone(),
            law: known.law.clone(),
            interface: Interface::default(),
            gather,
            inputs: known.inputs.clone(),
            outputs: known.outputs.clone(),
            y,
            x,
            d,
            g,
            rate: rates.get(&index).copied(),
            watched: watched[index],
        });
        x += interface.states.len();
        d += interface.discrete.len();
        g += interface.guards.len();
    }
    for (name, source) in &flat.recorded {
        let signal = &signals[first_signal[source.block].0 + source.output];
        recorded.push(name, signal, &Called { held: held(source), ..Called::default() });
    }
    let steps = sorted
        .groups
        .iter()
        .map(|(block, group)| {
            let number = order.number((*block, *group));
            let (when, acts) = (when[number], acting[number]);
            let minor = acts && when == When::Continuous;
            Step { block: *block as u32, group: *group as u32, when, acts, minor }
        })
        .collect();
    let numbered = sorted.groups.iter().enumerate().filter(|_| !sorted.rings.is_empty());
    let number_of: HashMap<Group, usize> = numbered.map(|(number, group)| (*group, number)).collect();
    let loops = sorted.rings.iter().map(|ring| {
        let cell = |(block, cell): &(usize, u32)| first_signal[*block].1 + *cell as usize;
        let mut cells: Vec<usize> = ring.cut.iter().map(cell).collect();
        let guessed = cells.len();
        for &block in &ring.constraints {
            let unknowns = typed.interfaces[block].constraint.iter().flat_map(|found| &found.unknowns);
            for &(place, guess) in unknowns {
                let cell = first_signal[block].1 + place;
                initial_signals[cell] = guess;
                cells.push(cell);
            }
        }
        let sought = cells.len() - guessed;
        let chosen = ring.chosen.iter().map(cell).collect();
        let first = ring.groups.first().map_or(0, |group| number_of[group]);
        Loop { first, count: ring.groups.len(), cells, chosen, sought }
    });
    let loops: Vec<Loop> = loops.collect();
    Schedule {
        title,
        blocks,
        steps,
        loops,
        signals,
        initial_signals,
        states: x,
        discrete: d,
        guards: g,
        clock,
        recorded: recorded.columns,
        settings,
    }
}

/// How a recorded signal is shown.
#[derive(Default)]
struct Called<'a> {
    held: bool,
    display: Option<&'a str>,
    title: &'a [String],
    legend: Option<&'a str>,
    /// Name of the input over which it is drawn, and whether that has elements.
    over: Option<(&'a str, bool)>,
}

/// What is recorded, each name once.
#[derive(Default)]
struct Columns {
    columns: Vec<Recorded>,
    names: HashSet<String>,
}

impl Columns {
    fn push(&mut self, name: &str, signal: &Signal, called: &Called) {
        let length = signal.shape.len();
        for element in 0..length {
            let numbered =
                |name: &str| if length == 1 { name.to_owned() } else { format!("{name}[{element}]") };
            let path = numbered(name);
            if !self.names.insert(path.clone()) {
                continue;
            }
            self.columns.push(Recorded {
                path,
                cell: signal.offset + element,
                kind: signal.kind,
                dimension: signal.dimension,
                display: called.display.map(str::to_owned),
                title: called.title.to_vec(),
                legend: called.legend.map(numbered),
                over: called.over.map(|(name, wide)| if wide { numbered(name) } else { name.to_owned() }),
                keep: Keep::All,
                held: called.held,
            });
        }
    }
}
