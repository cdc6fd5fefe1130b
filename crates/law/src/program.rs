//! What a law becomes: data.

use crate::passes;
use crate::{Id, Op};
use std::ops::Range;

/// A law in static single assignment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Program {
    /// Instructions, each behind those that it needs.
    pub instructions: Vec<Instruction>,
    /// Names of the inputs.
    pub inputs: Vec<String>,
    /// Continuous states.
    pub states: Vec<State>,
    /// Names and values of the parameters, SI.
    pub parameters: Vec<(String, f64)>,
    /// Memories.
    pub memories: Vec<Memory>,
    /// Modes; the value of each needs none but those before it.
    pub modes: Vec<Mode>,
    /// Where the law has kinks.
    pub kinks: Vec<Guard>,
    /// Angles of which only the remainder of a turn counts, rad.
    pub turns: Vec<Id>,
    /// Requirements.
    pub requirements: Vec<Id>,
    /// Names and values of the outputs.
    pub outputs: Vec<(String, Id)>,
}

/// An instruction.
#[derive(Debug, Clone, PartialEq)]
pub struct Instruction {
    /// What it computes.
    pub op: Op,
    /// The bytes of the text that it came from, where there is one.
    pub place: Option<Range<usize>>,
    /// In a program of several laws, the number of the block whose law it came from.
    pub block: Option<u32>,
}

/// A continuous state.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Its name.
    pub name: String,
    /// Its value at the start.
    pub initial: f64,
    /// Its derivative; without one the state is constant.
    pub derivative: Option<Id>,
}

/// A value that changes at sample hits alone.
#[derive(Debug, Clone, PartialEq)]
pub struct Memory {
    /// Its name.
    pub name: String,
    /// Its value at the start.
    pub initial: f64,
    /// What it becomes; it stays where there is nothing.
    pub next: Option<Id>,
}

/// A value that is chosen at major steps and held in between.
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// What is chosen.
    pub value: Id,
    /// Where the choice may change.
    pub guards: Vec<Guard>,
}

/// A number whose zeros a solver must not step over.
#[derive(Debug, Clone, PartialEq)]
pub struct Guard {
    /// What it belongs to: `abs`, `<` ...
    pub name: &'static str,
    /// The number.
    pub value: Id,
}

impl Program {
    /// The operation that computes a value.
    pub fn op(&self, id: Id) -> Op {
        self.instructions[id.at()].op
    }

    /// The values of the outputs.
    pub fn output_values(&self) -> Vec<Id> {
        self.outputs.iter().map(|(_, id)| *id).collect()
    }

    /// The values of the modes.
    pub fn mode_values(&self) -> Vec<Id> {
        self.modes.iter().map(|mode| mode.value).collect()
    }

    /// All guards: those of the modes, then those of the kinks.
    pub fn guards(&self) -> impl Iterator<Item = &Guard> {
        self.modes.iter().flat_map(|mode| &mode.guards).chain(&self.kinks)
    }

    /// Constants folded, equal expressions computed once, nothing that nobody asks for.
    #[must_use]
    pub fn optimised(self) -> Self {
        passes::drop_unused(passes::share_equal(passes::fold_constants(self)))
    }

    /// Whether each value is true or false rather than a number.
    pub fn truths(&self) -> Vec<bool> {
        let mut truths: Vec<bool> = Vec::with_capacity(self.instructions.len());
        for instruction in &self.instructions {
            truths.push(match instruction.op {
                Op::Mode(mode) => truths[self.modes[mode as usize].value.at()],
                Op::Select(_, a, _) => truths[a.at()],
                op => op.is_truth(),
            });
        }
        truths
    }

    /// Changes every reference to an instruction.
    pub(crate) fn each_root(&mut self, mut f: impl FnMut(&mut Id)) {
        self.states.iter_mut().filter_map(|state| state.derivative.as_mut()).for_each(&mut f);
        self.memories.iter_mut().filter_map(|memory| memory.next.as_mut()).for_each(&mut f);
        for mode in &mut self.modes {
            f(&mut mode.value);
            mode.guards.iter_mut().for_each(|guard| f(&mut guard.value));
        }
        self.kinks.iter_mut().for_each(|kink| f(&mut kink.value));
        self.turns.iter_mut().for_each(&mut f);
        self.requirements.iter_mut().for_each(&mut f);
        self.outputs.iter_mut().for_each(|(_, id)| f(id));
    }
}
