//! From a frozen simulation to the matrices of a linear system, and what had to be held for it.

use std::collections::BTreeSet;

use blocksim_block::schedule::Schedule;
use blocksim_linear::{Kink, LinearError, StateSpace, jacobian};
use blocksim_sim::{Frozen, SimError, Tap, state_names};

use super::signals::Place;
use crate::exit::Exit;
use crate::failure::Failure;

/// What is asked for.
#[derive(Debug, Clone)]
pub struct Question {
    /// The signal that is changed.
    pub from: Place,
    /// Those that answer; of a loop the signal itself.
    pub to: Vec<Place>,
    /// Where signals are cut.
    pub open: Vec<Place>,
    /// Whether the loop through `from` is measured, once around.
    pub is_loop: bool,
}

/// A linear system and how it was made.
#[derive(Debug)]
pub struct Linearised {
    /// From the one input to all outputs; the loop with the sign of a negative feedback.
    pub system: StateSpace,
    /// Names of the states.
    pub names: Vec<String>,
    /// States of the operating point.
    pub x: Vec<f64>,
    /// Values there: of the input, then of the outputs.
    pub values: Vec<f64>,
    /// Largest error of an entry, relative to the largest of its row.
    pub accuracy: f64,
    /// What is not smooth there, in words.
    pub kinks: Vec<String>,
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

/// The linear system around an operating point.
///
/// # Errors
/// [`NoMatrices`].
pub fn linearise(frozen: Frozen, question: &Question) -> Result<Linearised, NoMatrices> {
    let first = Tap {
        cell: question.from.cell,
        open: question.is_loop || question.open.iter().any(|o| o.cell == question.from.cell),
    };
    let others = question.open.iter().filter(|open| open.cell != first.cell);
    let taps: Vec<Tap> =
        std::iter::once(first).chain(others.map(|open| Tap { cell: open.cell, open: true })).collect();
    let mut frozen = frozen.with_taps(taps.clone())?;
    let schedule = frozen.simulation().schedule().clone();
    let (x, n) = (frozen.states().to_vec(), frozen.states().len());
    let input = frozen.signal(question.from.cell);
    let between = between(&schedule, question);
    let modes = modes(&schedule, &between, frozen.discrete());
    let mut change = vec![0.0; taps.len()];
    let rows = n + question.to.len();
    let mut evaluate = |z: &[f64], out: &mut [f64]| -> Result<(), SimError> {
        change[0] = z[n];
        let (dx, y) = out.split_at_mut(n);
        frozen.evaluate(&z[..n], &change, dx)?;
        for (y, to) in y.iter_mut().zip(&question.to) {
            // In front of a cut stands what comes to it.
            let cut = taps.iter().position(|tap| tap.open && tap.cell == to.cell);
            *y = match cut {
                Some(_) if question.is_loop => -frozen.given()[0],
                Some(cut) => frozen.given()[cut],
                None => frozen.signal(to.cell),
            };
        }
        Ok(())
    };
    let point: Vec<f64> = x.iter().copied().chain([0.0]).collect();
    let mut there = vec![0.0; rows];
    evaluate(&point, &mut there)?;
    let names = state_names(&schedule);
    let row_name = |row: usize| match names.get(row) {
        Some(state) => format!("the derivative of `{state}`"),
        None => format!("`{}`", question.to[row - n].name),
    };
    if let Some(row) = there.iter().position(|value| !value.is_finite()) {
        let said = format!("{} is {} at the operating point", row_name(row), there[row]);
        let failure = Failure::new(Exit::Failed, "linearise", said);
        return Err(NoMatrices::Said(failure.help("choose another instant with --at")));
    }
    let slopes = jacobian(&point, rows, evaluate)?;
    let column_name = |column: usize| names.get(column).unwrap_or(&question.from.name);
    if let Some(at) = slopes.value.iter().position(|value| !value.is_finite()) {
        let (row, column) = (at % rows, at / rows);
        let said = format!("{} has no finite slope over `{}`", row_name(row), column_name(column));
        let failure = Failure::new(Exit::Failed, "linearise", said);
        return Err(NoMatrices::Said(
            failure.help("the law has a jump or a pole there; choose another instant with --at"),
        ));
    }
    let part = |row: usize, column: usize, rows: usize, columns: usize| {
        slopes.value.view((row, column), (rows, columns)).into_owned()
    };
    let m = question.to.len();
    let system =
        StateSpace::new(part(0, 0, n, n), part(0, n, n, 1), part(n, 0, m, n), part(n, n, m, 1), None)?;
    let kinks = slopes.kinks.iter().map(|kink| {
        let Kink { row, column, left, right } = *kink;
        format!(
            "{} over `{}`: {} below, {} above",
            row_name(row),
            column_name(column),
            blocksim_results::format::significant(left, 4),
            blocksim_results::format::significant(right, 4)
        )
    });
    let sign = if question.is_loop { -1.0 } else { 1.0 };
    let values = std::iter::once(input).chain(there[n..].iter().map(|y| sign * y));
    Ok(Linearised {
        accuracy: slopes.accuracy(),
        kinks: kinks.collect(),
        values: values.collect(),
        held: held(&schedule, &between),
        modes,
        names,
        x,
        system,
    })
}

/// Blocks between the input and an output, by index.
fn between(schedule: &Schedule, question: &Question) -> Vec<usize> {
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
    let mut cells = BTreeSet::from([question.from.cell]);
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
            None if block.interface.accepts || block.interface.remembers.is_some() => Hold::Remembers,
            None => return None,
        };
        Some((block.path.clone(), hold))
    });
    held.collect()
}

/// Those whose modes keep them from moving freely: dry friction of a network whose mode is 0 holds, and a mode of any other
/// block that is not 0 is a limit.
fn modes(schedule: &Schedule, between: &[usize], values: &[f64]) -> Vec<(String, Stays)> {
    let mut found: Vec<(String, Stays)> = Vec::new();
    for block in between.iter().map(|&block| &schedule.blocks[block]) {
        for (state, value) in block.interface.discrete.iter().zip(&values[block.d..]) {
            let (owner, name) = state.name.rsplit_once('.').unwrap_or((&block.path, &state.name));
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
