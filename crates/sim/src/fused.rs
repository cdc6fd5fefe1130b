//! Laws that are data, run as one: the blocks of a pass that follow each other and record their laws become a tape over the
//! cells of the signals, in which what they have in common is computed once and nothing is called.
//!
//! Each tape leaves the bits in every cell that its blocks would have left there one by one, so who reads signals need not know.
//! Where a requirement of a law is not met, the pass is done again block by block, which finds out whose it is.

use std::ops::Range;

use blocksim_block::law::BlockLaw;
use blocksim_block::schedule::{Schedule, When};
use blocksim_law::passes::Map;
use blocksim_law::{Id, Instruction, Leaf, Met, Op, Program, Root, Tape};

use crate::plan::{Call, Plan, Unit};

/// The tapes of a diagram.
#[derive(Debug, Default)]
pub(crate) struct Fused {
    pub major: Vec<Part>,
    pub continuous: Vec<Part>,
    pub minor: Vec<Part>,
    pub rows: Vec<Part>,
    pub derivatives: Gathered,
    pub guards: Gathered,
    /// Exact slopes of the derivatives, where all that these depend on is data.
    pub slopes: Option<Slopes>,
    layout: Layout,
}

/// A part of a pass.
#[derive(Debug)]
pub(crate) enum Part {
    /// Calls one after the other, by their number in the pass.
    Calls(Range<usize>),
    /// The tape of calls that are due at the same times, and their numbers in the pass.
    Tape(Tape, Range<usize>, When),
}

/// What many blocks write, each some of it: derivatives or guards.
#[derive(Debug, Default)]
pub(crate) struct Gathered {
    tape: Tape,
    /// From which cell, to where.
    copies: Vec<(u32, u32)>,
    /// Blocks that have to be called.
    pub called: Vec<usize>,
}

/// How the derivatives change along a direction in the space of the states.
#[derive(Debug)]
pub(crate) struct Slopes {
    rates: Gathered,
    /// First cell of the direction.
    direction: usize,
}

/// Where tapes find what is no signal: behind the signals, among whose cells they work.
#[derive(Debug, Default)]
struct Layout {
    states: usize,
    time: usize,
    /// A direction in the space of the states.
    direction: usize,
    constants: Map<u64, u32>,
    /// First cell that is free for what a tape computes on its way.
    temporaries: u32,
    /// Number of cells with all that tapes need.
    end: u32,
}

impl Fused {
    /// The tapes of a plan. Calls within algebraic loops are left as they are.
    pub fn new(schedule: &Schedule, plan: &Plan) -> Self {
        let mut laws = Laws { schedule, plan, first: vec![u32::MAX; schedule.blocks.len()] };
        for call in &plan.major {
            let first = &mut laws.first[call.block as usize];
            *first = (*first).min(call.number);
        }
        let laws = laws;
        let mut in_ring = vec![false; plan.major.len()];
        for found in &schedule.loops {
            in_ring[found.first..found.first + found.count].fill(true);
        }
        let mut drafts = Vec::new();
        let mut parts = |calls: &[Call], major: bool| {
            let is_free = |call: &Call| !in_ring[call.number as usize] && laws.is_recorded(call, major);
            let mut parts: Vec<Part> = Vec::new();
            let mut at = 0;
            while at < calls.len() {
                let first = &calls[at];
                let free = is_free(first);
                let alike = |call: &Call| is_free(call) == free && (!free || call.when == first.when);
                let end = at + calls[at..].iter().take_while(|call| alike(call)).count();
                parts.push(if free {
                    drafts.push(laws.pass(&calls[at..end], major));
                    Part::Tape(Tape::default(), at..end, first.when)
                } else {
                    Part::Calls(at..end)
                });
                at = end;
            }
            parts
        };
        let mut fused = Self {
            major: parts(&plan.major, true),
            continuous: parts(&plan.continuous, false),
            minor: parts(&plan.minor, false),
            rows: plan.rows.as_ref().map(|rows| parts(rows, false)).unwrap_or_default(),
            ..Self::default()
        };
        let derivatives = laws.gathered(&plan.with_states, |law| &law.derivatives, |unit| unit.x.range());
        let guards = laws.gathered(&plan.guarded, |law| &law.guards, |unit| unit.g.range());
        let slopes = laws.slopes();
        // Where anything lies depends on the constants of all.
        let gathered = [&derivatives.0, &guards.0].into_iter().chain(&slopes);
        let mut layout = Layout::new(schedule, drafts.iter().chain(gathered).map(|draft| &draft.program));
        let lists = [&mut fused.major, &mut fused.continuous, &mut fused.minor, &mut fused.rows];
        let tapes = lists.into_iter().flatten().filter_map(|part| match part {
            Part::Tape(tape, ..) => Some(tape),
            Part::Calls(_) => None,
        });
        tapes.zip(&drafts).for_each(|(tape, draft)| *tape = layout.made(draft).0);
        fused.derivatives = layout.gathered(derivatives);
        fused.guards = layout.gathered(guards);
        fused.slopes = slopes.map(|draft| {
            let to = (0..schedule.states as u32).collect();
            Slopes { rates: layout.gathered((draft, to, Vec::new())), direction: layout.direction }
        });
        fused.layout = layout;
        fused
    }

    /// No tapes: every block is called. The reference that tapes are held against.
    pub fn one_by_one(schedule: &Schedule, plan: &Plan) -> Self {
        let all = |calls: &[Call]| vec![Part::Calls(0..calls.len())];
        let called = |called: &[usize]| Gathered { called: called.to_vec(), ..Gathered::default() };
        // Exact slopes are no matter of how blocks are called.
        let Self { slopes, layout, .. } = Self::new(schedule, plan);
        Self {
            major: all(&plan.major),
            continuous: all(&plan.continuous),
            minor: all(&plan.minor),
            rows: plan.rows.as_deref().map(all).unwrap_or_default(),
            derivatives: called(&plan.with_states),
            guards: called(&plan.guarded),
            slopes,
            layout,
        }
    }

    /// Makes room for the tapes behind the signals, and puts constants there.
    pub fn make_room(&self, signals: &mut Vec<f64>) {
        signals.resize(self.layout.end as usize, 0.0);
        for (bits, cell) in &self.layout.constants {
            signals[*cell as usize] = f64::from_bits(*bits);
        }
    }

    /// Puts time and states where tapes find them.
    #[inline]
    pub fn place(&self, t: f64, x: &[f64], signals: &mut [f64]) {
        let Layout { states, time, .. } = self.layout;
        signals[states..states + x.len()].copy_from_slice(x);
        signals[time] = t;
    }
}

impl Gathered {
    /// Computes what the laws say and brings it to where it belongs. Returns whether all requirements are met.
    #[inline]
    pub fn run(&self, signals: &mut [f64], d: &mut [f64], to: &mut [f64]) -> bool {
        let Met { failed, .. } = self.tape.run(signals, d);
        for &(from, at) in &self.copies {
            to[at as usize] = signals[from as usize];
        }
        failed.is_none()
    }
}

impl Slopes {
    /// Writes how the derivatives change. Returns whether that is known here.
    pub fn run(&self, signals: &mut [f64], d: &mut [f64], direction: &[f64], change: &mut [f64]) -> bool {
        signals[self.direction..self.direction + direction.len()].copy_from_slice(direction);
        self.rates.run(signals, d, change)
    }
}

impl Layout {
    fn new<'p>(schedule: &Schedule, programs: impl Iterator<Item = &'p Program>) -> Self {
        let states = schedule.initial_signals.len();
        let time = states + schedule.states;
        let direction = time + 1;
        let first = direction + schedule.states;
        let mut layout = Self { states, time, direction, ..Self::default() };
        for instruction in programs.flat_map(|program| &program.instructions) {
            if let Op::Constant(bits) = instruction.op {
                let next = (first + layout.constants.len()) as u32;
                layout.constants.entry(bits).or_insert(next);
            }
        }
        layout.temporaries = (first + layout.constants.len()) as u32;
        layout.end = layout.temporaries;
        layout
    }

    /// The tape of a program, and where it leaves what it does not bring anywhere.
    fn made(&mut self, draft: &Draft) -> (Tape, Vec<u32>) {
        let ops: Vec<Op> = draft.program.instructions.iter().map(|instruction| instruction.op).collect();
        let leaf = |op: Op| match op {
            Op::State(i) => Leaf::Cell(self.states as u32 + i),
            Op::Time => Leaf::Cell(self.time as u32),
            Op::Constant(bits) => Leaf::Cell(self.constants[&bits]),
            Op::Input(cell) => Leaf::Cell(cell),
            Op::Parameter(i) => Leaf::Cell(self.direction as u32 + i),
            Op::Memory(i) => Leaf::Held(i),
            other => unreachable!("{other:?} is in no law of a block"),
        };
        let made = Tape::make(&ops, &draft.roots, &leaf, self.temporaries);
        self.end = self.end.max(made.end);
        (made.tape, made.places)
    }

    fn gathered(&mut self, (draft, to, called): (Draft, Vec<u32>, Vec<usize>)) -> Gathered {
        let (tape, places) = self.made(&draft);
        Gathered { tape, copies: places.into_iter().zip(to).collect(), called }
    }
}

/// A program and what is wanted of it.
struct Draft {
    program: Program,
    roots: Vec<Root>,
}

/// The laws of the blocks of a plan.
struct Laws<'p> {
    schedule: &'p Schedule,
    plan: &'p Plan,
    /// The first call of each block in a major pass.
    first: Vec<u32>,
}

impl Laws<'_> {
    fn law(&self, block: usize) -> Option<&BlockLaw> {
        self.schedule.blocks[block].law.as_deref()
    }

    /// Whether all that a pass wants of a call is recorded.
    fn is_recorded(&self, call: &Call, major: bool) -> bool {
        let law = self.law(call.block as usize);
        law.is_some_and(|law| !(major && call.settles && law.settled.is_empty()))
    }

    /// Calls that follow each other. In a major pass blocks settle before their first outputs.
    fn pass(&self, calls: &[Call], major: bool) -> Draft {
        let mut joined = Joined::default();
        self.join(calls, major, &mut joined);
        joined.finish()
    }

    fn join(&self, calls: &[Call], major: bool, joined: &mut Joined) {
        for call in calls {
            let unit = &call.unit;
            let Some(law) = self.law(call.block as usize) else { continue };
            let copies = &self.plan.copies[unit.copies.range()];
            let mut inlined = Inlined::new(law, unit, copies);
            let settles = major && self.first[call.block as usize] == call.number;
            if settles {
                for (i, id) in &law.settled {
                    let held = unit.d.start + *i as u32;
                    let value = inlined.value(*id, joined);
                    joined.want(Root::Held(value, held));
                }
                for (i, id) in &law.settled {
                    let value = inlined.value(*id, joined);
                    joined.settled.insert(unit.d.start + *i as u32, value);
                }
                inlined.forget();
            }
            let group = call.group as usize;
            let mut wanted: Vec<Id> = Vec::new();
            for (cell, (id, of)) in law.outputs.iter().zip(&law.group_of).enumerate() {
                if *of == group {
                    let value = inlined.value(*id, joined);
                    let cell = unit.y.start + cell as u32;
                    joined.want(Root::Cell(value, cell));
                    wanted.push(*id);
                    inlined.written.push((cell, value));
                }
            }
            if settles {
                wanted.extend(law.settled.iter().map(|(_, id)| *id));
            }
            joined.require(law, &wanted, &mut inlined);
            joined.cells.extend(inlined.written);
        }
    }

    /// The rates of all derivatives along a direction of the states, which stands for parameters of the program; nothing unless all
    /// that derivatives depend on between major steps is data.
    fn slopes(&self) -> Option<Draft> {
        let plan = self.plan;
        let is_law = |call: &Call| self.is_recorded(call, false);
        let laws: Option<Vec<&BlockLaw>> = plan.with_states.iter().map(|block| self.law(*block)).collect();
        let laws = laws.filter(|laws| {
            !laws.is_empty() && self.schedule.loops.is_empty() && plan.minor.iter().all(is_law)
        })?;
        let mut joined = Joined::default();
        self.join(&plan.minor, false, &mut joined);
        joined.roots.clear();
        for (&block, law) in plan.with_states.iter().zip(laws) {
            let unit = &plan.units[block];
            let mut inlined = Inlined::new(law, unit, &plan.copies[unit.copies.range()]);
            for id in &law.derivatives {
                let value = inlined.value(*id, &mut joined);
                joined.want(Root::Anywhere(value));
            }
            joined.require(law, &law.derivatives, &mut inlined);
        }
        let Draft { program, .. } = joined.finish();
        let program = blocksim_law::rates(&program, &|op| match op {
            Op::State(i) => Some(Op::Parameter(i)),
            _ => None,
        });
        let program = program.optimised();
        let mut roots: Vec<Root> = program.outputs.iter().map(|(_, id)| Root::Anywhere(*id)).collect();
        roots.extend(program.requirements.iter().map(|id| Root::Met(*id)));
        Some(Draft { program, roots })
    }

    /// What blocks write together: how, where each number goes, and who has to be called.
    fn gathered(
        &self,
        blocks: &[usize],
        written: impl Fn(&BlockLaw) -> &Vec<Id>,
        place: impl Fn(&Unit) -> Range<usize>,
    ) -> (Draft, Vec<u32>, Vec<usize>) {
        let (mut joined, mut to, mut called) = (Joined::default(), Vec::new(), Vec::new());
        for &block in blocks {
            let Some(law) = self.law(block) else {
                called.push(block);
                continue;
            };
            let unit = &self.plan.units[block];
            let mut inlined = Inlined::new(law, unit, &self.plan.copies[unit.copies.range()]);
            for (at, id) in place(unit).zip(written(law)) {
                let value = inlined.value(*id, &mut joined);
                joined.want(Root::Anywhere(value));
                to.push(at as u32);
            }
            joined.require(law, written(law), &mut inlined);
        }
        (joined.finish(), to, called)
    }
}

/// Laws of several blocks as one program: inputs are cells of signals, states and memories those of the whole diagram.
#[derive(Default)]
struct Joined {
    program: Program,
    roots: Vec<Root>,
    /// What stands in cells that are written already.
    cells: Map<u32, Id>,
    /// What discrete states have been set to.
    settled: Map<u32, Id>,
}

impl Joined {
    fn want(&mut self, root: Root) {
        self.roots.push(root);
    }

    fn push(&mut self, op: Op) -> Id {
        self.program.instructions.push(Instruction { op, place: None });
        Id(self.program.instructions.len() as u32 - 1)
    }

    fn require(&mut self, law: &BlockLaw, wanted: &[Id], inlined: &mut Inlined) {
        for id in law.requirements_of(wanted) {
            let value = inlined.value(id, self);
            self.program.requirements.push(value);
        }
    }

    /// The program without what is there twice, and what is wanted of it.
    fn finish(mut self) -> Draft {
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
}

/// The law of one block on its way into a program of several.
struct Inlined<'l> {
    law: &'l BlockLaw,
    unit: &'l Unit,
    copies: &'l [(u32, u32)],
    /// What stands for each of its values; nothing until it is asked for.
    values: Vec<Id>,
    /// Cells that it has written, which it does not read itself.
    written: Vec<(u32, Id)>,
}

impl<'l> Inlined<'l> {
    fn new(law: &'l BlockLaw, unit: &'l Unit, copies: &'l [(u32, u32)]) -> Self {
        Self { law, unit, copies, values: Vec::new(), written: Vec::new() }
    }

    /// Discrete states are others from here.
    fn forget(&mut self) {
        if !self.law.settled.is_empty() {
            self.values.clear();
        }
    }

    /// The cell of an input.
    fn cell(&self, input: u32) -> u32 {
        let mut left = input;
        for &(from, len) in self.copies {
            if left < len {
                return from + left;
            }
            left -= len;
        }
        unreachable!("a law reads inputs that it has")
    }

    /// What stands for a value of the law. The whole law comes with it; who wants less drops the rest.
    fn value(&mut self, id: Id, joined: &mut Joined) -> Id {
        if self.values.is_empty() {
            let instructions = &self.law.program.instructions;
            self.values.reserve(instructions.len());
            for instruction in instructions {
                let value = self.joined_value(instruction.op, joined);
                self.values.push(value);
            }
        }
        self.values[id.0 as usize]
    }

    fn joined_value(&self, op: Op, joined: &mut Joined) -> Id {
        let op = match op {
            Op::Input(i) => {
                let cell = self.cell(i);
                if let Some(known) = joined.cells.get(&cell) {
                    return *known;
                }
                Op::Input(cell)
            }
            Op::Memory(i) => {
                let number = self.unit.d.start + i;
                if let Some(known) = joined.settled.get(&number) {
                    return *known;
                }
                Op::Memory(number)
            }
            Op::State(i) => Op::State(self.unit.x.start + i),
            op => op.map(|operand| self.values[operand.0 as usize]),
        };
        joined.push(op)
    }
}
