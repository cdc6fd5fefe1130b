//! The interpreter: instructions in registers, one after the other.

use crate::{Domain, Id, Op, Program};

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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Failure {
    /// The instruction that requires it.
    pub at: Id,
    /// What the number must be.
    pub domain: Domain,
    /// The number.
    pub value: f64,
}

/// Some values of a program, ready to be computed: instructions in order, over as few registers as possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Code {
    steps: Vec<Step>,
    registers: usize,
    results: Vec<u32>,
}

/// An instruction whose operands are numbers of registers.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Step {
    op: Op,
    to: u32,
    from: Id,
}

impl Code {
    /// The instructions that these values of a program need. Requirements count among the values: they are met where they stand.
    pub fn new(program: &Program, wanted: &[Id]) -> Self {
        let n = program.instructions.len();
        // The last reader of each value; results are read at the end, what is not needed never.
        let mut last: Vec<Option<usize>> = vec![None; n];
        wanted.iter().for_each(|id| last[id.at()] = Some(usize::MAX));
        for at in (0..n).rev() {
            if last[at].is_some() {
                for operand in program.instructions[at].op.operands() {
                    last[operand.at()].get_or_insert(at);
                }
            }
        }
        let (mut place, mut free, mut registers) = (vec![0_u32; n], Vec::new(), 0_u32);
        let mut steps = Vec::new();
        for at in 0..n {
            let Some(end) = last[at] else { continue };
            let op = program.instructions[at].op;
            let read = op.map(|id| Id(place[id.at()]));
            let mut over: Vec<Id> = op.operands().filter(|id| last[id.at()] == Some(at)).collect();
            over.sort_unstable();
            over.dedup();
            free.extend(over.into_iter().map(|id| place[id.at()]));
            let to = free.pop().unwrap_or_else(|| {
                registers += 1;
                registers - 1
            });
            place[at] = to;
            steps.push(Step { op: read, to, from: Id(at as u32) });
            // A requirement has no reader.
            if matches!(op, Op::Require(..)) && end == usize::MAX {
                free.push(to);
            }
        }
        let results = wanted.iter().map(|id| place[id.at()]).collect();
        Self { steps, registers: registers as usize, results }
    }

    /// Number of registers that a run needs.
    pub fn registers(&self) -> usize {
        self.registers
    }

    /// Number of instructions.
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether nothing is computed.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Computes all values. Returns the first requirement that is not met; the values are computed nevertheless.
    ///
    /// # Panics
    /// Panics if there are fewer registers or sources than the program names.
    pub fn run(&self, sources: &Sources, registers: &mut [f64]) -> Option<Failure> {
        let r = &mut registers[..self.registers];
        let mut failure = None;
        for Step { op, to, from } in &self.steps {
            let read = |id: Id| r[id.0 as usize];
            let value = match *op {
                Op::Constant(bits) => f64::from_bits(bits),
                Op::Time => sources.time,
                Op::Input(i) => sources.inputs[i as usize],
                Op::State(i) => sources.states[i as usize],
                Op::Parameter(i) => sources.parameters[i as usize],
                Op::Memory(i) => sources.memories[i as usize],
                Op::Mode(i) => sources.modes[i as usize],
                Op::Require(domain, holds, about) => {
                    if read(holds) == 0.0 {
                        failure.get_or_insert(Failure { at: *from, domain, value: read(about) });
                    }
                    continue;
                }
                op => op.value(read).unwrap_or(f64::NAN),
            };
            r[*to as usize] = value;
        }
        failure
    }

    /// A value, in the order in which they were asked for.
    pub fn result(&self, registers: &[f64], index: usize) -> f64 {
        registers[self.results[index] as usize]
    }
}
