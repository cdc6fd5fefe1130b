//! What a block is handed to record its law.

use std::cell::{OnceCell, RefCell};

pub use blocksim_law::{Condition, Relation, Value};
use blocksim_law::{Id, Outside, Program, Recorder, Replayed};
use blocksim_signal::Shape;

use crate::{Discrete, Interface};

/// Where a block records its law: handles on what its functions would be handed, and a place for each number that they
/// would write. Handles calculate like numbers; nothing is computed yet.
///
/// The order of operations is that of the law: the engine changes no bit of it.
pub struct Recording<'r> {
    recorder: &'r Recorder,
    /// The cells of the inputs, and where those of each port lie among them.
    inputs: Vec<Value<'r>>,
    spans: &'r [(u32, u32)],
    interface: &'r Interface,
    x: Vec<Value<'r>>,
    d: OnceCell<Vec<Value<'r>>>,
    /// What the engine finds, with its place among all outputs.
    unknowns: Vec<(usize, Value<'r>)>,
    written: RefCell<Written>,
}

/// What has been said so far.
#[derive(Debug, Default)]
pub(super) struct Written {
    /// By cell of the outputs.
    pub outputs: Vec<Option<Id>>,
    pub derivatives: Vec<Option<Id>>,
    pub guards: Vec<Option<Id>>,
    pub settled: Vec<Option<Id>>,
    pub updated: Vec<Option<Id>>,
    /// What is left over of constraints.
    pub rest: Vec<Option<Id>>,
    /// Start of each output port among the cells.
    starts: Vec<usize>,
    /// The first thing that is wrong.
    wrong: Option<String>,
}

impl<'r> Recording<'r> {
    pub(super) fn new(
        recorder: &'r Recorder,
        interface: &'r Interface,
        inputs: &'r [(u32, u32)],
        outputs: &[(u32, u32)],
    ) -> Self {
        let read = inputs.iter().map(|span| span.1).max().unwrap_or(0);
        let cells = outputs.iter().map(|span| span.1 as usize).max().unwrap_or(0);
        let none = |n: usize| vec![None; n];
        // A law has no names: those of ports and states are in the interface, by the same numbers.
        let sought = interface.constraint.iter().flat_map(|constraint| &constraint.unknowns);
        let unknowns: Vec<(usize, Value)> =
            sought.map(|(place, guess)| (*place, recorder.parameter("", *guess))).collect();
        let mut given = none(cells);
        unknowns.iter().for_each(|(place, value)| given[*place] = Some(value.id()));
        Self {
            inputs: (0..read).map(|_| recorder.input("")).collect(),
            spans: inputs,
            x: interface.states.iter().map(|state| recorder.state("", state.initial)).collect(),
            interface,
            d: OnceCell::new(),
            written: RefCell::new(Written {
                outputs: given,
                derivatives: none(interface.states.len()),
                guards: none(interface.guards.len()),
                settled: none(interface.discrete.len()),
                updated: none(interface.discrete.len()),
                rest: none(unknowns.len()),
                starts: outputs.iter().map(|span| span.0 as usize).collect(),
                wrong: None,
            }),
            unknowns,
            recorder,
        }
    }

    pub(super) fn finish(self) -> Result<Written, String> {
        let mut written = self.written.into_inner();
        match written.wrong.take() {
            Some(wrong) => Err(wrong),
            None => Ok(written),
        }
    }

    /// All elements of an input port.
    pub fn input(&self, port: usize) -> &[Value<'r>] {
        let (start, end) = self.spans[port];
        &self.inputs[start as usize..end as usize]
    }

    /// The first element of an input port.
    pub fn u(&self, port: usize) -> Value<'r> {
        self.input(port)[0]
    }

    /// Element `i` of an input port; a scalar stands for every element.
    pub fn element(&self, port: usize, i: usize) -> Value<'r> {
        let elements = self.input(port);
        if let [value] = elements { *value } else { elements[i] }
    }

    /// Shape of an input port, as the interface demands it; a vector where it demands none.
    pub fn shape(&self, port: usize) -> Shape {
        self.interface.inputs[port].shape.unwrap_or_else(|| match self.input(port).len() {
            1 => Shape::Scalar,
            n => Shape::Vector(n),
        })
    }

    /// Number of input ports.
    pub fn inputs(&self) -> usize {
        self.spans.len()
    }

    /// Number of elements of an output port.
    pub fn width(&self, port: usize) -> usize {
        let written = self.written.borrow();
        let end = written.starts.get(port + 1).copied().unwrap_or(written.outputs.len());
        end - written.starts[port]
    }

    /// Number of output ports.
    pub fn outputs(&self) -> usize {
        self.written.borrow().starts.len()
    }

    /// Number of guards.
    pub fn guards(&self) -> usize {
        self.written.borrow().guards.len()
    }

    /// Continuous states.
    pub fn x(&self) -> &[Value<'r>] {
        &self.x
    }

    /// Discrete states, as they are held.
    pub fn d(&self) -> &[Value<'r>] {
        // A memory may have millions of cells, and what only copies it records no law.
        let memory = |state: &Discrete| self.recorder.memory("", state.initial);
        self.d.get_or_init(|| self.interface.discrete.iter().map(memory).collect())
    }

    /// Output `place`, counted over all ports, which the engine finds; nothing if it does not.
    pub fn unknown(&self, place: usize) -> Option<Value<'r>> {
        self.unknowns.iter().find(|(at, _)| *at == place).map(|(_, value)| *value)
    }

    /// The time, s.
    pub fn time(&self) -> Value<'r> {
        self.recorder.time()
    }

    /// A number that never changes.
    pub fn constant(&self, value: f64) -> Value<'r> {
        self.recorder.constant(value)
    }

    /// The sum of `factors[i] * values[i]`, in this order, without those whose factor is zero; 0 of nothing.
    pub fn dot(&self, factors: &[f64], values: &[Value<'r>]) -> Value<'r> {
        let products = factors.iter().zip(values).filter(|(factor, _)| **factor != 0.0);
        let products = products.map(|(factor, value)| *factor * *value);
        products.reduce(|sum, product| sum + product).unwrap_or_else(|| self.constant(0.0))
    }

    /// Records a program as a part of the law, with these values for its inputs and for what its modes hold; its states are those of
    /// the block.
    pub fn replay(&self, program: &Program, inputs: &[Value<'r>], modes: &[Value<'r>]) -> Replayed<'r> {
        self.recorder.replay(program, &Outside { inputs, states: &self.x, modes })
    }

    /// Says what element `i` of an output port is.
    pub fn set(&self, port: usize, i: usize, value: Value<'r>) {
        let mut written = self.written.borrow_mut();
        let at = written.starts[port] + i;
        written.note(|written| &mut written.outputs, "output", at, value);
    }

    /// The same of a truth value.
    pub fn set_truth(&self, port: usize, i: usize, value: Condition<'r>) {
        self.set(port, i, value.number());
    }

    /// Says what each element of an output port is.
    pub fn each(&self, port: usize, mut value: impl FnMut(usize) -> Value<'r>) {
        (0..self.width(port)).for_each(|i| self.set(port, i, value(i)));
    }

    /// Says what the derivative of state `i` is.
    pub fn derive(&self, i: usize, value: Value<'r>) {
        self.written.borrow_mut().note(|written| &mut written.derivatives, "derivative", i, value);
    }

    /// Says what guard `i` is.
    pub fn guard(&self, i: usize, value: Value<'r>) {
        self.written.borrow_mut().note(|written| &mut written.guards, "guard", i, value);
    }

    /// Says what discrete state `i` is set to at a major step, just before the outputs; it is held in between.
    pub fn settle(&self, i: usize, value: Value<'r>) {
        self.written.borrow_mut().note(|written| &mut written.settled, "settled state", i, value);
    }

    /// Says what becomes zero when unknown `i` is found.
    pub fn rest(&self, i: usize, value: Value<'r>) {
        self.written.borrow_mut().note(|written| &mut written.rest, "equation", i, value);
    }

    /// Says what discrete state `i` becomes at a sample hit, after the outputs of that instant.
    pub fn update(&self, i: usize, value: Value<'r>) {
        self.written.borrow_mut().note(|written| &mut written.updated, "updated state", i, value);
    }
}

impl Written {
    fn note(
        &mut self,
        list: impl Fn(&mut Self) -> &mut Vec<Option<Id>>,
        what: &str,
        at: usize,
        value: Value,
    ) {
        let wrong = match list(self).get_mut(at) {
            None => format!("there is no {what} {at}"),
            Some(Some(_)) => format!("{what} {at} is set twice"),
            Some(place) => {
                *place = Some(value.id());
                return;
            }
        };
        self.wrong.get_or_insert(wrong);
    }
}

impl Written {
    /// All that was said, list by list.
    pub(super) fn lists(&self) -> [&[Option<Id>]; 6] {
        let Self { outputs, derivatives, guards, settled, updated, rest, .. } = self;
        [outputs, derivatives, guards, settled, updated, rest]
    }

    /// Whether everything was said that has to be.
    ///
    /// # Errors
    /// What was not.
    pub(super) fn is_whole(&self) -> Result<(), String> {
        let lists = [
            (&self.rest, "equation"),
            (&self.outputs, "output"),
            (&self.derivatives, "derivative"),
            (&self.guards, "guard"),
        ];
        for (list, what) in lists {
            if let Some(i) = list.iter().position(Option::is_none) {
                return Err(format!("{what} {i} is not set"));
            }
        }
        Ok(())
    }

    /// The program whose outputs are all that was said.
    pub(super) fn wanted_of(&self, program: Program) -> Program {
        let said = self.lists().into_iter().flatten().flatten();
        Program { outputs: said.map(|id| (String::new(), *id)).collect(), ..program }
    }
}
