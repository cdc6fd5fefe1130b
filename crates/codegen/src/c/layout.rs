//! Where everything lies in the structs of the code.

use std::collections::BTreeMap;

use super::wide::Wide;
use blocksim_block::law::Op;
use blocksim_signal::{Dimension, Kind, Shape};

use super::names::Names;
use crate::Port;
use crate::part::Selected;
use crate::programs::{Programs, constant};
use crate::replay::Start;

/// Names of the fields of all structs.
pub(super) struct Layout<'l> {
    pub selected: &'l Selected<'l>,
    pub start: &'l Start,
    /// `double` or `float`.
    pub real: &'static str,
    /// Ports as fields, and which ports of the part they are.
    pub inputs: Vec<(String, usize)>,
    pub outputs: Vec<(String, usize)>,
    /// Continuous states by their numbers in the diagram, in the order of their array.
    pub states: Vec<usize>,
    /// Fields of discrete states that are read, by their numbers in the diagram.
    pub memories: BTreeMap<usize, String>,
    /// Fields of signals that one program writes and another reads, or that go out, by their cells.
    pub signals: BTreeMap<usize, String>,
    /// What stays in double precision in code of single precision.
    pub wide: Wide,
    /// Counters of steps, by rates of the diagram; those that are hit at each step have none.
    pub counters: BTreeMap<usize, String>,
}

impl<'l> Layout<'l> {
    pub fn new(selected: &'l Selected<'l>, start: &'l Start, programs: &Programs) -> Self {
        let part = selected.part;
        let ports = |ports: &[Port], is_wanted: &dyn Fn(&Port) -> bool| -> Vec<(String, usize)> {
            let mut names = Names::default();
            let wanted = ports.iter().enumerate().filter(|(_, port)| is_wanted(port));
            wanted.map(|(number, port)| (names.add(&port.name), number)).collect()
        };
        let mut names = Names::with(&["step", "x"]);
        let mut counters = BTreeMap::new();
        for (due, _) in &programs.steps {
            if let crate::programs::Due::Rate(rate) = due
                && !counters.contains_key(rate)
            {
                let clock = &selected.schedule.clock;
                let period = format!("{}", clock.time(clock.rates[*rate].period));
                counters.insert(*rate, names.add(&format!("wait_{period}_s")));
            }
        }
        let mut layout = Self {
            selected,
            start,
            real: if selected.target.float { "float" } else { "double" },
            inputs: ports(&part.inputs, &|port| selected.inputs.contains_key(&port.cell)),
            outputs: ports(&part.outputs, &|_| true),
            states: programs.derivatives.iter().flat_map(|(_, states)| states.clone()).collect(),
            memories: BTreeMap::new(),
            signals: BTreeMap::new(),
            wide: if selected.target.float { Wide::new(programs) } else { Wide::default() },
            counters,
        };
        let (mut memories, mut cells) = (Vec::new(), Vec::new());
        for draft in programs.drafts() {
            for instruction in &draft.program.instructions {
                match instruction.op {
                    Op::Memory(number) => memories.push(number as usize),
                    Op::Input(cell) => cells.push(cell as usize),
                    _ => {}
                }
            }
        }
        cells.extend(part.outputs.iter().flat_map(Port::cells));
        memories.sort_unstable();
        memories.dedup();
        for number in memories {
            let name = layout.memory_path(number);
            layout.memories.insert(number, names.add(&name));
        }
        cells.sort_unstable();
        cells.dedup();
        for cell in cells.into_iter().filter(|cell| selected.written.contains(cell)) {
            let name = layout.signal_path(cell);
            layout.signals.insert(cell, names.add(&name));
        }
        layout
    }

    /// Whether a signal is a field.
    pub fn keeps(&self, cell: usize) -> bool {
        self.signals.contains_key(&cell)
    }

    /// The field of a signal.
    pub fn signal(&self, cell: usize) -> String {
        format!("self->{}", self.signals.get(&cell).map_or("", String::as_str))
    }

    /// The field of a discrete state.
    pub fn memory(&self, number: usize) -> String {
        format!("self->{}", self.memories.get(&number).map_or("", String::as_str))
    }

    /// The place of a continuous state in the array of all.
    pub fn state(&self, number: usize) -> usize {
        self.states.iter().position(|state| *state == number).unwrap_or(0)
    }

    /// The value of a signal, wherever it is.
    pub fn read(&self, cell: usize) -> String {
        if let Some(value) = constant(self.selected, self.start, cell) {
            return self.literal(value);
        }
        match self.selected.inputs.get(&cell) {
            Some((port, element)) => {
                let of = &self.selected.part.inputs[*port];
                let name = self.inputs.iter().find(|(_, number)| number == port).map_or("", |(name, _)| name);
                let element = if of.shape == Shape::Scalar { String::new() } else { format!("[{element}]") };
                match of.kind {
                    Kind::Bool => format!("({})in->{name}{element}", self.real),
                    Kind::Real | Kind::Int => format!("in->{name}{element}"),
                }
            }
            None => self.signal(cell),
        }
    }

    pub fn is_single(&self) -> bool {
        self.real == "float"
    }

    /// The type of a discrete state.
    pub fn memory_type(&self, number: usize) -> &'static str {
        self.kind(self.wide.memories.contains(&(number as u32)))
    }

    /// The type of a signal that is a field.
    pub fn signal_type(&self, cell: usize) -> &'static str {
        self.kind(self.wide.cells.contains(&(cell as u32)))
    }

    /// The type of a number that stays in double precision, or does not.
    pub fn kind(&self, is_wide: bool) -> &'static str {
        if is_wide { "double" } else { self.real }
    }

    /// A number with all its digits.
    pub fn literal(&self, value: f64) -> String {
        self.literal_of(value, self.real)
    }

    /// A number with all the digits that its type has.
    pub fn literal_of(&self, value: f64, kind: &str) -> String {
        let single = value as f32;
        let (is_finite, text) = match kind == "float" {
            true => (single.is_finite(), format!("{single:?}f")),
            false => (value.is_finite(), format!("{value:?}")),
        };
        match is_finite {
            true if value.is_sign_negative() => format!("({text})"),
            true => text,
            false if value.is_nan() => "NAN".to_owned(),
            false if value < 0.0 => "(-INFINITY)".to_owned(),
            false => "INFINITY".to_owned(),
        }
    }

    /// Path of a block, fit for a comment.
    pub fn path(&self, block: usize) -> String {
        comment(self.selected.short(&self.selected.block(block).path))
    }

    /// Path and kind of a block.
    pub fn title(&self, block: usize) -> String {
        format!("{} ({})", self.path(block), comment(&self.selected.block(block).kind))
    }

    /// Path and name of a discrete state.
    pub fn memory_path(&self, number: usize) -> String {
        let blocks = self.selected.blocks.iter().map(|at| self.selected.block(*at));
        let own = blocks
            .filter(|block| !block.interface.discrete.is_empty())
            .find(|block| (block.d..block.d + block.interface.discrete.len()).contains(&number));
        own.map_or(String::new(), |block| {
            format!(
                "{}.{}",
                self.selected.short(&block.path),
                block.interface.discrete[number - block.d].name()
            )
        })
    }

    /// Path and name of a continuous state.
    pub fn state_path(&self, number: usize) -> String {
        let blocks = self.selected.blocks.iter().map(|at| self.selected.block(*at));
        let own = blocks
            .filter(|block| !block.interface.states.is_empty())
            .find(|block| (block.x..block.x + block.interface.states.len()).contains(&number));
        own.map_or(String::new(), |block| {
            format!("{}.{}", self.selected.short(&block.path), block.interface.states[number - block.x].name)
        })
    }

    /// Path of a signal, with the element of vectors.
    pub fn signal_path(&self, cell: usize) -> String {
        let holds = |signal: &&blocksim_block::schedule::Signal| {
            (signal.offset..signal.offset + signal.shape.len()).contains(&cell)
        };
        let Some(signal) = self.selected.schedule.signals.iter().find(holds) else {
            return format!("signal_{cell}");
        };
        let name = self.selected.short(&signal.path);
        if signal.shape == Shape::Scalar {
            name.to_owned()
        } else {
            format!("{name}[{}]", cell - signal.offset)
        }
    }

    /// Type, field and comment of a port.
    pub fn field(&self, name: &str, port: &Port) -> String {
        let kind = if port.kind == Kind::Bool { "bool" } else { self.real };
        let size =
            if port.shape == Shape::Scalar { String::new() } else { format!("[{}]", port.shape.len()) };
        let mut words = vec![unit(port)];
        if let Shape::Matrix(rows, columns) = port.shape {
            words.push(format!("{rows} x {columns}, row by row"));
        }
        if name != port.name {
            words.push(comment(&port.name));
        }
        if port.signal != port.name {
            words.push(format!("in the diagram {}", comment(&port.signal)));
        }
        format!("    {kind} {name}{size}; /* {} */\n", words.join("; "))
    }
}

fn unit(port: &Port) -> String {
    match (port.kind, port.dimension.and_then(Dimension::settled)) {
        (Kind::Bool, _) => "true or false".to_owned(),
        (Kind::Int, _) => "a whole number".to_owned(),
        (Kind::Real, Some(dimension)) => format!("unit {dimension}"),
        (Kind::Real, None) => "any unit".to_owned(),
    }
}

/// Words that do not end a comment.
pub(super) fn comment(text: &str) -> String {
    let line: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    line.replace("*/", "* /").replace("/*", "/ *")
}
