//! Which derivatives a state can act on between major steps, as blocks and connections say.
//!
//! The output of a group depends on the states of its block and on what the inputs that it reads depend on; a derivative
//! depends on the states of its block and on all of its inputs. What is held between major steps depends on nothing. A block
//! counts as one: of a network, or of the elements of a vector, nobody knows more from here.

use blocksim_block::schedule::{Instance, Schedule};
use blocksim_solve::Failed;

use crate::diagnose::{failed, state_names};
use crate::evaluation::evaluate::Diagram;
use crate::{SimError, Simulation};

/// Dependencies that are kept track of, at most.
const MOST: usize = 1 << 22;
/// Part of all states that may act on all derivatives above which nobody gains by knowing them.
const CROWDED: f64 = 0.25;
/// Fewer states than this are always worth it.
const FEW: usize = 24;
/// What is written by nobody between major steps.
const NOBODY: u32 = u32::MAX;

/// Of each state the derivatives that may depend on it, rising; nothing where these are too many to be worth it.
pub(crate) fn influence(schedule: &Schedule) -> Option<Vec<Vec<usize>>> {
    let n = schedule.states;
    let most = if n <= FEW { n * n } else { MOST.min((CROWDED * (n * n) as f64) as usize) };
    columns(schedule, most)
}

/// Of each state the derivatives that may depend on it, rising; nothing where these are more than `most`, or sets too large on the way.
fn columns(schedule: &Schedule, most: usize) -> Option<Vec<Vec<usize>>> {
    let mut sets = Sets::new(schedule);
    let mut next = 0;
    while next < schedule.steps.len() {
        // Of an algebraic loop each output depends on whatever one of them does.
        let ring = schedule.loops.iter().find(|ring| ring.first == next);
        let end = next + ring.map_or(1, |ring| ring.count);
        let mut all = Vec::new();
        for step in (next..end).filter(|&step| is_minor(schedule, step)) {
            sets.add_outputs(step, next, &mut all);
        }
        let (set, size) = sets.close(all);
        for step in (next..end).filter(|&step| is_minor(schedule, step)) {
            sets.of[step] = set;
        }
        if size > most.max(MOST) {
            return None;
        }
        next = end;
    }
    let mut columns = vec![Vec::new(); schedule.states];
    let mut count = 0;
    for instance in schedule.blocks.iter().filter(|block| !block.interface.states.is_empty()) {
        let states = own_states(instance);
        let mut all: Vec<u32> = states.clone().collect();
        let inputs = instance.gather.iter().flat_map(|&(from, len)| from as usize..(from + len) as usize);
        sets.add_cells(inputs, usize::MAX, &mut all);
        all.sort_unstable();
        all.dedup();
        count += all.len() * states.len();
        if count > most {
            return None;
        }
        for row in states {
            all.iter().for_each(|&state| columns[state as usize].push(row as usize));
        }
    }
    Some(columns)
}

/// A derivative that depends on a state, although blocks and connections say that it does not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Undeclared {
    /// Path and name of the state whose derivative it is.
    pub derivative: String,
    /// Path and name of the state that it depends on.
    pub state: String,
}

/// By how much a state is varied, as a part of its magnitude, or in its unit where it is small.
const VARIED: f64 = 1e-3;
/// Part of a derivative by which it may change where nothing that it depends on has: iterations begin where the last ones ended.
const ITERATED: f64 = 1e-6;

impl Simulation {
    /// Varies each continuous state at the present time and sees which derivatives change that should not: whoever declares too little
    /// makes entries of Jacobians that are zero for ever, and values that are out of date. It takes two evaluations for each
    /// state, and a run may go on behind it with other last digits.
    ///
    /// # Errors
    /// If the diagram cannot be evaluated at the present time. States whose variation leaves the domain of a function are passed over.
    pub fn undeclared(&mut self) -> Result<Vec<Undeclared>, SimError> {
        let pairs = self.diagram.undeclared(self.t, &self.x);
        let pairs = pairs.map_err(|_| failed(&self.schedule, &mut self.diagram))?;
        let names = state_names(&self.schedule);
        let named =
            |(i, j): (usize, usize)| Undeclared { derivative: names[i].clone(), state: names[j].clone() };
        Ok(pairs.into_iter().map(named).collect())
    }
}

impl Diagram {
    /// Derivatives, and states that they depend on without saying so.
    fn undeclared(&mut self, t: f64, x: &[f64]) -> Result<Vec<(usize, usize)>, Failed> {
        let n = x.len();
        let Some(columns) = columns(&self.schedule, usize::MAX) else { return Ok(Vec::new()) };
        let (mut at, mut before, mut dx) = (x.to_vec(), vec![0.0; n], vec![0.0; n]);
        let mut found = Vec::new();
        self.derivatives_anew(t, x, &mut before)?;
        for (j, declared) in columns.iter().enumerate() {
            at[j] = x[j] + VARIED * x[j].abs().max(1.0);
            let evaluated = self.derivatives_anew(t, &at, &mut dx);
            at[j] = x[j];
            if evaluated.is_err() {
                self.failure = None;
                continue;
            }
            let changed =
                |&i: &usize| (dx[i] - before[i]).abs() > ITERATED * dx[i].abs().max(before[i].abs());
            let undeclared = (0..n).filter(changed).filter(|i| declared.binary_search(i).is_err());
            found.extend(undeclared.map(|i| (i, j)));
        }
        self.derivatives_anew(t, x, &mut dx)?;
        Ok(found)
    }

    /// Derivatives, evaluated twice: who reads too early sees the second time what was written in the first.
    fn derivatives_anew(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failed> {
        for _ in 0..2 {
            self.forget();
            self.minor(t, x)?;
            self.derive(dx)?;
        }
        Ok(())
    }
}

fn is_minor(schedule: &Schedule, step: usize) -> bool {
    schedule.steps[step].minor
}

fn own_states(instance: &Instance) -> std::ops::Range<u32> {
    instance.x as u32..(instance.x + instance.interface.states.len()) as u32
}

/// The states that the outputs of each step depend on.
struct Sets<'a> {
    schedule: &'a Schedule,
    /// The step that writes each signal between major steps.
    writer: Vec<u32>,
    /// Sets of states, one behind the other, rising.
    states: Vec<u32>,
    /// Where the set of each step is.
    of: Vec<(usize, usize)>,
}

impl<'a> Sets<'a> {
    fn new(schedule: &'a Schedule) -> Self {
        let mut writer = vec![NOBODY; schedule.initial_signals.len()];
        for (number, step) in schedule.steps.iter().enumerate().filter(|(i, _)| is_minor(schedule, *i)) {
            let instance = &schedule.blocks[step.block as usize];
            instance.written(step.group as usize).for_each(|cell| writer[cell] = number as u32);
            // The rest of a constraint lies where its unknowns do.
            if let Some(constraint) = &instance.interface.constraint
                && constraint.rest == step.group as usize
            {
                constraint.unknowns.iter().for_each(|(cell, _)| writer[instance.y + cell] = number as u32);
            }
        }
        Self { schedule, writer, states: Vec::new(), of: vec![(0, 0); schedule.steps.len()] }
    }

    /// Adds what the outputs of a step depend on, but for what steps from `first` on write.
    fn add_outputs(&self, step: usize, first: usize, all: &mut Vec<u32>) {
        let step = &self.schedule.steps[step];
        let instance = &self.schedule.blocks[step.block as usize];
        all.extend(own_states(instance));
        self.add_cells(instance.read(step.group as usize), first, all);
    }

    /// Adds what cells among the signals depend on, but for what steps from `first` on write.
    fn add_cells(&self, cells: impl Iterator<Item = usize>, first: usize, all: &mut Vec<u32>) {
        let mut last = NOBODY;
        for cell in cells {
            let writer = self.writer[cell];
            if writer != last && writer != NOBODY && (writer as usize) < first {
                let (start, end) = self.of[writer as usize];
                all.extend_from_slice(&self.states[start..end]);
            }
            last = writer;
        }
    }

    /// Keeps a set; returns where it is, and the size of all.
    fn close(&mut self, mut all: Vec<u32>) -> ((usize, usize), usize) {
        all.sort_unstable();
        all.dedup();
        let start = self.states.len();
        self.states.append(&mut all);
        ((start, self.states.len()), self.states.len())
    }
}
