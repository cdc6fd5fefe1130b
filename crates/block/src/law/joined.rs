//! Laws of several blocks as one program, over the signals and states of a whole diagram: what the engine runs, and what code for
//! targets is made of.

use blocksim_law::passes::Map;
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
    /// A program whose outputs are wanted anywhere, without what is there twice.
    pub fn of(program: &Program) -> Self {
        let program = program.clone().optimised();
        let values = program.outputs.iter().map(|(_, id)| Root::Anywhere(*id));
        let met = program.requirements.iter().map(|id| Root::Met(*id));
        let roots = values.chain(met).collect();
        Self { program, roots }
    }

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
                program.memories[block.d + i] = memory(format!("{}.{}", block.path, of.name()), of.initial);
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
#[derive(Debug, Clone, Default)]
pub struct Joined {
    program: Program,
    roots: Vec<Root>,
    /// What stands in cells that are written already.
    cells: Map<u32, Id>,
    /// What discrete states have been set to.
    settled: Map<u32, Id>,
}

impl Joined {
    /// The outputs of one group of a block; where it `settles`, the modes that are chosen with it before.
    pub fn call(&mut self, placed: Placed, group: usize, settles: bool) {
        let law = placed.law;
        let mut inlined = Inlined::new(placed);
        let mut wanted: Vec<Id> = Vec::new();
        if settles {
            let chosen = law.chosen_in(group).iter().map(|member| law.settled[*member]).collect::<Vec<_>>();
            self.settle_with(&chosen, &mut inlined);
            wanted.extend(chosen.iter().map(|(_, id)| *id));
        }
        for (cell, id) in law.written(group) {
            let value = inlined.value(id, self);
            let cell = (placed.instance.y + cell) as u32;
            self.roots.push(Root::Cell(value, cell));
            wanted.push(id);
            inlined.written.push((cell, value));
        }
        self.require(&wanted, &mut inlined);
        self.cells.extend(inlined.written);
    }

    /// The modes of a block without outputs.
    pub fn settle(&mut self, placed: Placed) {
        let mut inlined = Inlined::new(placed);
        self.settle_with(&placed.law.settled, &mut inlined);
        let wanted: Vec<Id> = placed.law.settled.iter().map(|(_, id)| *id).collect();
        self.require(&wanted, &mut inlined);
    }

    /// What discrete states become at a sample hit, behind all outputs.
    pub fn update(&mut self, placed: Placed) {
        let mut inlined = Inlined::new(placed);
        let mut wanted = Vec::new();
        for (i, id) in &placed.law.updated {
            let value = inlined.value(*id, self);
            self.roots.push(Root::Held(value, inlined.held(*i)));
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

    /// The rates of values that are wanted anywhere, along a direction in the space of the states, which stands for parameters.
    pub fn rates(self) -> Draft {
        let Draft { program, .. } = self.finish_values();
        let program = blocksim_law::rates(&program, &|op| match op {
            Op::State(i) => Some(Op::Parameter(i)),
            _ => None,
        });
        Draft::of(&program)
    }

    /// How what stands in some cells depends on what stood there before: row by row, a row for each cell. Nothing if one of them is
    /// not written.
    pub fn slopes_by(self, cells: &[u32]) -> Option<Draft> {
        let program = self.of_cells(cells)?;
        let mut all = Program::default();
        let mut columns: Vec<Vec<Id>> = Vec::with_capacity(cells.len());
        for cell in cells {
            let seed = |op: Op| (op == Op::Input(*cell)).then(|| Op::constant(1.0));
            let rates = blocksim_law::rates(&program, &seed);
            let before = all.instructions.len() as u32;
            let moved = |id: Id| Id(id.0 + before);
            let instructions = rates.instructions.into_iter();
            all.instructions.extend(instructions.map(|one| Instruction { op: one.op.map(moved), ..one }));
            columns.push(rates.outputs.into_iter().map(|(_, id)| moved(id)).collect());
        }
        let rows = 0..cells.len();
        all.outputs =
            rows.flat_map(|row| columns.iter().map(move |column| (String::new(), column[row]))).collect();
        Some(Draft::of(&all))
    }

    /// The same along a direction in the space of what stood in these cells, which stands for parameters.
    pub fn slopes_along(self, cells: &[u32]) -> Option<Draft> {
        let program = self.of_cells(cells)?;
        let of_cell: Map<u32, u32> = cells.iter().enumerate().map(|(i, cell)| (*cell, i as u32)).collect();
        let rates = blocksim_law::rates(&program, &|op| match op {
            Op::Input(cell) => of_cell.get(&cell).map(|i| Op::Parameter(*i)),
            _ => None,
        });
        Some(Draft::of(&rates))
    }

    /// The program of what stands in some cells, without requirements.
    fn of_cells(mut self, cells: &[u32]) -> Option<Program> {
        let written = cells.iter().map(|cell| self.cells.get(cell).map(|id| (String::new(), *id)));
        self.program.outputs = written.collect::<Option<_>>()?;
        self.program.requirements.clear();
        Some(self.program.optimised())
    }

    /// The program of the values that are wanted anywhere, which writes no signal; what signals require is required all the same.
    pub fn finish_values(mut self) -> Draft {
        self.roots.retain(|root| matches!(root, Root::Anywhere(_)));
        self.finish()
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

    fn settle_with(&mut self, chosen: &[(usize, Id)], inlined: &mut Inlined) {
        for (i, id) in chosen {
            let value = inlined.value(*id, self);
            self.roots.push(Root::Held(value, inlined.held(*i)));
        }
        for (i, id) in chosen {
            let value = inlined.value(*id, self);
            self.settled.insert(inlined.held(*i), value);
        }
        // Discrete states are others from here.
        if !chosen.is_empty() {
            inlined.values.clear();
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
    instance: &'l Instance,
    /// What stands for each of its values; nothing until it is asked for.
    values: Vec<Id>,
    /// The same where groups are small parts of the law, of the values that have been needed.
    few: Map<Id, Id>,
    /// Cells that it has written, which it does not read itself.
    written: Vec<(u32, Id)>,
}

impl<'l> Inlined<'l> {
    fn new(Placed { law, number, instance }: Placed<'l>) -> Self {
        Self { law, number, instance, values: Vec::new(), few: Map::default(), written: Vec::new() }
    }

    /// The number of a discrete state in the diagram.
    fn held(&self, i: usize) -> u32 {
        (self.instance.d + i) as u32
    }

    /// The cell of an input.
    fn cell(&self, input: u32) -> u32 {
        let mut left = input;
        for &(from, len) in &self.instance.gather {
            if left < len {
                return from + left;
            }
            left -= len;
        }
        unreachable!("a law reads inputs that it has")
    }

    /// What stands for a value of the law. The whole law comes with it; who wants less drops the rest.
    fn value(&mut self, id: Id, joined: &mut Joined) -> Id {
        if self.law.values.is_some() {
            return self.value_alone(id, joined);
        }
        if self.values.is_empty() {
            let instructions = &self.law.program.instructions;
            self.values.reserve(instructions.len());
            for instruction in instructions {
                let value = self.joined(instruction.op, joined, |operand| self.values[operand.0 as usize]);
                self.values.push(value);
            }
        }
        self.values[id.0 as usize]
    }

    /// The same with those values alone that it needs.
    fn value_alone(&mut self, id: Id, joined: &mut Joined) -> Id {
        let mut open = vec![id];
        while let Some(&next) = open.last() {
            let op = self.law.program.op(next);
            let missing = op.operands().filter(|operand| !self.few.contains_key(operand));
            let before = open.len();
            open.extend(missing);
            if open.len() == before {
                open.pop();
                if !self.few.contains_key(&next) {
                    let value = self.joined(op, joined, |operand| self.few[&operand]);
                    self.few.insert(next, value);
                }
            }
        }
        self.few[&id]
    }

    fn joined(&self, op: Op, joined: &mut Joined, of: impl Fn(Id) -> Id) -> Id {
        let op = match op {
            Op::Input(i) => {
                let cell = self.cell(i);
                if let Some(known) = joined.cells.get(&cell) {
                    return *known;
                }
                Op::Input(cell)
            }
            Op::Memory(i) => {
                let number = self.held(i as usize);
                if let Some(known) = joined.settled.get(&number) {
                    return *known;
                }
                Op::Memory(number)
            }
            Op::State(i) => Op::State(self.instance.x as u32 + i),
            // An unknown stands among the outputs.
            Op::Parameter(i) => Op::Input((self.instance.y + self.law.rest[i as usize].0) as u32),
            op => op.map(of),
        };
        joined.push(op, self.number)
    }
}
