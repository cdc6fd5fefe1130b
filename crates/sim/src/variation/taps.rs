//! Signals that can be changed from outside on their way from the block that gives them to those that read them, while a
//! diagram runs: a block that adds the change stands in the schedule behind the one that gives the signal.

use std::collections::BTreeMap;
use std::sync::Arc;

use blocksim_block::law::{BlockLaw, Recording};
use blocksim_block::schedule::{Instance, Schedule, Step, When};
use blocksim_block::{Block, Context, Input, Interface, Output, Scratch};
use blocksim_signal::Shape;

use crate::SimError;
use crate::program::spread::{spread, written};

/// Where a signal can be changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Lever {
    /// Cell that the block writes.
    pub given: usize,
    /// Cell that the readers read.
    pub seen: usize,
    /// First of three cells that nobody writes: whether the signal is cut, its value if so, and the change.
    first: usize,
}

impl Lever {
    /// The cell of the change.
    pub fn change(&self) -> usize {
        self.first + CELLS - 1
    }

    /// Lets readers have the signal and a change; of one that is cut, the value `held` and the change.
    pub fn set(&self, signals: &mut [f64], held: Option<f64>, change: f64) {
        let cells = [f64::from(held.is_some()), held.unwrap_or(0.0), change];
        signals[self.first..self.first + cells.len()].copy_from_slice(&cells);
    }
}

/// The same diagram with a lever at each of these cells, with all levers at rest. The blocks keep their numbers; those of the levers
/// are behind them.
///
/// # Errors
/// `settings` if there is no such signal, or the engine finds its value itself.
pub(crate) fn with_levers(schedule: &Schedule, cells: &[usize]) -> Result<(Schedule, Vec<Lever>), SimError> {
    let mut schedule = schedule.clone();
    // Where the elements of a signal are read, by its first cell.
    let mut homes: BTreeMap<usize, usize> = BTreeMap::new();
    let mut levers = Vec::with_capacity(cells.len());
    for &cell in cells {
        let signal = schedule.signals.iter().find(|s| (s.offset..s.offset + s.shape.len()).contains(&cell));
        let Some(signal) = signal.cloned() else {
            return Err(SimError::new("settings", 0.0, format!("there is no signal at cell {cell}")));
        };
        let home = homes.get(&signal.offset).copied().unwrap_or(signal.offset);
        let writes = |step: &Step| written(&schedule, step).any(|cell| cell == home);
        let sought = |found: &blocksim_block::schedule::Loop| {
            let count = found.cells.len();
            found.cells[count - found.sought..].iter().any(|c| (home..home + signal.shape.len()).contains(c))
        };
        // The elements of a vector that is no single value must not wait for each other.
        let parts = schedule.steps.iter().filter(|step| {
            written(&schedule, step).any(|cell| (home..home + signal.shape.len()).contains(&cell))
        });
        if parts.count() > 1 {
            let message = format!(
                "`{}` cannot be changed, as some of its elements depend on others at once",
                signal.path
            );
            return Err(SimError::new("settings", 0.0, message).help("name another signal on the way"));
        }
        let writer = schedule.steps.iter().position(writes);
        let Some(writer) = writer.filter(|_| !schedule.loops.iter().any(sought)) else {
            let message = format!("`{}` cannot be changed, as the engine finds its value", signal.path);
            return Err(SimError::new("settings", 0.0, message).help("name another signal on the way"));
        };
        let lever = insert(&mut schedule, &signal, cell - signal.offset, home, writer);
        homes.insert(signal.offset, lever.seen + signal.offset - cell);
        levers.push((lever, signal.offset, cell - signal.offset));
    }
    let moved = |(lever, offset, element): (Lever, usize, usize)| Lever {
        seen: homes.get(&offset).map_or(lever.seen, |home| home + element),
        ..lever
    };
    let levers: Vec<Lever> = levers.into_iter().map(moved).collect();
    wake(&mut schedule, &levers);
    Ok((schedule, levers))
}

/// Puts a lever behind the step `writer`, which writes the signal at `home`.
fn insert(
    schedule: &mut Schedule,
    signal: &blocksim_block::schedule::Signal,
    element: usize,
    home: usize,
    writer: usize,
) -> Lever {
    let (n, y) = (signal.shape.len(), schedule.initial_signals.len());
    let first = y + n;
    let before = schedule.initial_signals[home..home + n].to_vec();
    schedule.initial_signals.extend(before.into_iter().chain([0.0; CELLS]));
    for (from, _) in schedule.blocks.iter_mut().flat_map(|block| &mut block.gather) {
        if (home..home + n).contains(&(*from as usize)) {
            *from = (*from as usize - home + y) as u32;
        }
    }
    let at = writer + 1;
    for found in &mut schedule.loops {
        let end = found.first + found.count;
        if found.first > writer {
            found.first += 1;
        } else if writer < end {
            found.count += 1;
            let cells = found
                .cells
                .iter_mut()
                .chain(&mut found.chosen)
                .filter(|cell| (home..home + n).contains(*cell));
            cells.for_each(|cell| *cell = *cell - home + y);
        }
    }
    let step = schedule.steps[writer];
    // What holds its value takes a change at all instants.
    let when = if step.when == When::Continuous { step.when } else { When::Major };
    schedule.steps.insert(at, Step { block: schedule.blocks.len() as u32, group: 0, when, ..step });
    let interface = Interface::new()
        .input(Input::real("u").shape(signal.shape))
        .input(Input::real("change").shape(Shape::Vector(CELLS)))
        .output(Output::real("y").shape(signal.shape));
    let (block, inputs) = (Arc::new(Change { element }), vec![(0, n as u32), (n as u32, (n + CELLS) as u32)]);
    let block: Arc<dyn Block> = block;
    let law = BlockLaw::record(&block, &interface, &inputs, &[(0, n as u32)]).ok().flatten();
    schedule.blocks.push(Instance {
        path: signal.path.clone(),
        kind: "Lever".to_owned(),
        place: None,
        parts: Vec::new(),
        block,
        law: law.map(Arc::new),
        interface,
        gather: vec![(home as u32, n as u32), (first as u32, CELLS as u32)],
        inputs,
        outputs: vec![(0, n as u32)],
        y,
        x: schedule.states,
        d: schedule.discrete,
        g: schedule.guards,
        rate: None,
        watched: false,
    });
    Lever { given: home + element, seen: y + element, first }
}

/// What is constant behind a lever is evaluated at all instants.
fn wake(schedule: &mut Schedule, levers: &[Lever]) {
    let mut touched = vec![false; schedule.initial_signals.len()];
    levers.iter().for_each(|lever| touched[lever.first..lever.first + CELLS].fill(true));
    let read = spread(schedule, &mut touched, |_, read| read);
    for (step, _) in schedule.steps.iter_mut().zip(read).filter(|(_, read)| *read) {
        if step.when == When::Constant {
            step.when = When::Major;
        }
    }
}

/// Cells of a lever.
const CELLS: usize = 3;

/// The block of a lever: `u`, or the value held in its place, with a change of one element.
#[derive(Debug)]
struct Change {
    element: usize,
}

impl Block for Change {
    fn law(&self, l: &Recording) -> bool {
        let [cut, held, change] = [0, 1, 2].map(|cell| l.element(1, cell));
        l.each(0, |i| match i == self.element {
            true => change + cut.is_true().select(held, l.element(0, i)),
            false => l.element(0, i),
        });
        true
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        y.copy_from_slice(c.input(0));
        let [cut, held, change] = [0, 1, 2].map(|cell| c.input(1)[cell]);
        y[self.element] = change + if cut == 0.0 { y[self.element] } else { held };
    }
}
