//! A simulation at one instant: what derivatives and signals would be, were states or signals a bit different.

use blocksim_block::Invariant;
use blocksim_block::schedule::{Schedule, Step, When};

use crate::program::spread::{spread, written};
use crate::variation::chain::{Chain, Direction, Origin};
use crate::{Observer, SimError, Simulation};

/// A signal that may be changed on its way from the block that gives it to those that read it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tap {
    /// Cell among the signals of the schedule.
    pub cell: usize,
    /// Whether the signal is cut there: readers get its value of the instant, whatever the block gives, plus the change.
    pub open: bool,
}

/// A simulation at one instant. Time, sampled values and the modes of blocks (which side of a switch, what sticks) stay as
/// they are, so that all that is left is a function of continuous states and of the changes at the taps.
#[derive(Debug)]
pub struct Frozen {
    simulation: Simulation,
    taps: Vec<Tap>,
    /// Which calls of a major pass are evaluated: those of what goes on between major steps, and of what would change there
    /// if the taps did.
    asked: Vec<bool>,
    /// Behind which call of an evaluation the signal of each tap is there; none if it is not evaluated.
    written: Vec<Option<usize>>,
    /// All signals of the instant.
    signals: Vec<f64>,
    /// What the blocks give at the taps.
    given: Vec<f64>,
    /// Slopes at the states of the last [`Frozen::differentiate`].
    chain: Option<(Chain, Direction)>,
}

impl Frozen {
    /// Freezes a simulation where it is; one that has not begun, at its start.
    ///
    /// # Errors
    /// See [`SimError::code`]; `settings` if there is no such cell.
    pub fn new(mut simulation: Simulation, taps: Vec<Tap>) -> Result<Frozen, SimError> {
        if !simulation.started {
            simulation.start(&mut Nobody)?;
        }
        let signals = simulation.diagram.signals.clone();
        if let Some(tap) = taps.iter().find(|tap| tap.cell >= simulation.schedule.initial_signals.len()) {
            let message = format!("there is no signal at cell {}", tap.cell);
            return Err(SimError::new("settings", simulation.t, message));
        }
        let schedule = &simulation.schedule;
        let asked = asked(schedule, &taps);
        let written = taps.iter().map(|tap| writer(schedule, tap.cell).filter(|&call| asked[call])).collect();
        Ok(Frozen { asked, given: vec![0.0; taps.len()], written, taps, signals, simulation, chain: None })
    }

    /// Evaluates the diagram at other states `x`, with `change` added at each tap; writes the derivatives of all states.
    ///
    /// # Errors
    /// `block_failed` if a block cannot go on there.
    pub fn evaluate(&mut self, x: &[f64], change: &[f64], dx: &mut [f64]) -> Result<(), SimError> {
        let Frozen { simulation, taps, asked, written, signals: before, given, .. } = self;
        let diagram = &mut simulation.diagram;
        diagram.signals.copy_from_slice(before);
        let mut touch = |call: Option<usize>, signals: &mut [f64]| {
            for (n, tap) in taps.iter().enumerate().filter(|(n, _)| written[*n] == call) {
                given[n] = signals[tap.cell];
                signals[tap.cell] = change[n] + if tap.open { before[tap.cell] } else { given[n] };
            }
        };
        touch(None, &mut diagram.signals);
        let evaluated = diagram.touched(simulation.t, x, asked, |call, signals| touch(Some(call), signals));
        let evaluated = evaluated.and_then(|()| diagram.derive(dx));
        simulation.held(evaluated)
    }

    /// What states obey wherever the diagram can be, at those of the last evaluation.
    pub fn invariants(&mut self) -> Vec<Invariant> {
        self.simulation.diagram.invariants()
    }

    /// Takes the slopes at the states `x`, without changes at the taps: exact ones of laws that are data, those of other blocks by
    /// differences. [`along`](Self::along) puts them together.
    ///
    /// # Errors
    /// `block_failed` if a block cannot go on there.
    pub fn differentiate(&mut self, x: &[f64]) -> Result<(), SimError> {
        let (none, mut dx) = (vec![0.0; self.taps.len()], vec![0.0; x.len()]);
        self.evaluate(x, &none, &mut dx)?;
        let Frozen { simulation, taps, asked, written, chain, .. } = self;
        let diagram = &mut simulation.diagram;
        let (chain, _) = chain.get_or_insert_with(|| {
            let taps: Vec<_> = taps.iter().copied().zip(written.iter().copied()).collect();
            (Chain::new(diagram, asked, &taps), Direction::none(diagram, taps.len()))
        });
        chain.fix(diagram, &[], &[]);
        Ok(())
    }

    /// Writes how the derivatives of all states change along a direction in the space of the states, with `change` the rates of what
    /// is added at the taps, at the point of [`differentiate`](Self::differentiate). With `doubts`, differences count with their errors
    /// added.
    pub fn along(&mut self, x: &[f64], change: &[f64], doubts: bool, dx: &mut [f64]) -> Origin {
        let Some((chain, direction)) = &mut self.chain else { return Origin::Unknown };
        direction.x.copy_from_slice(x);
        direction.changes.copy_from_slice(change);
        chain.doubt(doubts);
        chain.along(&self.simulation.diagram, direction, dx)
    }

    /// Rate of a cell along the last direction, as those who read it see it.
    pub fn rate(&self, cell: usize) -> f64 {
        self.chain.as_ref().map_or(f64::NAN, |(chain, _)| chain.rate(cell))
    }

    /// Rate of what the blocks gave at a tap along the last direction.
    pub fn given_rate(&self, tap: usize) -> f64 {
        self.chain.as_ref().map_or(f64::NAN, |(chain, _)| chain.given()[tap])
    }

    /// Paths of the blocks whose differences have had a part in rates.
    pub fn by_differences(&self) -> Vec<&str> {
        let blocks = &self.simulation.schedule.blocks;
        let used = self.chain.iter().flat_map(|(chain, _)| chain.used());
        used.map(|block| blocks[block].path.as_str()).collect()
    }

    /// Lets all blocks choose their modes anew at other states, which become those of the instant. Returns whether any
    /// mode has changed.
    ///
    /// # Errors
    /// `block_failed` if a block cannot go on there.
    pub fn settle(&mut self, x: &[f64]) -> Result<bool, SimError> {
        let simulation = &mut self.simulation;
        simulation.x.copy_from_slice(x);
        let diagram = &mut simulation.diagram;
        diagram.signals.copy_from_slice(&self.signals);
        diagram.settle.changed = false;
        let none_due = vec![false; simulation.hits.due.len()];
        let evaluated = diagram.major(simulation.t, x, &none_due, false);
        simulation.held(evaluated)?;
        self.signals.copy_from_slice(&self.simulation.diagram.signals);
        Ok(self.simulation.diagram.settle.changed)
    }

    /// Value of a cell among the signals, as those who read it got it in the last evaluation.
    pub fn signal(&self, cell: usize) -> f64 {
        self.simulation.diagram.signals[cell]
    }

    /// What the blocks gave at the taps in the last evaluation, without the changes.
    pub fn given(&self) -> &[f64] {
        &self.given
    }

    /// Whether the signal of a tap changes between two major steps at all.
    pub fn moves(&self, tap: usize) -> bool {
        self.written[tap].is_some()
    }

    /// Continuous states of the instant.
    pub fn states(&self) -> &[f64] {
        &self.simulation.x
    }

    /// Discrete states of all blocks: modes, sampled states, memories.
    pub fn discrete(&self) -> &[f64] {
        &self.simulation.diagram.d
    }

    /// The simulation, to be looked at.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Puts other taps in the place of the present ones.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_taps(self, taps: Vec<Tap>) -> Result<Frozen, SimError> {
        let Frozen { mut simulation, signals, .. } = self;
        simulation.diagram.signals.copy_from_slice(&signals);
        simulation.diagram.forget();
        Frozen::new(simulation, taps)
    }
}

/// Which calls of a major pass are evaluated. What is constant or changes by events alone, as a gain behind a step, still
/// passes a change of its input on at once; what is sampled does not.
fn asked(schedule: &Schedule, taps: &[Tap]) -> Vec<bool> {
    let mut touched = vec![false; schedule.initial_signals.len()];
    taps.iter().for_each(|tap| touched[tap.cell] = true);
    let sampled = |step: &Step| matches!(step.when, When::Sampled(_));
    let read = spread(schedule, &mut touched, |step, read| read && !sampled(step));
    let asked = |(step, read): (&Step, bool)| step.when == When::Continuous || read && !sampled(step);
    schedule.steps.iter().zip(read).map(asked).collect()
}

/// Number among the calls of a major pass of the one that writes a cell.
fn writer(schedule: &Schedule, cell: usize) -> Option<usize> {
    schedule.steps.iter().position(|step| written(schedule, step).any(|written| written == cell))
}

/// Does not look.
pub(crate) struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, _values: &[f64]) {}
}
