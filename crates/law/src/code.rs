//! Some values of one program, ready to be computed from what comes from outside.

use crate::passes::Map;
use crate::{Domain, Id, Leaf, Op, Program, Root, Tape};
use std::ops::Range;

/// What comes from outside while a law is evaluated.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sources<'s> {
    /// Time, s.
    pub time: f64,
    /// Values of the inputs.
    pub inputs: &'s [f64],
    /// Continuous states.
    pub states: &'s [f64],
    /// Values of the parameters.
    pub parameters: &'s [f64],
    /// What the memories hold.
    pub memories: &'s [f64],
    /// What the modes hold.
    pub modes: &'s [f64],
}

/// A requirement that is not met.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    /// The instruction that requires it.
    pub at: Id,
    /// What the number must be.
    pub domain: Domain,
    /// The number.
    pub value: f64,
    /// The bytes of the text that it comes from, where there is one.
    pub place: Option<Range<usize>>,
}

/// Some values of a program, ready to be computed: a tape with its sources, over as few registers as possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Code {
    /// What is brought into the first registers, one each.
    sources: Vec<Op>,
    tape: Tape,
    registers: usize,
    results: Vec<u32>,
    /// The requirements among what is computed, in the order of the program.
    requirements: Vec<(Id, Domain, Option<Range<usize>>)>,
}

impl Code {
    /// The instructions that these values of a program need. Requirements count among the values: they are met where they stand.
    pub fn new(program: &Program, wanted: &[Id]) -> Self {
        let ops: Vec<Op> = program.instructions.iter().map(|instruction| instruction.op).collect();
        let mut needed = vec![false; ops.len()];
        wanted.iter().for_each(|id| needed[id.at()] = true);
        for at in (0..ops.len()).rev() {
            if needed[at] {
                ops[at].operands().for_each(|id| needed[id.at()] = true);
            }
        }
        let mut sources: Vec<Op> = Vec::new();
        let mut numbers = Map::default();
        for (op, _) in ops.iter().zip(&needed).filter(|(op, needed)| **needed && op.is_leaf()) {
            numbers.entry(*op).or_insert_with(|| {
                sources.push(*op);
                sources.len() as u32 - 1
            });
        }
        let requirement = |id: Id| match ops[id.at()] {
            Op::Require(domain, ..) => Some((id, domain, program.instructions[id.at()].place.clone())),
            _ => None,
        };
        let roots: Vec<Root> = wanted
            .iter()
            .map(|id| if requirement(*id).is_some() { Root::Met(*id) } else { Root::Anywhere(*id) })
            .collect();
        let made = Tape::make(&ops, &roots, &|op| Leaf::Cell(numbers[&op]), sources.len() as u32);
        let mut places = made.places.into_iter();
        // A requirement has no value.
        let results = roots.iter().map(|root| match root {
            Root::Anywhere(_) => places.next().unwrap_or_default(),
            _ => 0,
        });
        Self {
            results: results.collect(),
            requirements: wanted.iter().filter_map(|id| requirement(*id)).collect(),
            registers: made.end as usize,
            tape: made.tape,
            sources,
        }
    }

    /// Number of registers that a run needs.
    pub fn registers(&self) -> usize {
        self.registers
    }

    /// Number of instructions.
    pub fn len(&self) -> usize {
        self.tape.len()
    }

    /// Whether nothing is computed.
    pub fn is_empty(&self) -> bool {
        self.tape.is_empty()
    }

    /// Computes all values. Returns the first requirement that is not met; the values are computed nevertheless.
    ///
    /// # Panics
    /// Panics if there are fewer registers or sources than the program names.
    pub fn run(&self, sources: &Sources, registers: &mut [f64]) -> Option<Failure> {
        for (to, source) in registers.iter_mut().zip(&self.sources) {
            *to = match *source {
                Op::Constant(bits) => f64::from_bits(bits),
                Op::Time => sources.time,
                Op::Input(i) => sources.inputs[i as usize],
                Op::State(i) => sources.states[i as usize],
                Op::Parameter(i) => sources.parameters[i as usize],
                Op::Memory(i) => sources.memories[i as usize],
                Op::Mode(i) => sources.modes[i as usize],
                _ => f64::NAN,
            };
        }
        let (at, value) = self.tape.run(&mut registers[..self.registers], &mut []).failed?;
        let (_, domain, place) = self.requirements.iter().find(|(id, ..)| *id == at)?;
        Some(Failure { at, domain: *domain, value, place: place.clone() })
    }

    /// A value, in the order in which they were asked for.
    pub fn result(&self, registers: &[f64], index: usize) -> f64 {
        registers[self.results[index] as usize]
    }
}
