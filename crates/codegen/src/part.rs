//! Which blocks are translated, what goes in and out, and when each output group is evaluated.

use std::collections::{BTreeMap, BTreeSet};

use blocksim_block::schedule::{Clock, Instance, Rate, Schedule, Step, When};
use blocksim_signal::{Dimension, Kind, Shape};

use crate::Target;

/// Steps to a hit that no run reaches.
const NEVER: u64 = 1 << 60;

/// A part of a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Path of the subsystem; empty for the whole diagram.
    pub path: String,
    /// What goes in, by the outputs outside that drive it.
    pub inputs: Vec<Port>,
    /// What comes out.
    pub outputs: Vec<Port>,
}

/// An input or output of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct Port {
    /// Its name.
    pub name: String,
    /// Path of the signal in the diagram: `arm/base/joint.q`.
    pub signal: String,
    /// First cell among the signals.
    pub cell: usize,
    /// Scalar, vector or matrix.
    pub shape: Shape,
    /// Real, Bool or Int.
    pub kind: Kind,
    /// Dimension, where something says it.
    pub dimension: Option<Dimension>,
}

impl Port {
    /// The port `name` through which an output of the diagram goes.
    pub fn of(name: impl Into<String>, signal: &blocksim_block::schedule::Signal) -> Self {
        Self {
            name: name.into(),
            signal: signal.path.clone(),
            cell: signal.offset,
            shape: signal.shape,
            kind: signal.kind,
            dimension: signal.dimension,
        }
    }

    pub(crate) fn cells(&self) -> std::ops::Range<usize> {
        self.cell..self.cell + self.shape.len()
    }
}

impl Part {
    /// The whole diagram: nothing goes in, what is recorded comes out.
    pub fn whole(schedule: &Schedule) -> Self {
        let outputs = schedule.recorded.iter().map(|recorded| Port {
            name: recorded.path.clone(),
            signal: recorded.path.clone(),
            cell: recorded.cell,
            shape: Shape::Scalar,
            kind: recorded.kind,
            dimension: recorded.dimension,
        });
        Self { path: String::new(), inputs: Vec::new(), outputs: outputs.collect() }
    }

    /// A subsystem with these inputs and outputs. `origins` gives the output that stands behind each name of a model,
    /// `control.set` or `control.bus.Angle`; a bus becomes a port for each of its elements. What nothing drives is no port.
    pub fn subsystem(
        schedule: &Schedule,
        path: &str,
        inputs: &[String],
        outputs: &[String],
        origins: &BTreeMap<String, String>,
    ) -> Self {
        let ports = |names: &[String]| -> Vec<Port> {
            let mut ports = Vec::new();
            for name in names {
                let whole = format!("{path}.{name}");
                let elements = format!("{whole}.");
                let leaves = origins.range(whole.clone()..).take_while(|(key, _)| key.starts_with(&whole));
                for (key, signal) in leaves.filter(|(key, _)| **key == whole || key.starts_with(&elements)) {
                    let found = schedule.signals.iter().find(|known| known.path == *signal);
                    ports.extend(found.map(|found| Port::of(&key[path.len() + 1..], found)));
                }
            }
            ports
        };
        Self { path: path.to_owned(), inputs: ports(inputs), outputs: ports(outputs) }
    }

    fn holds(&self, path: &str) -> bool {
        self.path.is_empty() || path.strip_prefix(&self.path).is_some_and(|rest| rest.starts_with('/'))
    }
}

/// A part within its diagram.
pub(crate) struct Selected<'s> {
    pub schedule: &'s Schedule,
    pub part: &'s Part,
    pub target: &'s Target,
    /// Its blocks, as numbers in the schedule, without those that only record.
    pub blocks: BTreeSet<usize>,
    /// Its output groups in the order of evaluation, as they are due on the target: what depends on inputs is no constant there.
    pub steps: Vec<Step>,
    /// Cells that come from outside: port and element.
    pub inputs: BTreeMap<usize, (usize, usize)>,
    /// Cells that are written when the part runs.
    pub written: BTreeSet<usize>,
    /// Cells outside of the part that it reads though no input leads there.
    pub strangers: Vec<(usize, usize)>,
}

impl<'s> Selected<'s> {
    pub fn new(schedule: &'s Schedule, part: &'s Part, target: &'s Target) -> Self {
        let holds = |block: &Instance| {
            part.holds(&block.path) || block.parts.iter().any(|inner| part.holds(&inner.path))
        };
        let blocks: BTreeSet<usize> = (0..schedule.blocks.len())
            .filter(|at| holds(&schedule.blocks[*at]) && schedule.blocks[*at].interface.recorded.is_none())
            .collect();
        let mut inside = BTreeSet::new();
        for block in blocks.iter().map(|at| &schedule.blocks[*at]) {
            let width = block.outputs.iter().map(|port| port.1 as usize).max().unwrap_or(0);
            inside.extend(block.y..block.y + width);
        }
        let mut inputs = BTreeMap::new();
        for (number, port) in part.inputs.iter().enumerate() {
            for (element, cell) in port.cells().enumerate().filter(|(_, cell)| !inside.contains(cell)) {
                inputs.entry(cell).or_insert((number, element));
            }
        }
        let mut selected = Self {
            schedule,
            part,
            target,
            blocks,
            steps: Vec::new(),
            inputs,
            written: BTreeSet::new(),
            strangers: Vec::new(),
        };
        selected.sort(&inside);
        selected
    }

    /// Finds when output groups are due.
    fn sort(&mut self, inside: &BTreeSet<usize>) {
        let schedule = self.schedule;
        let tail =
            schedule.signals.iter().map(|signal| signal.offset + signal.shape.len()).max().unwrap_or(0);
        // What changes while the part runs, because of its inputs.
        let mut live: BTreeSet<usize> = self.inputs.keys().copied().collect();
        for step in schedule.steps.iter().filter(|step| self.blocks.contains(&(step.block as usize))) {
            let mut step = *step;
            let block = &schedule.blocks[step.block as usize];
            let depends = read_cells(block, Some(step.group as usize)).any(|cell| live.contains(&cell));
            if step.when == When::Constant && depends {
                step.when = When::Major;
            }
            if step.when != When::Constant {
                let cells: Vec<usize> = written_cells(block, step.group as usize).collect();
                live.extend(&cells);
                self.written.extend(cells);
            }
            self.steps.push(step);
        }
        for at in &self.blocks {
            for cell in read_cells(&schedule.blocks[*at], None) {
                let known = inside.contains(&cell) || self.inputs.contains_key(&cell) || cell >= tail;
                if !known {
                    self.strangers.push((*at, cell));
                }
            }
        }
    }

    /// The block of a number.
    pub fn block(&self, at: usize) -> &'s Instance {
        &self.schedule.blocks[at]
    }

    /// Whether a block does nothing on the target, since all its outputs are constants.
    pub fn is_constant(&self, at: usize) -> bool {
        let block = self.block(at);
        let mut steps = self.steps.iter().filter(|step| step.block as usize == at).peekable();
        block.interface.states.is_empty()
            && block.rate.is_none()
            && steps.peek().is_some()
            && steps.all(|step| step.when == When::Constant)
    }

    /// Steps of the target in a period, and up to the first hit, of a rate; `None` if they are no whole numbers.
    pub fn divisor(&self, rate: usize) -> Option<(u64, u64)> {
        let clock = &self.schedule.clock;
        let whole = |ticks: u64| {
            let steps = clock.time(ticks) / self.target.step;
            let count = steps.round();
            ((steps - count).abs() <= 1e-9 * count.max(1.0)).then_some(count as u64)
        };
        let rate = clock.rates[rate];
        let (period, offset) = (whole(rate.period)?, whole(rate.offset)?);
        (period > 0).then_some((period, offset))
    }

    /// The clock of the part: its rates in steps of the target. What samples outside is never hit.
    pub fn clock(&self) -> Clock {
        let used = |rate: usize| self.blocks.iter().any(|at| self.block(*at).rate == Some(rate));
        let rates = (0..self.schedule.clock.rates.len()).map(|rate| {
            let (period, offset) = self.divisor(rate).filter(|_| used(rate)).unwrap_or((NEVER, NEVER));
            Rate { period, offset }
        });
        Clock { tick: self.target.step, rates: rates.collect() }
    }

    /// Path of a block below the part.
    pub fn short<'p>(&self, path: &'p str) -> &'p str {
        let below = path.strip_prefix(&self.part.path).unwrap_or(path);
        below.strip_prefix('/').unwrap_or(below)
    }
}

/// The cells that an output group of a block reads at once; all of its inputs without a group.
fn read_cells(block: &Instance, group: Option<usize>) -> impl Iterator<Item = usize> {
    let read = group.into_iter().flat_map(|group| block.read(group));
    let all = block.gather.iter().filter(move |_| group.is_none());
    read.chain(all.flat_map(|&(from, len)| from as usize..(from + len) as usize))
}

/// The cells that an output group of a block writes.
fn written_cells(block: &Instance, group: usize) -> impl Iterator<Item = usize> {
    block.written(group)
}
