//! Laws of several blocks as one program, over the signals and states of a whole diagram: what the engine runs, and what code for
//! targets is made of.

use std::collections::HashMap;

use blocksim_law::{Id, Instruction, Op, Program, Root};

use super::BlockLaw;
use crate::schedule::{Instance, Schedule};

/// A program of several laws and what is wanted of it. Its inputs are cells of the signals, its states and memories the continuous
/// and discrete states of the diagram.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Draft {
    /// The program; nothing that comes from outside has a name, see [`Draft::named`].
    pub program: Program,
    /// Where values go, in the order in which they were wanted, and the requirements behind them.
    pub roots: Vec<Root>,
}

impl Draft {
    /// The program with the names that signals, states and memories have in the diagram.
    pub fn named(&self, schedule: &Schedule) -> Program {
        let mut program = self.program.clone();
        program.inputs = (0..schedule.initial_signals.len()).map(|cell| format!("#{cell}")).collect();
        for signal in &schedule.signals {
            for i in 0..signal.shape.len() {
                let element = if signal.shape.len() == 1 { String::new() } else { format!("[{i}]") };
                program.inputs[signal.offset + i] = format!("{}{element}", signal.path);
            }
        }
        let state = |name: String, initial: f64| blocksim_law::State { name, initial, derivative: None };
        let memory = |name: String, initial: f64| blocksim_law::Memory { name, initial, next: None };
        program.states = vec![state(String::new(), 0.0); schedule.states];
        program.memories = vec![memory(String::new(), 0.0); schedule.discrete];
        for block in &schedule.blocks {
            for (i, of) in block.interface.states.iter().enumerate() {
                program.states[block.x + i] = state(format!("{}.{}", block.path, of.name), of.initial);
            }
            for (i, of) in block.interface.discrete.iter().enumerate() {
                program.memories[block.d + i] = memory(format!("{}.{}", block.path, of.name), of.initial);
            }
        }
        program
    }
}

/// The law of a block and where its values lie in a diagram.
#[derive(Debug, Clone, Copy)]
pub struct Placed<'l> {
    law: &'l BlockLaw,
    number: u32,
    instance: &'l Instance,
}

impl<'l> Placed<'l> {
    /// The law of block `number` of a diagram.
    pub fn new(law: &'l BlockLaw, number: usize, instance: &'l Instance) -> Self {
        Self { law, number: number as u32, instance }
    }
}

/// Laws on their way into one program. Blocks come in the order in which they are evaluated: who reads a signal that is written
/// already reads the value itself.
#[derive(Debug, Default)]
pub struct Joined {
    program: Program,
    roots: Vec<Root>,
    /// What stands in cells that are written already.
    cells: HashMap<u32, Id>,
    /// What discrete states have been set to.
    settled: HashMap<u32, Id>,
}

impl Joined {
    /// The outputs of one group of a block; where it `settles`, its modes before.
    pub fn call(&mut self, placed: Placed, group: usize, settles: bool) {
        let law = placed.law;
        let mut inlined = Inlined::new(placed);
        let mut wanted: Vec<Id> = Vec::new();
        if settles {
            self.settle_with(&mut inlined);
            wanted.extend(law.settled.iter().map(|(_, id)| *id));
        }
        for (cell, (id, of)) in law.outputs.iter().zip(&law.group_of).enumerate() {
            if *of == group {
                let value = inlined.value(*id, self);
                let cell = (placed.instance.y + cell) as u32;
                self.roots.push(Root::Cell(value, cell));
                wanted.push(*id);
                inlined.written.push((cell, value));
            }
        }
        self.require(&wanted, &mut inlined);
        self.cells.extend(inlined.written);
    }

    /// The modes of a block without outputs.
    pub fn settle(&mut self, placed: Placed) {
        let mut inlined = Inlined::new(placed);
        self.settle_with(&mut inlined);
        let wanted: Vec<Id> = placed.law.settled.iter().map(|(_, id)| *id).collect();
        self.require(&wanted, &mut inlined);
    }

    /// What discrete states become at a sample hit, behind all outputs.
    pub fn update(&mut self, placed: Placed) {
        let mut inlined = Inlined::new(placed);
        let mut wanted = Vec::new();
        for (i, id) in &placed.law.updated {
            let value = inlined.value(*id, self);
            self.roots.push(Root::Held(value, inlined.d + *i as u32));
            wanted.push(*id);
        }
        self.require(&wanted, &mut inlined);
    }

    /// Values of a law that are wanted anywhere: derivatives, guards.
    pub fn values(&mut self, placed: Placed, wanted: &[Id]) {
        let mut inlined = Inlined::new(placed);
        for id in wanted {
            let value = inlined.value(*id, self);
            self.roots.push(Root::Anywhere(value));
        }
        self.require(wanted, &mut inlined);
    }

    /// The program without what is there twice, and what is wanted of it.
    pub fn finish(mut self) -> Draft {
        let value = |root: &Root| match *root {
            Root::Cell(id, _) | Root::Held(id, _) | Root::Anywhere(id) | Root::Met(id) => id,
        };
        self.program.outputs = self.roots.iter().map(|root| (String::new(), value(root))).collect();
        let program = self.program.optimised();
        let ids = program.outputs.iter().map(|(_, id)| *id);
        let moved = self.roots.iter().zip(ids).map(|(root, id)| match *root {
            Root::Cell(_, cell) => Root::Cell(id, cell),
            Root::Held(_, number) => Root::Held(id, number),
            Root::Anywhere(_) => Root::Anywhere(id),
            Root::Met(_) => Root::Met(id),
        });
        let mut roots: Vec<Root> = moved.collect();
        roots.extend(program.requirements.iter().map(|id| Root::Met(*id)));
        Draft { program, roots }
    }

    fn settle_with(&mut self, inlined: &mut Inlined) {
        let law = inlined.law;
        for (i, id) in &law.settled {
            let value = inlined.value(*id, self);
            self.roots.push(Root::Held(value, inlined.d + *i as u32));
        }
        for (i, id) in &law.settled {
            let value = inlined.value(*id, self);
            self.settled.insert(inlined.d + *i as u32, value);
        }
        // Discrete states are others from here.
        if !law.settled.is_empty() {
            inlined.values.fill(None);
        }
    }

    fn push(&mut self, op: Op, block: u32) -> Id {
        self.program.instructions.push(Instruction { op, place: None, block: Some(block) });
        Id(self.program.instructions.len() as u32 - 1)
    }

    fn require(&mut self, wanted: &[Id], inlined: &mut Inlined) {
        for id in inlined.law.requirements_of(wanted) {
            let value = inlined.value(id, self);
            self.program.requirements.push(value);
        }
    }
}

/// The law of one block on its way into a program of several.
struct Inlined<'l> {
    law: &'l BlockLaw,
    number: u32,
    /// Where its inputs lie among the signals.
    inputs: Vec<u32>,
    x: u32,
    d: u32,
    /// What stands for each of its values.
    values: Vec<Option<Id>>,
    /// Cells that it has written, which it does not read itself.
    written: Vec<(u32, Id)>,
}

impl<'l> Inlined<'l> {
    fn new(placed: Placed<'l>) -> Self {
        let Placed { law, number, instance } = placed;
        let inputs = instance.gather.iter().flat_map(|&(from, len)| from..from + len).collect();
        let values = vec![None; law.program.instructions.len()];
        let (x, d) = (instance.x as u32, instance.d as u32);
        Self { law, number, inputs, x, d, values, written: Vec::new() }
    }

    /// What stands for a value of the law, with all that it needs.
    fn value(&mut self, id: Id, joined: &mut Joined) -> Id {
        // Operands come before those who need them.
        let mut needed = vec![id];
        let mut at = 0;
        while let Some(next) = needed.get(at).copied() {
            at += 1;
            if self.values[next.0 as usize].is_none() {
                needed.extend(self.law.program.op(next).operands());
            }
        }
        needed.sort_unstable();
        needed.dedup();
        for id in needed {
            if self.values[id.0 as usize].is_some() {
                continue;
            }
            let op = self.law.program.op(id);
            let known = match op {
                Op::Input(i) => joined.cells.get(&self.inputs[i as usize]).copied(),
                Op::Memory(i) => joined.settled.get(&(self.d + i)).copied(),
                _ => None,
            };
            let value = known.unwrap_or_else(|| {
                let op = match op {
                    Op::Input(i) => Op::Input(self.inputs[i as usize]),
                    Op::State(i) => Op::State(self.x + i),
                    Op::Memory(i) => Op::Memory(self.d + i),
                    op => op.map(|operand| self.values[operand.0 as usize].unwrap_or(operand)),
                };
                joined.push(op, self.number)
            });
            self.values[id.0 as usize] = Some(value);
        }
        self.values[id.0 as usize].unwrap_or(id)
    }
}
