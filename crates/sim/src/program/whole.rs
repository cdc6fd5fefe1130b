//! Steps of a method of fixed step that the diagram makes by itself, where all derivatives are data and nobody looks between the ends
//! of steps: what the method does for any system costs more than the derivatives of most of them. The method makes a step once more
//! where something is not as it should be.

use blocksim_block::law::{Draft, Id, Instruction, Op, Program, Tape};
use blocksim_block::schedule::OutputTimes;
use blocksim_solve::Weights;

use crate::evaluation::evaluate::Diagram;
use crate::program::direct::{Direct, DirectDraft};
use crate::program::fused::{Laws, Layout};
use crate::program::stages::{self, Derive, Stages};
use crate::stepping::methods;

/// Numbers that say how long a step is: its size and its end, as the parameters of the program.
pub(crate) const SIZES: usize = 2;

/// Most instructions of a step that is one program.
const MOST: usize = 5_000;

/// How steps are made.
#[derive(Debug)]
pub(crate) struct Whole {
    /// When each stage is, as a part of the step.
    nodes: &'static [f64],
    stages: Stages,
    /// All stages and what is added up between them as one program, for machine code: the interpreter takes longer for sums.
    pub tape: Tape,
    /// The cells in which it leaves the states at the end; none if it would be too long.
    ends: Vec<u32>,
    /// First cell of its size and its end.
    sizes: usize,
}

/// The same, before it has a tape.
#[derive(Debug)]
pub(crate) struct WholeDraft {
    pub weights: Weights,
    pub draft: Draft,
}

impl Whole {
    /// Steps over the derivatives `direct`, whose program is `tape`; that leaves the states in `ends` and finds the sizes of the step in
    /// the cells from `sizes` on. `time` is the cell of the time.
    pub fn new(
        (tape, ends): (Tape, Vec<u32>),
        (sizes, time): (usize, usize),
        weights: Weights,
        direct: &Direct,
    ) -> Self {
        let stages = Stages::new(weights, direct.derivatives(), time as u32);
        Self { nodes: weights.nodes, stages, tape, ends, sizes }
    }
}

impl Laws<'_> {
    /// How the diagram makes the steps of its method by itself, if it can.
    pub fn whole(&self, direct: &DirectDraft) -> Option<WholeDraft> {
        let settings = &self.schedule.settings;
        let weights = methods::weights(settings.solver)?;
        if !self.plan.plain || settings.output != OutputTimes::Steps || weights.nodes.len() > stages::MOST {
            return None;
        }
        let states = self.schedule.states;
        let program = &direct.draft.program;
        let sums = weights.stages.iter().map(|row| row.len()).sum::<usize>() + weights.result.len();
        let length = weights.nodes.len() * program.instructions.len() + 2 * sums * states;
        let draft =
            if length > MOST { Draft::default() } else { step(program, &direct.derivatives()?, weights) };
        Some(WholeDraft { weights, draft })
    }
}

/// Instructions of a step on their way.
#[derive(Default)]
struct Step {
    program: Program,
}

impl Step {
    fn push(&mut self, op: Op) -> Id {
        self.program.instructions.push(Instruction { op, place: None, block: None });
        Id(self.program.instructions.len() as u32 - 1)
    }

    /// `from + (h weights[0]) k[0] + (h weights[1]) k[1] + ...` of each state.
    fn sums(&mut self, from: &[Id], h: Id, weights: &[f64], k: &[Vec<Id>]) -> Vec<Id> {
        let zeros = weights.iter().take_while(|weight| **weight == 0.0).count();
        let (weights, k) = (&weights[zeros..], &k[zeros..]);
        let weights: Vec<Id> = weights
            .iter()
            .map(|weight| {
                let weight = self.push(Op::constant(*weight));
                self.push(Op::Mul(h, weight))
            })
            .collect();
        let sum = |(i, from): (usize, &Id)| {
            weights.iter().zip(k).fold(*from, |sum, (weight, k)| {
                let product = self.push(Op::Mul(*weight, k[i]));
                self.push(Op::Add(sum, product))
            })
        };
        from.iter().enumerate().map(sum).collect()
    }

    /// The values of a program at another time and in other states.
    fn copy(&mut self, program: &Program, t: Id, x: &[Id]) -> Vec<Id> {
        let mut ids: Vec<Id> = Vec::with_capacity(program.instructions.len());
        for instruction in &program.instructions {
            let id = match instruction.op {
                Op::Time => t,
                Op::State(i) => x[i as usize],
                op => self.push(op.map(|id| ids[id.0 as usize])),
            };
            ids.push(id);
        }
        ids
    }
}

/// The program of a step whose derivatives are values of a program. What that requires is required at all stages.
fn step(program: &Program, derivatives: &[Id], weights: Weights) -> Draft {
    let mut step = Step::default();
    let [h, end, begin] = [Op::Parameter(0), Op::Parameter(1), Op::Time].map(|op| step.push(op));
    let from: Vec<Id> = (0..derivatives.len() as u32).map(|i| step.push(Op::State(i))).collect();
    let mut k: Vec<Vec<Id>> = Vec::new();
    let mut requirements = Vec::new();
    for (node, row) in weights.nodes.iter().zip(weights.stages) {
        let x = step.sums(&from, h, row, &k);
        let t = if *node == 1.0 {
            end
        } else {
            let node = step.push(Op::constant(*node));
            let after = step.push(Op::Mul(node, h));
            step.push(Op::Add(begin, after))
        };
        let ids = step.copy(program, t, &x);
        k.push(derivatives.iter().map(|id| ids[id.0 as usize]).collect());
        requirements.extend(program.requirements.iter().map(|id| ids[id.0 as usize]));
    }
    let ends = step.sums(&from, h, weights.result, &k);
    step.program.outputs = ends.into_iter().map(|id| (String::new(), id)).collect();
    step.program.requirements = requirements;
    Draft::of(&step.program)
}

impl Diagram {
    /// Makes a step if it can: the states at its end come to `x`, and the signals stay those of the point before. Returns whether that
    /// was possible, and all of it finite.
    pub fn step_wholly(&mut self, t: f64, t1: f64, h: f64, x: &mut [f64]) -> bool {
        self.plan.fused.place(t, x, &mut self.signals);
        self.step_on(t, t1, h, x)
    }

    /// The same where time and states are in their places already.
    #[inline]
    pub fn step_on(&mut self, t: f64, t1: f64, h: f64, x: &mut [f64]) -> bool {
        let Self { plan, signals, d, .. } = self;
        let (fused, signals, d) = (&mut plan.fused, &mut signals[..], &mut d[..]);
        let Some(whole) = &mut fused.whole else { return false };
        if whole.tape.has_machine() {
            signals[whole.sizes..whole.sizes + SIZES].copy_from_slice(&[h, t1]);
            let met = whole.tape.run(signals, d).failed.is_none();
            let ends = whole.ends.iter().map(|cell| signals[*cell as usize]);
            // What is not finite at any stage is not so at the end either, as all of them are added.
            let is_done = met && ends.clone().all(f64::is_finite);
            if is_done {
                x.iter_mut().zip(ends).for_each(|(x, end)| *x = end);
            }
            return is_done;
        }
        let Some(direct) = &fused.direct else { return false };
        let (nodes, layout) = (whole.nodes, &fused.layout);
        whole.stages.step(h, x, Directly { direct, layout, nodes, t, t1, h, signals, d })
    }
}

/// Derivatives by the tape that knows them from time and states.
struct Directly<'d> {
    direct: &'d Direct,
    layout: &'d Layout,
    nodes: &'static [f64],
    t: f64,
    t1: f64,
    h: f64,
    signals: &'d mut [f64],
    d: &'d mut [f64],
}

impl Derive for Directly<'_> {
    #[inline(always)]
    fn place<'f>(&mut self, stage: usize, states: impl Iterator<Item = &'f [f64; 4]>) {
        let (time, places) = self.layout.point(self.signals);
        let node = self.nodes[stage];
        *time = if node == 1.0 { self.t1 } else { self.t + node * self.h };
        places.as_chunks_mut::<4>().0.iter_mut().zip(states).for_each(|(place, states)| *place = *states);
    }

    #[inline(always)]
    fn signals(&mut self) -> Option<&[f64]> {
        self.direct.meets(self.signals, self.d).then_some(&*self.signals)
    }
}
