//! Unknowns and equations of a steady state.

use std::ops::Range;

use blocksim_block::Context;
use blocksim_block::schedule::{Schedule, Steady, Step, When};
use blocksim_linear::DMatrix;
use blocksim_solve::Failed;

use crate::evaluation::evaluate::Diagram;
use crate::program::spread::spread;
use crate::variation::chain::{Chain, Direction, Origin};
use crate::{SimError, Simulation, state_names};

/// Rounds in which jumps of states may settle.
const ROUNDS: usize = 100;

/// Rate at which memories follow their input where the model is let go, 1/s.
const FAST: f64 = 1e3;

/// A sampled block whose next sample is to change nothing.
struct Sampled {
    block: usize,
    d: Range<usize>,
    /// First of its unknowns, which are as many as equations.
    at: usize,
}

/// A block whose outputs follow from its inputs once it has rested.
struct Memory {
    block: usize,
    d: Range<usize>,
    /// Cells of its outputs, which are unknown.
    y: Range<usize>,
    at: usize,
    /// Its calls among those of a major pass.
    calls: Vec<usize>,
}

/// Modes, memories, signals, and which solutions algebraic loops have.
pub(super) struct Kept {
    d: Vec<f64>,
    signals: Vec<f64>,
    anchors: Vec<f64>,
}

/// The equations: states, samples and memories have one for each unknown, in the same order; then come held signals. The
/// unknowns of the constants that are free stand at the end.
pub(super) struct Conditions<'s> {
    pub simulation: &'s mut Simulation,
    /// Which calls of a major pass are evaluated.
    asked: Vec<bool>,
    sampled: Vec<Sampled>,
    memories: Vec<Memory>,
    free: Vec<usize>,
    hold: Vec<(usize, f64)>,
    /// Rates, 1/s, at which the first unknowns follow their equations; 0 for equations that hold at once.
    pub rates: Vec<f64>,
    /// Names of the unknowns.
    pub names: Vec<String>,
    /// Size of each unknown where it is nearly zero: 1, or what is typical of a state if that is more, as of a pressure in Pa.
    least: Vec<f64>,
    /// Unknowns that may go on moving if nothing depends on them.
    pub may_drift: Vec<bool>,
    /// Those of which blocks say so.
    pub drifts: Vec<bool>,
    /// Unknowns that stay as they are, whatever their equations say.
    pub fixed: Vec<bool>,
    signals: Vec<f64>,
    d: Vec<f64>,
    spare: Vec<f64>,
    /// Evaluations of the model so far.
    pub evaluations: usize,
    chain: Chain,
    direction: Direction,
}

impl<'s> Conditions<'s> {
    pub fn new(simulation: &'s mut Simulation, asked: &Steady, strict: bool) -> Self {
        let schedule = std::sync::Arc::clone(&simulation.schedule);
        let n = schedule.states;
        let mut names = state_names(&schedule);
        let mut rates = vec![1.0; n];
        let mut drifts = vec![false; n];
        let mut least = vec![1.0; n];
        for block in &schedule.blocks {
            block.interface.drifting.iter().for_each(|state| drifts[block.x + state] = true);
            for (state, least) in block.interface.states.iter().zip(&mut least[block.x..]) {
                *least = state.nominal.unwrap_or(1.0).max(1.0);
            }
        }
        let mut may_drift: Vec<bool> = drifts.iter().map(|drifts| *drifts || !strict).collect();
        let memories = memories(&schedule, &mut simulation.diagram);
        let is_memory = |block: usize| memories.iter().any(|memory| memory.block == block);
        let mut sampled = Vec::new();
        for updated in &simulation.diagram.plan.updated {
            let instance = &schedule.blocks[updated.block];
            // What a network integrates by itself between edges has no rest.
            if is_memory(updated.block) || !instance.parts.is_empty() {
                continue;
            }
            let d = simulation.diagram.plan.units[updated.block].d.range();
            sampled.push(Sampled { block: updated.block, d: d.clone(), at: names.len() });
            let clock = &schedule.clock;
            rates.extend(d.map(|_| 1.0 / clock.time(clock.rates[updated.rate].period)));
            let own = instance.interface.discrete.iter();
            names.extend(own.map(|state| format!("{}.{}", instance.path, state.name())));
        }
        let mut memories = memories;
        for memory in &mut memories {
            memory.at = names.len();
            let path = &schedule.blocks[memory.block].path;
            names.extend(memory.y.clone().map(|_| path.clone()));
            rates.extend(memory.y.clone().map(|_| FAST));
        }
        may_drift.resize(names.len(), !strict);
        drifts.resize(names.len(), false);
        let mut fixed = vec![false; names.len()];
        for (name, fixed) in names.iter().zip(&mut fixed) {
            *fixed = asked.drift.iter().any(|owner| is_part_of(name, owner));
        }
        names.extend(asked.free.iter().map(|free| free.name.clone()));
        fixed.resize(names.len(), false);
        least.resize(names.len(), 1.0);
        let free: Vec<usize> = asked.free.iter().map(|free| free.cell).collect();
        rates.extend(asked.hold.iter().map(|_| 0.0));
        let given: Vec<usize> = memories.iter().flat_map(|memory| memory.calls.iter().copied()).collect();
        let asked_calls = calls(&schedule, &free, &given);
        let diagram = &simulation.diagram;
        let mut chain = Chain::new(diagram, &asked_calls, &[]);
        sampled.iter().for_each(|own| chain.add_update(diagram, own.block));
        memories.iter().for_each(|own| chain.add_rest(diagram, own.block, &own.calls));
        Self {
            evaluations: 0,
            direction: Direction::none(diagram, 0),
            chain,
            asked: asked_calls,
            sampled,
            memories,
            hold: asked.hold.iter().map(|held| (held.cell, held.value)).collect(),
            free,
            rates,
            names,
            least,
            may_drift,
            drifts,
            fixed,
            signals: simulation.diagram.signals.clone(),
            d: simulation.diagram.d.clone(),
            spare: simulation.diagram.d.clone(),
            simulation,
        }
    }

    /// Number of continuous states, which are the first unknowns.
    pub fn states(&self) -> usize {
        self.simulation.schedule.states
    }

    /// Number of equations.
    pub fn equations(&self) -> usize {
        self.rates.len()
    }

    /// Number of those that belong to an unknown each.
    pub fn paired(&self) -> usize {
        self.rates.len() - self.hold.len()
    }

    /// The unknowns as they are.
    pub fn present(&self) -> Vec<f64> {
        let diagram = &self.simulation.diagram;
        let mut z = self.simulation.x.clone();
        z.extend(self.sampled.iter().flat_map(|sampled| &diagram.d[sampled.d.clone()]));
        z.extend(self.memories.iter().flat_map(|memory| &diagram.signals[memory.y.clone()]));
        z.extend(self.free.iter().map(|&cell| diagram.signals[cell]));
        z
    }

    /// Sizes of the unknowns at `z`.
    pub fn sizes(&self, z: &[f64]) -> Vec<f64> {
        z.iter().zip(&self.least).map(|(z, least)| z.abs().max(*least)).collect()
    }

    /// What the equations leave over at `z`.
    pub fn evaluate(&mut self, z: &[f64], rest: &mut [f64]) -> Result<(), SimError> {
        self.evaluations += 1;
        let evaluated = self.residual(z, rest);
        self.simulation.held(evaluated)
    }

    /// Slopes of the equations at the point of the last evaluation, where they follow from laws or from differences of single
    /// blocks. Returns the unknowns over which they do not; what is fixed has none.
    pub fn slopes(&mut self, matrix: &mut DMatrix<f64>) -> Vec<usize> {
        let Self { simulation, sampled, memories, free, hold, chain, direction, fixed, .. } = self;
        let diagram = &mut simulation.diagram;
        let n = diagram.schedule.states;
        let given = memories.iter().flat_map(|own| own.y.clone());
        let moving: Vec<usize> = given.chain(free.iter().copied()).collect();
        let varies: Vec<Range<usize>> = sampled.iter().map(|own| own.d.clone()).collect();
        chain.fix(diagram, &moving, &varies);
        let (rows, columns) = matrix.shape();
        let first_memory = memories.first().map_or(columns - free.len(), |own| own.at);
        let mut dx = vec![0.0; n];
        let mut unknown = Vec::new();
        for column in (0..columns).filter(|&column| !fixed[column]) {
            direction.x.fill(0.0);
            direction.d.fill(0.0);
            direction.cells.clear();
            if column < n {
                direction.x[column] = 1.0;
            } else if column < first_memory {
                let own = sampled.iter().rfind(|own| own.at <= column);
                own.into_iter().for_each(|own| direction.d[own.d.start + column - own.at] = 1.0);
            } else {
                direction.cells.push((moving[column - first_memory], 1.0));
            }
            let mut origin = chain.along(diagram, direction, &mut dx);
            let mut slopes = matrix.column_mut(column);
            slopes.fill(0.0);
            slopes.rows_mut(0, n).copy_from_slice(&dx);
            // What is not updated stays: the equation of a discrete state says by how much it changes.
            let row = |d: usize| {
                let own = sampled.iter().find(|own| own.d.contains(&d));
                own.map(|own| own.at + d - own.d.start)
            };
            origin = origin.max(chain.updates(diagram, direction, |d, next| {
                row(d).into_iter().for_each(|row| slopes[row] = next - direction.d[d]);
            }));
            origin = origin.max(chain.rests(diagram, direction, |cell, rested| {
                let own = memories.iter().find(|own| own.y.contains(&cell));
                own.into_iter().for_each(|own| slopes[own.at + cell - own.y.start] = rested);
            }));
            if (first_memory..columns - free.len()).contains(&column) {
                slopes[column] -= 1.0;
            }
            for (row, (cell, _)) in (rows - hold.len()..rows).zip(hold.iter()) {
                slopes[row] = chain.rate(*cell);
            }
            if origin == Origin::Unknown {
                unknown.push(column);
            }
        }
        unknown
    }

    fn residual(&mut self, z: &[f64], rest: &mut [f64]) -> Result<(), Failed> {
        let Self { simulation, asked, sampled, memories, free, hold, signals, d, spare, .. } = self;
        let t = simulation.t;
        let diagram = &mut simulation.diagram;
        let n = simulation.x.len();
        diagram.signals.copy_from_slice(signals);
        diagram.d.copy_from_slice(d);
        for own in sampled.iter() {
            diagram.d[own.d.clone()].copy_from_slice(&z[own.at..own.at + own.d.len()]);
        }
        for own in memories.iter() {
            diagram.signals[own.y.clone()].copy_from_slice(&z[own.at..own.at + own.y.len()]);
        }
        for (&cell, &value) in free.iter().zip(&z[z.len() - free.len()..]) {
            diagram.signals[cell] = value;
        }
        diagram.touched(t, &z[..n], asked, |_, _| {})?;
        diagram.derive(&mut rest[..n])?;
        for own in sampled.iter() {
            let kept = &mut spare[own.d.clone()];
            kept.copy_from_slice(&diagram.d[own.d.clone()]);
            diagram.update_one(own.block)?;
            let next = diagram.d[own.d.clone()].iter().zip(kept.iter());
            rest[own.at..].iter_mut().zip(next).for_each(|(rest, (next, now))| *rest = next - now);
            diagram.d[own.d.clone()].copy_from_slice(kept);
        }
        for own in memories.iter() {
            let given = &z[own.at..own.at + own.y.len()];
            diagram.rest_one(own.block)?;
            own.calls.iter().try_for_each(|&call| diagram.give(call))?;
            let rested = diagram.signals[own.y.clone()].iter().zip(given);
            rest[own.at..].iter_mut().zip(rested).for_each(|(rest, (rested, given))| *rest = rested - given);
            diagram.d[own.d.clone()].copy_from_slice(&d[own.d.clone()]);
            diagram.signals[own.y.clone()].copy_from_slice(given);
        }
        let first = rest.len() - hold.len();
        let held = rest[first..].iter_mut().zip(hold.iter());
        held.for_each(|(rest, (cell, value))| *rest = diagram.signals[*cell] - value);
        Ok(())
    }

    /// Goes to `z` and lets all blocks choose their modes anew and jump, which may change `z`. Returns whether anything has
    /// changed.
    pub fn settle(&mut self, z: &mut Vec<f64>) -> Result<bool, SimError> {
        let mut unused = vec![0.0; self.equations()];
        self.evaluate(z, &mut unused)?;
        let settled = self.choose(z);
        let changed = self.simulation.held(settled)?;
        self.signals.copy_from_slice(&self.simulation.diagram.signals);
        self.d.copy_from_slice(&self.simulation.diagram.d);
        if changed {
            let free = z.split_off(z.len() - self.free.len());
            *z = self.present();
            z.truncate(z.len() - free.len());
            z.extend(free);
        }
        Ok(changed)
    }

    fn choose(&mut self, z: &[f64]) -> Result<bool, Failed> {
        let Self { simulation, memories, .. } = self;
        let n = simulation.x.len();
        simulation.x.copy_from_slice(&z[..n]);
        let all = vec![true; simulation.hits.due.len()];
        let Simulation { diagram, x, t, .. } = &mut **simulation;
        for own in memories.iter() {
            diagram.rest_one(own.block)?;
        }
        diagram.settle.changed = false;
        diagram.major(*t, x, &all, false)?;
        let mut changed = diagram.settle.changed;
        for _ in 0..ROUNDS {
            let mut jumped = false;
            diagram.jump(x, |_| jumped = true)?;
            if !jumped {
                break;
            }
            changed = true;
            diagram.major(*t, x, &all, false)?;
        }
        Ok(changed)
    }

    /// What a search chooses on its way, to come back to.
    pub fn keep(&self) -> Kept {
        let anchors = self.simulation.diagram.loops.anchors.clone();
        Kept { d: self.d.clone(), signals: self.signals.clone(), anchors }
    }

    /// Comes back to it.
    pub fn recall(&mut self, kept: &Kept) {
        self.d.clone_from(&kept.d);
        self.signals.clone_from(&kept.signals);
        self.simulation.diagram.loops.anchors.clone_from(&kept.anchors);
    }

    /// Values of the free constants.
    pub fn found(&self, z: &[f64]) -> Vec<f64> {
        z[z.len() - self.free.len()..].to_vec()
    }
}

/// Whether a state is the one of this name, or belongs to the block of this name.
fn is_part_of(state: &str, name: &str) -> bool {
    state.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// Blocks that can rest.
fn memories(schedule: &Schedule, diagram: &mut Diagram) -> Vec<Memory> {
    let mut found = Vec::new();
    for block in 0..schedule.blocks.len() {
        let unit = &diagram.plan.units[block];
        let (d, y) = (unit.d.range(), unit.y.range());
        if d.is_empty() || y.is_empty() {
            continue;
        }
        let kept = diagram.d[d.clone()].to_vec();
        let rests = diagram.rest_one(block).unwrap_or(false);
        diagram.d[d.clone()].copy_from_slice(&kept);
        if rests {
            let steps = schedule.steps.iter().enumerate();
            let calls =
                steps.filter(|(_, step)| step.block as usize == block).map(|(call, _)| call).collect();
            found.push(Memory { block, d, y, at: 0, calls });
        }
    }
    found
}

/// Which calls are evaluated: all but those of constants that stay, and those whose outputs are `given`.
fn calls(schedule: &Schedule, free: &[usize], given: &[usize]) -> Vec<bool> {
    let mut touched = vec![false; schedule.initial_signals.len()];
    free.iter().for_each(|&cell| touched[cell] = true);
    let read = spread(schedule, &mut touched, |_, read| read);
    let asked =
        |(call, step): (usize, &Step)| (step.when != When::Constant || read[call]) && !given.contains(&call);
    schedule.steps.iter().enumerate().map(asked).collect()
}

impl Diagram {
    /// Advances the discrete states of one block.
    fn update_one(&mut self, block: usize) -> Result<(), Failed> {
        self.change(block, |block, c, w, d| block.update(c, w, d))
    }

    /// Fills the memory of one block with its inputs; returns whether it has one.
    fn rest_one(&mut self, block: usize) -> Result<bool, Failed> {
        let mut rests = false;
        let Self { plan, now, signals, d, .. } = self;
        let unit = &plan.units[block];
        now.evaluation += 1;
        let c: Context = now.context(unit, signals, &[]);
        rests |= unit.block.rest(&c, &mut d[unit.d.range()]);
        self.checked(block)?;
        Ok(rests)
    }
}
