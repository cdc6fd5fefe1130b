//! Laws that are data, run as one: the blocks of a pass that follow each other and record their laws become a tape over the
//! cells of the signals, in which what they have in common is computed once and nothing is called.
//!
//! Each tape leaves the bits in every cell that its blocks would have left there one by one, so who reads signals need not know.
//! Where a requirement of a law is not met, the pass is done again block by block, which finds out whose it is.

use std::ops::Range;

use blocksim_block::law::{BlockLaw, Draft, Joined, Placed};
use blocksim_block::schedule::{Schedule, When};
use blocksim_law::passes::Map;
use blocksim_law::{Id, Leaf, Met, Op, Program, Tape};

use crate::evaluation::loops::{self, Form};
use crate::program::direct::Direct;
use crate::program::plan::{Call, Plan, Settles, Unit};
use crate::program::whole::{SIZES, Whole};

/// The tapes of a diagram.
#[derive(Debug, Default)]
pub(crate) struct Fused {
    pub major: Vec<Part>,
    pub continuous: Vec<Part>,
    pub minor: Vec<Part>,
    pub rows: Vec<Part>,
    /// The part of the major pass that plain steps need, where that is less; see `plain.rs`.
    pub plain: Option<Tape>,
    pub derivatives: Gathered,
    pub guards: Gathered,
    /// Derivatives, and guards where anybody looks, without the signals between, where all that these depend on is data.
    pub direct: Option<Direct>,
    /// How steps of a method of fixed step are made.
    pub whole: Option<Whole>,
    /// Exact slopes of the derivatives, where all that these depend on is data.
    pub slopes: Option<Slopes>,
    /// The algebraic loops, where all of their blocks record their laws.
    pub loops: Vec<Option<LoopTapes>>,
    pub layout: Layout,
}

/// A part of a pass.
#[derive(Debug)]
pub(crate) enum Part {
    /// Calls one after the other, by their number in the pass.
    Calls(Range<usize>),
    /// The tape of calls that are due at the same times, and their numbers in the pass.
    Tape(Tape, Range<usize>, When),
}

impl Part {
    fn tape(&self) -> Option<&Tape> {
        if let Part::Tape(tape, ..) = self { Some(tape) } else { None }
    }

    fn tape_mut(&mut self) -> Option<&mut Tape> {
        if let Part::Tape(tape, ..) = self { Some(tape) } else { None }
    }
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

/// An algebraic loop.
#[derive(Debug)]
pub(crate) struct LoopTapes {
    /// What its steps write, unless they are called.
    pub values: Option<Tape>,
    slopes: Gathered,
    /// First cell of the direction along which slopes are, if they are not all at once.
    direction: Option<usize>,
    pub form: Form,
}

/// Where tapes find what is no signal: behind the signals, among whose cells they work.
#[derive(Debug, Default)]
pub(crate) struct Layout {
    states: usize,
    time: usize,
    /// A direction in the space of the states, or the sizes of a step.
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
        let laws = Laws::new(schedule, plan);
        let mut drafts = Vec::new();
        let mut parts = |calls: &[Call], major: bool| -> Vec<Part> {
            let joined = laws.parts(calls, major).into_iter().map(|(calls, joined)| match joined {
                Some((draft, when)) => {
                    drafts.push(draft);
                    Part::Tape(Tape::default(), calls, when)
                }
                None => Part::Calls(calls),
            });
            joined.collect()
        };
        let mut fused = Self {
            major: parts(&plan.major, true),
            continuous: parts(&plan.continuous, false),
            minor: parts(&plan.minor, false),
            rows: plan.rows.as_ref().map(|rows| parts(rows, false)).unwrap_or_default(),
            ..Self::default()
        };
        let (derivatives, guards, slopes) = (laws.derivatives(), laws.guards(), laws.slopes());
        let (direct, plain) = (laws.direct(), laws.plain());
        let whole = direct.as_ref().and_then(|direct| laws.whole(direct));
        // Where anything lies depends on the constants of all.
        let gathered = [&derivatives.0, &guards.0].into_iter().chain(&slopes);
        let rings: Vec<Option<loops::Drafts>> =
            schedule.loops.iter().map(|found| loops::Drafts::new(schedule, found)).collect();
        let of_rings = rings.iter().flatten().flat_map(|ring| [&ring.values, &ring.slopes]);
        let of_steps = direct.iter().map(|direct| &direct.draft).chain(&plain);
        let of_steps = of_steps.chain(whole.iter().map(|whole| &whole.draft));
        let all = drafts.iter().chain(gathered).chain(of_steps).chain(of_rings).map(|draft| &draft.program);
        let mut layout = Layout::new(schedule, all);
        let lists = [&mut fused.major, &mut fused.continuous, &mut fused.minor, &mut fused.rows];
        lists
            .into_iter()
            .flatten()
            .filter_map(Part::tape_mut)
            .zip(&drafts)
            .for_each(|(tape, draft)| *tape = layout.made(draft).0);
        fused.derivatives = layout.gathered(derivatives);
        fused.guards = layout.gathered(guards);
        fused.plain = plain.map(|draft| layout.made(&draft).0);
        fused.direct = direct.map(|direct| {
            let (tape, cells) = layout.made(&direct.draft);
            Direct::new(tape, &cells, &direct)
        });
        fused.whole = whole.zip(fused.direct.as_ref()).map(|(whole, direct)| {
            let made = layout.made(&whole.draft);
            Whole::new(made, (layout.direction, layout.time), whole.weights, direct)
        });
        fused.slopes = slopes.map(|draft| {
            let to = (0..schedule.states as u32).collect();
            Slopes { rates: layout.gathered((draft, to, Vec::new())), direction: layout.direction }
        });
        let sizes = schedule.loops.iter().map(|found| found.cells.len());
        let made =
            rings.into_iter().zip(sizes).map(|(drafts, n)| drafts.map(|drafts| layout.ring(drafts, n)));
        fused.loops = made.collect();
        fused.layout = layout;
        fused
    }

    /// No tapes: every block is called. The reference that tapes are held against.
    pub fn one_by_one(schedule: &Schedule, plan: &Plan) -> Self {
        let all = |calls: &[Call]| vec![Part::Calls(0..calls.len())];
        let called = |called: &[usize]| Gathered { called: called.to_vec(), ..Gathered::default() };
        // Exact slopes are no matter of how blocks are called.
        let Self { slopes, mut loops, layout, .. } = Self::new(schedule, plan);
        loops.iter_mut().flatten().for_each(|ring| ring.values = None);
        Self {
            major: all(&plan.major),
            continuous: all(&plan.continuous),
            minor: all(&plan.minor),
            rows: plan.rows.as_deref().map(all).unwrap_or_default(),
            derivatives: called(&plan.with_states),
            guards: called(&plan.guarded),
            plain: None,
            direct: None,
            whole: None,
            slopes,
            loops,
            layout,
        }
    }

    /// All tapes.
    pub fn tapes(&self) -> impl Iterator<Item = &Tape> {
        let parts = [&self.major, &self.continuous, &self.minor, &self.rows].into_iter().flatten();
        let steps = self.direct.iter().map(Direct::tape).chain(&self.plain);
        let steps = steps.chain(self.whole.iter().map(|whole| &whole.tape));
        let slopes = self.slopes.iter().map(|slopes| &slopes.rates.tape);
        let loops = self.loops.iter().flatten();
        let loops = loops.flat_map(|ring| ring.values.iter().chain([&ring.slopes.tape]));
        let gathered = [&self.derivatives.tape, &self.guards.tape];
        parts.filter_map(Part::tape).chain(gathered).chain(steps).chain(slopes).chain(loops)
    }

    /// The tapes that are run often: [all](Self::tapes) but those in whose place another one is run wherever it can be, and exact slopes
    /// unless the method asks for them.
    pub fn busy_tapes(&self, takes_slopes: bool) -> impl Iterator<Item = &Tape> {
        let idle = [
            self.direct.is_some().then_some(&self.derivatives.tape),
            self.slopes.as_ref().filter(|_| !takes_slopes).map(|slopes| &slopes.rates.tape),
        ];
        self.tapes().filter(move |tape| !idle.iter().flatten().any(|idle| std::ptr::eq(*idle, *tape)))
    }

    /// All tapes, for what is to run in their place.
    pub fn tapes_mut(&mut self) -> impl Iterator<Item = &mut Tape> {
        let Self {
            major,
            continuous,
            minor,
            rows,
            plain,
            derivatives,
            guards,
            direct,
            whole,
            slopes,
            loops,
            ..
        } = self;
        let parts = [major, continuous, minor, rows].into_iter().flatten();
        let steps = direct.iter_mut().map(Direct::tape_mut).chain(plain);
        let steps = steps.chain(whole.iter_mut().map(|whole| &mut whole.tape));
        let slopes = slopes.iter_mut().map(|slopes| &mut slopes.rates.tape);
        let loops = loops.iter_mut().flatten();
        let loops = loops.flat_map(|ring| ring.values.iter_mut().chain([&mut ring.slopes.tape]));
        let gathered = [&mut derivatives.tape, &mut guards.tape];
        parts.filter_map(Part::tape_mut).chain(gathered).chain(steps).chain(slopes).chain(loops)
    }

    /// Makes room for the tapes behind the signals, and puts constants there.
    pub fn make_room(&self, signals: &mut Vec<f64>) {
        signals.resize((self.layout.end as usize).max(Tape::FEW_CELLS), 0.0);
        for (bits, cell) in &self.layout.constants {
            signals[*cell as usize] = f64::from_bits(*bits);
        }
    }

    /// Puts time and states where tapes find them.
    #[inline]
    pub fn place(&self, t: f64, x: &[f64], signals: &mut [f64]) {
        self.layout.place(t, x, signals);
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

impl LoopTapes {
    /// Writes the slopes of what the loop gives by what it is given, row by row.
    pub fn slopes(&self, n: usize, signals: &mut [f64], d: &mut [f64], rows: &mut [f64], column: &mut [f64]) {
        let Some(first) = self.direction else {
            self.slopes.run(signals, d, rows);
            return;
        };
        for j in 0..n {
            signals[first..first + n].fill(0.0);
            signals[first + j] = 1.0;
            self.slopes.run(signals, d, column);
            (0..n).for_each(|i| rows[i * n + j] = column[i]);
        }
    }
}

impl Layout {
    fn new<'p>(schedule: &Schedule, programs: impl Iterator<Item = &'p Program>) -> Self {
        let states = schedule.initial_signals.len();
        // As many as are written at once.
        let time = states + schedule.states.next_multiple_of(4);
        let direction = time + 1;
        let unknowns = schedule.loops.iter().map(|found| found.cells.len()).max();
        let first = direction + schedule.states.max(unknowns.unwrap_or(0)).max(SIZES);
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

    /// Puts time and states where tapes find them.
    #[inline]
    pub fn place(&self, t: f64, x: &[f64], signals: &mut [f64]) {
        let (time, states) = self.point(signals);
        states[..x.len()].copy_from_slice(x);
        *time = t;
    }

    /// Where tapes find time and states; behind the last state is room for others, up to a multiple of four.
    #[inline]
    pub fn point<'s>(&self, signals: &'s mut [f64]) -> (&'s mut f64, &'s mut [f64]) {
        let (states, time) = signals[self.states..=self.time].split_at_mut(self.time - self.states);
        (&mut time[0], states)
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

    fn ring(&mut self, drafts: loops::Drafts, n: usize) -> LoopTapes {
        let loops::Drafts { values, slopes, along, form } = drafts;
        let count = if along { n } else { n * n };
        LoopTapes {
            values: Some(self.made(&values).0),
            slopes: self.gathered((slopes, (0..count as u32).collect(), Vec::new())),
            direction: along.then_some(self.direction),
            form,
        }
    }

    fn gathered(&mut self, (draft, to, called): (Draft, Vec<u32>, Vec<usize>)) -> Gathered {
        let (tape, places) = self.made(&draft);
        Gathered { tape, copies: places.into_iter().zip(to).collect(), called }
    }
}

/// Calls of a pass that follow each other, with their program and when it is due, unless they are called.
pub(crate) type Stretch = (Range<usize>, Option<(Draft, When)>);

/// The laws of the blocks of a plan.
pub(crate) struct Laws<'p> {
    pub schedule: &'p Schedule,
    pub plan: &'p Plan,
    /// Calls of a major pass that belong to algebraic loops.
    in_ring: Vec<bool>,
}

impl<'p> Laws<'p> {
    pub fn new(schedule: &'p Schedule, plan: &'p Plan) -> Self {
        let mut in_ring = vec![false; plan.major.len()];
        for found in &schedule.loops {
            in_ring[found.first..found.first + found.count].fill(true);
        }
        Self { schedule, plan, in_ring }
    }

    /// The calls of a pass cut into ranges: those that run as one program, with when it is due, and those that are called.
    pub fn parts(&self, calls: &[Call], major: bool) -> Vec<Stretch> {
        let is_free = |call: &Call| !self.in_ring[call.number as usize] && self.is_recorded(call, major);
        let mut parts = Vec::new();
        let mut at = 0;
        while at < calls.len() {
            let first = &calls[at];
            let free = is_free(first);
            let alike = |call: &Call| is_free(call) == free && (!free || call.when == first.when);
            let end = at + calls[at..].iter().take_while(|call| alike(call)).count();
            let joined = free.then(|| (self.pass(&calls[at..end], major), first.when));
            parts.push((at..end, joined));
            at = end;
        }
        parts
    }

    /// The derivatives of all states, and whose blocks have to be called.
    pub fn derivatives(&self) -> (Draft, Vec<u32>, Vec<usize>) {
        self.gathered(&self.plan.with_states, |law| &law.derivatives, |unit| unit.x.range())
    }

    /// The same of the guards.
    pub fn guards(&self) -> (Draft, Vec<u32>, Vec<usize>) {
        self.gathered(&self.plan.guarded, |law| &law.guards, |unit| unit.g.range())
    }

    /// The rates of all derivatives along a direction of the states; nothing unless all that derivatives depend on between major
    /// steps is data.
    pub fn slopes(&self) -> Option<Draft> {
        self.joined_derivatives().map(Joined::rates)
    }

    /// The minor pass and the derivatives of all states as one, if there are any and all of it is data.
    pub fn joined_derivatives(&self) -> Option<Joined> {
        let plan = self.plan;
        let are_laws = plan.with_states.iter().all(|block| self.law(*block).is_some())
            && plan.minor.iter().all(|call| self.is_recorded(call, false));
        if plan.with_states.is_empty() || !self.schedule.loops.is_empty() || !are_laws {
            return None;
        }
        let mut joined = Joined::default();
        for call in &plan.minor {
            let block = call.block as usize;
            joined.call(self.placed(block, self.law(block)?), call.group as usize, false);
        }
        for &block in &plan.with_states {
            let law = self.law(block)?;
            joined.values(self.placed(block, law), &law.derivatives);
        }
        Some(joined)
    }

    pub fn law(&self, block: usize) -> Option<&'p BlockLaw> {
        self.schedule.blocks[block].law.as_deref()
    }

    /// Whether all that a pass wants of a call is recorded.
    pub fn is_recorded(&self, call: &Call, major: bool) -> bool {
        let law = self.law(call.block as usize);
        law.is_some() && !(major && call.settles == Settles::First)
    }

    /// Calls that follow each other. In a major pass modes are chosen before the outputs.
    pub fn pass<'c>(&self, calls: impl IntoIterator<Item = &'c Call>, major: bool) -> Draft {
        let mut joined = Joined::default();
        for call in calls {
            let Some(law) = self.law(call.block as usize) else { continue };
            let settles = major && call.settles == Settles::Own;
            joined.call(self.placed(call.block as usize, law), call.group as usize, settles);
        }
        joined.finish()
    }

    pub fn placed(&self, block: usize, law: &'p BlockLaw) -> Placed<'p> {
        Placed::new(law, block, &self.schedule.blocks[block])
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
            to.extend(place(&self.plan.units[block]).map(|at| at as u32));
            joined.values(self.placed(block, law), written(law));
        }
        (joined.finish(), to, called)
    }
}
