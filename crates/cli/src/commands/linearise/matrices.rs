//! From a frozen simulation to the matrices of a linear system, and what had to be held for it.

use std::collections::BTreeSet;

use blocksim_block::Invariant;
use blocksim_block::schedule::Schedule;
use blocksim_linear::{
    Constrained, DMatrix, Directions, Jacobian, Kink, LinearError, StateSpace, directions, jacobian_over,
};
use blocksim_sim::{Frozen, Origin, SimError, Tap, state_names};

use super::signals::Place;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::running::interrupt;

/// What is asked for.
#[derive(Debug, Clone)]
pub struct Question {
    /// The signal that is changed; none where only poles are asked for.
    pub from: Option<Place>,
    /// Those that answer; of a loop the signal itself.
    pub to: Vec<Place>,
    /// Where signals are cut.
    pub open: Vec<Place>,
    /// Whether the loop through `from` is measured, once around.
    pub is_loop: bool,
}

impl Question {
    /// What the signal that is changed is called.
    pub fn name(&self) -> &str {
        self.from.as_ref().map_or("", |from| &from.name)
    }
}

/// A linear system and how it was made.
#[derive(Debug)]
pub struct Linearised {
    /// From the one input to all outputs; the loop with the sign of a negative feedback. Behind them, what comes out of dead times as
    /// inputs, and what goes into them as outputs.
    pub system: StateSpace,
    /// The dead times: path and s.
    pub dead: Vec<(String, f64)>,
    /// Names of the states.
    pub names: Vec<String>,
    /// States of the operating point.
    pub x: Vec<f64>,
    /// Names of states that follow from these.
    pub following: Vec<String>,
    /// Value of the input there, if there is one.
    pub value: Option<f64>,
    /// Values of the outputs there.
    pub values: Vec<f64>,
    /// Largest error of an entry, relative to the largest of its row.
    pub accuracy: f64,
    /// What is not smooth there, in words.
    pub kinks: Vec<String>,
    /// Where the slopes come from.
    pub method: Method,
    /// Blocks on the way that are held, with the reason.
    pub held: Vec<(String, Hold)>,
    /// Blocks on the way that stay in a mode in which they do not move freely.
    pub modes: Vec<(String, Stays)>,
}

/// A mode that people may not expect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stays {
    /// Dry friction holds it.
    Stuck,
    /// It is at a limit.
    Limited,
}

/// Where slopes come from: all that is not named here follows exactly from the laws of the blocks.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Method {
    /// Blocks that record no law, whose own slopes are differences.
    pub blocks: Vec<String>,
    /// States and inputs over which differences of the whole model are taken, as there is a kink or something unknown.
    pub columns: Vec<String>,
    /// Why they are, where that is known.
    pub because: Option<String>,
}

/// Why a block does not answer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// It samples with this period, s.
    Sampled(f64),
    /// It remembers what it was given: a delay line, a rate limit.
    Remembers,
}

/// Why there are no matrices.
#[derive(Debug)]
pub enum NoMatrices {
    /// A block could not go on beside the operating point.
    Simulation(SimError),
    /// There are none there.
    Said(Failure),
    /// Ctrl-C.
    Interrupted,
}

impl From<SimError> for NoMatrices {
    fn from(error: SimError) -> NoMatrices {
        NoMatrices::Simulation(error)
    }
}

impl From<LinearError> for NoMatrices {
    fn from(error: LinearError) -> NoMatrices {
        NoMatrices::Said(Failure::new(Exit::Failed, "linearise", error.to_string()))
    }
}

/// The dead times between the input and an output, element by element.
struct DeadTime {
    path: String,
    time: f64,
    /// Cells of what goes in and of what comes out.
    begin: usize,
    end: usize,
}

/// The linear system around an operating point.
///
/// # Errors
/// [`NoMatrices`].
pub fn linearise(frozen: Frozen, question: &Question) -> Result<Linearised, NoMatrices> {
    let schedule = frozen.simulation().schedule().clone();
    let between = between(&schedule, question);
    let dead = dead_times(&schedule, &between);
    let taps = taps(question, dead.iter().map(|dead| dead.end));
    let cut: Vec<bool> = taps.iter().map(|tap| tap.open).collect();
    let delayed = |tap: &Tap| dead.iter().position(|dead| dead.end == tap.cell);
    let opened = taps.iter().map(|tap| Tap { open: tap.open || delayed(tap).is_some(), ..*tap }).collect();
    let frozen = frozen.with_taps(opened)?;
    let (x, n) = (frozen.states().to_vec(), frozen.states().len());
    let inputs = usize::from(question.from.is_some());
    let value = question.from.as_ref().map(|from| frozen.signal(from.cell));
    let modes = modes(&schedule, &between, frozen.discrete());
    let (outputs, rows) = (question.to.len(), n + question.to.len() + dead.len());
    let change = vec![0.0; taps.len()];
    let point: Vec<f64> = x.iter().copied().chain(vec![0.0; inputs + dead.len()]).collect();
    let mut model = Model { frozen, question, dead, taps, cut, inputs, change };
    let mut there = vec![0.0; rows];
    model.evaluate(&point, &mut there)?;
    let names = state_names(&schedule);
    let ends = model.dead.iter().map(|dead| format!("`{}`", dead.path));
    let rows_named: Vec<String> = names.iter().map(|state| format!("the derivative of `{state}`")).collect();
    let outputs_named = question.to.iter().map(|to| format!("`{}`", to.name)).chain(ends.clone());
    let inputs_named = question.from.iter().map(|from| format!("`{}`", from.name)).chain(ends);
    let labels = Labels {
        rows: rows_named.into_iter().chain(outputs_named).collect(),
        columns: names.iter().map(|state| format!("`{state}`")).chain(inputs_named).collect(),
    };
    model.frozen.differentiate(&x)?;
    let Slopes { system, accuracy, kinks, method, kept } =
        slopes((&point, &there, n), None, &labels, &mut model)?;
    let (names, x, following) = divided(names, &x, &kept);
    let sign = if question.is_loop { -1.0 } else { 1.0 };
    Ok(Linearised {
        accuracy,
        kinks,
        method,
        value,
        values: there[n..n + outputs].iter().map(|y| sign * y).collect(),
        held: held(&schedule, &between),
        dead: model.dead.into_iter().map(|dead| (dead.path, dead.time)).collect(),
        modes,
        names,
        x,
        following,
        system,
    })
}

/// What is linearised: a model as a function of its states, of its input, and of what comes out of dead times.
struct Model<'q> {
    frozen: Frozen,
    question: &'q Question,
    dead: Vec<DeadTime>,
    taps: Vec<Tap>,
    /// Which taps are cut, and not just ends of dead times.
    cut: Vec<bool>,
    inputs: usize,
    change: Vec<f64>,
}

impl Model<'_> {
    fn delayed(&self, tap: &Tap) -> Option<usize> {
        self.dead.iter().position(|dead| dead.end == tap.cell)
    }

    /// What inputs `z` add at the taps.
    fn take_inputs(&mut self, z: &[f64]) {
        let (input, ends) = z.split_at(self.inputs);
        for (place, tap) in self.taps.iter().enumerate() {
            let own =
                self.question.from.as_ref().filter(|from| from.cell == tap.cell).map_or(0.0, |_| input[0]);
            // Behind a cut nothing comes out of a dead time.
            let end = self.delayed(tap).filter(|_| !self.cut[place]).map_or(0.0, |dead| ends[dead]);
            self.change[place] = own + end;
        }
    }

    /// The outputs, or their rates, with `ends` those of dead times and what is at cells and what was given at taps.
    fn outputs(&self, ends: &[f64], at: &dyn Fn(usize) -> f64, given: &dyn Fn(usize) -> f64, y: &mut [f64]) {
        for (y, to) in y.iter_mut().zip(&self.question.to) {
            // In front of a cut stands what comes to it.
            let place = self.taps.iter().position(|tap| tap.open && tap.cell == to.cell);
            let given = |place: usize| {
                self.delayed(&self.taps[place]).map_or_else(|| given(place), |dead| ends[dead])
            };
            *y = match place {
                Some(place) if self.question.is_loop => -given(place),
                Some(place) => given(place),
                None => at(to.cell),
            };
        }
        let first = self.question.to.len();
        y[first..].iter_mut().zip(&self.dead).for_each(|(y, dead)| *y = at(dead.begin));
    }
}

/// A function whose slopes are wanted.
pub(super) trait Function {
    /// Its values for an argument.
    ///
    /// # Errors
    /// [`NoMatrices`].
    fn evaluate(&mut self, z: &[f64], out: &mut [f64]) -> Result<(), NoMatrices>;

    /// Writes how the values change along a direction, as far as that is known without differences of the whole. With `doubts`,
    /// differences of parts count with their errors added.
    fn along(&mut self, _direction: &[f64], _doubts: bool, _out: &mut [f64]) -> Origin {
        Origin::Unknown
    }

    /// What states obey whatever happens, at an argument.
    ///
    /// # Errors
    /// [`NoMatrices`].
    fn invariants(&mut self, _z: &[f64]) -> Result<Vec<Invariant>, NoMatrices> {
        Ok(Vec::new())
    }

    /// Blocks whose differences have had a part in that.
    fn by_differences(&self) -> Vec<String> {
        Vec::new()
    }
}

impl Function for Model<'_> {
    fn evaluate(&mut self, z: &[f64], out: &mut [f64]) -> Result<(), NoMatrices> {
        if interrupt::is_requested() {
            return Err(NoMatrices::Interrupted);
        }
        let n = self.frozen.states().len();
        self.take_inputs(&z[n..]);
        let (dx, y) = out.split_at_mut(n);
        self.frozen.evaluate(&z[..n], &self.change, dx)?;
        let Self { frozen, inputs, .. } = &*self;
        self.outputs(&z[n + inputs..], &|cell| frozen.signal(cell), &|tap| frozen.given()[tap], y);
        Ok(())
    }

    fn along(&mut self, direction: &[f64], doubts: bool, out: &mut [f64]) -> Origin {
        let n = self.frozen.states().len();
        self.take_inputs(&direction[n..]);
        let (dx, y) = out.split_at_mut(n);
        let origin = self.frozen.along(&direction[..n], &self.change, doubts, dx);
        let Self { frozen, inputs, .. } = &*self;
        self.outputs(&direction[n + inputs..], &|cell| frozen.rate(cell), &|tap| frozen.given_rate(tap), y);
        origin
    }

    fn invariants(&mut self, z: &[f64]) -> Result<Vec<Invariant>, NoMatrices> {
        let n = self.frozen.states().len();
        self.take_inputs(&z[n..]);
        self.frozen.evaluate(&z[..n], &self.change, &mut vec![0.0; n])?;
        Ok(self.frozen.invariants())
    }

    fn by_differences(&self) -> Vec<String> {
        self.frozen.by_differences().into_iter().map(str::to_owned).collect()
    }
}

/// Where signals are changed or cut, and at these cells besides.
pub(super) fn taps(question: &Question, others: impl Iterator<Item = usize>) -> Vec<Tap> {
    let is_open = |cell: usize| question.open.iter().any(|open| open.cell == cell);
    let named = question.from.iter().chain(&question.open).map(|place| place.cell);
    let mut taps: Vec<Tap> = Vec::new();
    for cell in named.chain(others) {
        if taps.iter().all(|tap| tap.cell != cell) {
            taps.push(Tap { cell, open: is_open(cell) });
        }
    }
    taps
}

/// What rows and columns of slopes are called.
pub(super) struct Labels {
    pub rows: Vec<String>,
    pub columns: Vec<String>,
}

/// Slopes as the matrices of a system.
pub(super) struct Slopes {
    pub system: StateSpace,
    pub accuracy: f64,
    pub kinks: Vec<String>,
    pub method: Method,
    /// The states that are free.
    pub kept: Vec<usize>,
}

/// The slopes of a function of `n` states and of inputs, which gives as many states or derivatives and then outputs, at a point with its values
/// `there`; over the states that are free, along what all of them obey.
pub(super) fn slopes(
    (point, there, n): (&[f64], &[f64], usize),
    period: Option<f64>,
    labels: &Labels,
    function: &mut impl Function,
) -> Result<Slopes, NoMatrices> {
    let (rows, m) = (there.len(), point.len() - n);
    let outputs = rows - n;
    let said =
        |text: String, help: &str| NoMatrices::Said(Failure::new(Exit::Failed, "linearise", text).help(help));
    if let Some(row) = there.iter().position(|value| !value.is_finite()) {
        let text = format!("{} is {} at the operating point", labels.rows[row], there[row]);
        return Err(said(text, "choose another instant with --at"));
    }
    let (directions, accuracy) = free(n, point, function)?;
    let kept = directions.kept.clone();
    let taken = |from: &[f64]| -> Vec<f64> {
        kept.iter().map(|i| from[*i]).chain(from[n..].iter().copied()).collect()
    };
    let named = |from: &[String]| -> Vec<String> {
        kept.iter().map(|i| from[*i].clone()).chain(from[n..].iter().cloned()).collect()
    };
    let labels = &Labels { rows: named(&labels.rows), columns: named(&labels.columns) };
    let (slopes, method) = if kept.len() == n {
        mixed(point, rows, labels, function)?
    } else {
        let from = taken(point);
        // A constraint that is nothing but rounding has no accuracy that says anything.
        let cancels = accuracy.clamp(ROUNDING, FAITHFUL);
        let (z, out, doubtful) = (vec![0.0; point.len()], vec![0.0; rows], vec![0.0; rows]);
        let mut along =
            Along { function, directions: &directions, cancels, point, from: &from, n, z, out, doubtful };
        mixed(&from, kept.len() + outputs, labels, &mut along)?
    };
    let (n, rows) = (kept.len(), kept.len() + outputs);
    if let Some(at) = slopes.value.iter().position(|value| !value.is_finite()) {
        let text =
            format!("{} has no finite slope over {}", labels.rows[at % rows], labels.columns[at / rows]);
        return Err(said(text, "the law has a jump or a pole there; choose another instant with --at"));
    }
    let part = |row: usize, column: usize, rows: usize, columns: usize| {
        slopes.value.view((row, column), (rows, columns)).into_owned()
    };
    let system = StateSpace::new(
        part(0, 0, n, n),
        part(0, n, n, m),
        part(n, 0, outputs, n),
        part(n, n, outputs, m),
        period,
    )?;
    let kinks = slopes.kinks.iter().map(|kink| {
        let Kink { row, column, left, right } = *kink;
        format!(
            "{} over {}: {} below, {} above",
            labels.rows[row],
            labels.columns[column],
            blocksim_numbers::format::significant(left, 4),
            blocksim_numbers::format::significant(right, 4)
        )
    });
    Ok(Slopes { system, accuracy: slopes.accuracy(), kinks: kinks.collect(), method, kept })
}

/// The names and the values of the states that are free, and the names of those that follow from them.
pub(super) fn divided(names: Vec<String>, x: &[f64], kept: &[usize]) -> (Vec<String>, Vec<f64>, Vec<String>) {
    let values = kept.iter().map(|i| x[*i]).collect();
    let all = names.into_iter().enumerate();
    let (free, following): (Vec<_>, Vec<_>) = all.partition(|(i, _)| kept.contains(i));
    let named = |list: Vec<(usize, String)>| list.into_iter().map(|(_, name)| name).collect();
    (named(free), values, named(following))
}

/// The directions in which a function of so many states, and of inputs, obeys what states obey, at a point, and their accuracy.
fn free(n: usize, point: &[f64], function: &mut impl Function) -> Result<(Directions, f64), NoMatrices> {
    let m = point.len() - n;
    let here = function.invariants(point)?;
    let rows: usize = here.iter().map(|kind| kind.gaps.len() + kind.terms.len()).sum();
    if rows == 0 {
        return Ok((directions(n, m, &[]), 0.0));
    }
    let slopes = jacobian_over(point, 0..point.len(), rows, |z, out| {
        let found = function.invariants(z)?;
        let values = found.iter().flat_map(|kind| kind.gaps.iter().chain(&kind.terms));
        // Where others hold beside the point, nothing is known of these.
        out.fill(f64::NAN);
        out.iter_mut().zip(values).for_each(|(to, value)| *to = *value);
        Ok::<(), NoMatrices>(())
    })?;
    let mut first = 0;
    let mut part = |rows: usize| {
        first += rows;
        slopes.value.rows(first - rows, rows).into_owned()
    };
    let kinds = here.into_iter().map(|Invariant { gaps, followers, terms, .. }| Constrained {
        gaps: part(gaps.len()),
        followers,
        terms: part(terms.len()),
    });
    let kinds: Vec<Constrained> = kinds.collect();
    Ok((directions(n, m, &kinds), slopes.accuracy()))
}

/// Part of its terms that is left of a slope along several states where they cancel: by rounding, and at most where the directions are
/// differences.
const ROUNDING: f64 = 1e-13;
const FAITHFUL: f64 = 1e-9;

/// A function along the directions in which it can move, from a point on.
struct Along<'f, F> {
    function: &'f mut F,
    directions: &'f Directions,
    /// Part of its terms that is left of a slope where they cancel.
    cancels: f64,
    /// All states and inputs of the point, and those that are free.
    point: &'f [f64],
    from: &'f [f64],
    /// States in all; room for all arguments and all values.
    n: usize,
    z: Vec<f64>,
    out: Vec<f64>,
    doubtful: Vec<f64>,
}

impl<F> Along<'_, F> {
    /// What all arguments change by.
    fn all(&mut self, change: impl Fn(usize) -> f64) {
        let Directions { all, .. } = self.directions;
        for (row, z) in self.z.iter_mut().enumerate() {
            *z = (0..all.ncols()).map(|column| all[(row, column)] * change(column)).sum();
        }
    }

    fn give(&self, out: &mut [f64]) {
        let kept = self.directions.kept.iter().copied().chain(self.n..self.out.len());
        out.iter_mut().zip(kept).for_each(|(to, row)| *to = self.out[row]);
    }
}

impl<F: Function> Function for Along<'_, F> {
    fn evaluate(&mut self, z: &[f64], out: &mut [f64]) -> Result<(), NoMatrices> {
        let from = self.from;
        self.all(|column| z[column] - from[column]);
        self.z.iter_mut().zip(self.point).for_each(|(z, point)| *z += point);
        self.function.evaluate(&self.z, &mut self.out)?;
        self.give(out);
        Ok(())
    }

    fn along(&mut self, direction: &[f64], doubts: bool, out: &mut [f64]) -> Origin {
        self.all(|column| direction[column]);
        let none = || vec![0.0; self.out.len()];
        let (mut sum, mut size, mut error) = (none(), none(), none());
        let mut origin = Origin::Laws;
        let mut one = vec![0.0; self.z.len()];
        for column in (0..one.len()).filter(|column| self.z[*column] != 0.0) {
            one[column] = 1.0;
            origin = match (origin, self.function.along(&one, false, &mut self.out)) {
                (_, Origin::Unknown) => return Origin::Unknown,
                (Origin::Laws, origin) => origin,
                (origin, _) => origin,
            };
            for ((sum, size), slope) in sum.iter_mut().zip(&mut size).zip(&self.out) {
                let part = slope * self.z[column];
                (*sum, *size) = (*sum + part, *size + part.abs());
            }
            // Errors add up, also where slopes cancel.
            if doubts {
                self.function.along(&one, true, &mut self.doubtful);
                let errors =
                    self.doubtful.iter().zip(&self.out).map(|(doubtful, slope)| (doubtful - slope).abs());
                error.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error * self.z[column].abs());
            }
            one[column] = 0.0;
        }
        // What cancels leaves nothing: an integrator stays one.
        for (((to, sum), size), error) in self.out.iter_mut().zip(&sum).zip(&size).zip(&error) {
            *to = if sum.abs() <= self.cancels * size { 0.0 } else { *sum } + error;
        }
        self.give(out);
        origin
    }

    fn by_differences(&self) -> Vec<String> {
        self.function.by_differences()
    }
}

/// What a slope is above its error, at least: that is no bound.
const FAINT: f64 = 4.0;

/// Slopes column by column: those that the function knows, and differences elsewhere.
fn mixed(
    point: &[f64],
    rows: usize,
    labels: &Labels,
    function: &mut impl Function,
) -> Result<(Jacobian, Method), NoMatrices> {
    let columns = point.len();
    let (mut value, mut error) = (DMatrix::zeros(rows, columns), DMatrix::zeros(rows, columns));
    let (mut direction, mut found, mut doubtful) = (vec![0.0; columns], vec![0.0; rows], vec![0.0; rows]);
    let mut unknown = Vec::new();
    for column in 0..columns {
        direction[column] = 1.0;
        match function.along(&direction, false, &mut found) {
            Origin::Laws => found.iter().enumerate().for_each(|(row, slope)| value[(row, column)] = *slope),
            Origin::Differences => {
                function.along(&direction, true, &mut doubtful);
                for (row, (slope, doubtful)) in found.iter().zip(&doubtful).enumerate() {
                    let doubt = (slope - doubtful).abs();
                    error[(row, column)] = doubt;
                    value[(row, column)] = if slope.abs() <= FAINT * doubt { 0.0 } else { *slope };
                }
            }
            Origin::Unknown => unknown.push(column),
        }
        direction[column] = 0.0;
    }
    let blocks = function.by_differences();
    let names = unknown.iter().map(|&column| labels.columns[column].clone()).collect();
    let mut kinks = Vec::new();
    if !unknown.is_empty() {
        let rest = jacobian_over(point, unknown.iter().copied(), rows, |z, out| function.evaluate(z, out))?;
        for column in unknown {
            value.set_column(column, &rest.value.column(column));
            error.set_column(column, &rest.error.column(column));
        }
        kinks = rest.kinks;
    }
    Ok((Jacobian { value, error, kinks }, Method { blocks, columns: names, because: None }))
}

/// The dead times among some blocks.
fn dead_times(schedule: &Schedule, between: &[usize]) -> Vec<DeadTime> {
    let blocks = between.iter().map(|&block| &schedule.blocks[block]);
    let dead = blocks.filter_map(|block| Some((block, block.interface.dead_time?, block.gather.first()?)));
    dead.flat_map(|(block, time, &(from, count))| {
        (0..count as usize).map(move |element| DeadTime {
            path: block.path.clone(),
            time,
            begin: from as usize + element,
            end: block.y + element,
        })
    })
    .collect()
}

/// Blocks between the input and an output, by index; without an input all.
pub(super) fn between(schedule: &Schedule, question: &Question) -> Vec<usize> {
    let Some(input) = &question.from else { return (0..schedule.blocks.len()).collect() };
    let cut: BTreeSet<usize> = question.open.iter().map(|open| open.cell).collect();
    let reads = |block: usize, cells: &BTreeSet<usize>| {
        let mut spans = schedule.blocks[block].gather.iter();
        spans.any(|&(from, length)| cells.range(from as usize..(from + length) as usize).next().is_some())
    };
    let written = |block: usize| {
        let block = &schedule.blocks[block];
        let width = block.outputs.iter().map(|port| port.1 as usize).max().unwrap_or(0);
        block.y..block.y + width
    };
    // Forwards from the input, through everything.
    let mut cells = BTreeSet::from([input.cell]);
    let mut reached: BTreeSet<usize> = BTreeSet::new();
    let mut grows = true;
    while grows {
        grows = false;
        for block in 0..schedule.blocks.len() {
            if !reached.contains(&block) && reads(block, &cells) {
                reached.insert(block);
                cells.extend(written(block).filter(|cell| !cut.contains(cell)));
                grows = true;
            }
        }
    }
    // Backwards from the outputs.
    let mut wanted: BTreeSet<usize> = question.to.iter().map(|to| to.cell).collect();
    let mut leads: BTreeSet<usize> = BTreeSet::new();
    let mut grows = true;
    while grows {
        grows = false;
        for block in 0..schedule.blocks.len() {
            if !leads.contains(&block) && written(block).any(|cell| wanted.contains(&cell)) {
                leads.insert(block);
                let spans = schedule.blocks[block].gather.iter();
                wanted.extend(
                    spans
                        .flat_map(|&(from, length)| from as usize..(from + length) as usize)
                        .filter(|cell| !cut.contains(cell)),
                );
                grows = true;
            }
        }
    }
    reached.intersection(&leads).copied().collect()
}

/// Those that do not pass small changes on, because they sample or remember.
fn held(schedule: &Schedule, between: &[usize]) -> Vec<(String, Hold)> {
    let clock = &schedule.clock;
    let held = between.iter().map(|&block| &schedule.blocks[block]).filter_map(|block| {
        let hold = match block.rate {
            Some(rate) => Hold::Sampled(clock.time(clock.rates.get(rate)?.period)),
            None if block.interface.dead_time.is_some() => return None,
            None if block.interface.accepts || block.interface.remembers.is_some() => Hold::Remembers,
            None => return None,
        };
        Some((block.path.clone(), hold))
    });
    held.collect()
}

/// Those whose modes keep them from moving freely: dry friction of a network whose mode is 0 holds, and a mode of any other
/// block that is not 0 is a limit.
pub(super) fn modes(schedule: &Schedule, between: &[usize], values: &[f64]) -> Vec<(String, Stays)> {
    let mut found: Vec<(String, Stays)> = Vec::new();
    for block in between.iter().map(|&block| &schedule.blocks[block]) {
        for (state, value) in block.interface.discrete.iter().zip(&values[block.d..]) {
            let name = state.name();
            let (owner, name) = name.rsplit_once('.').unwrap_or((&block.path, &name));
            let stays = match name.strip_prefix("mode") {
                Some(_) if owner != block.path => (*value == 0.0).then_some(Stays::Stuck),
                Some("") => (*value != 0.0).then_some(Stays::Limited),
                _ => None,
            };
            found.extend(stays.map(|stays| (owner.to_owned(), stays)));
        }
    }
    found.dedup();
    found
}
