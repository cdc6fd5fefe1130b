//! A compiled diagram: what the engine runs. Plain data, made by the compiler and shared by simulations.

use std::sync::Arc;

use blocksim_signal::{Dimension, Kind, Shape};

use crate::law::{BlockLaw, ValueGroup};
use crate::problem::Place;
use crate::{Block, Interface};

/// A compiled diagram.
#[derive(Debug, Clone)]
pub struct Schedule {
    /// Title of the diagram.
    pub title: String,
    /// The blocks, sorted by path.
    pub blocks: Vec<Instance>,
    /// Output groups in the order of evaluation.
    pub steps: Vec<Step>,
    /// Algebraic loops: steps that need each other's outputs at the same instant.
    pub loops: Vec<Loop>,
    /// One entry for each output port.
    pub signals: Vec<Signal>,
    /// Values of all signals before the first evaluation; the cells behind the last signal hold the values of
    /// inputs that are not connected.
    pub initial_signals: Vec<f64>,
    /// Number of continuous states.
    pub states: usize,
    /// Number of discrete states.
    pub discrete: usize,
    /// Number of guards.
    pub guards: usize,
    /// Sample times on one integer clock.
    pub clock: Clock,
    /// What is recorded.
    pub recorded: Vec<Recorded>,
    /// How to run it.
    pub settings: Settings,
}

/// A block of a compiled diagram and where its values lie.
#[derive(Debug, Clone)]
pub struct Instance {
    /// Path: `arm/base/joint`.
    pub path: String,
    /// Kind: `Gain`.
    pub kind: String,
    /// Where it is declared, if it is in a file.
    pub place: Option<Place>,
    /// The blocks that became this one, if it is a physical network.
    pub parts: Vec<BlockPart>,
    /// Parameters and functions.
    pub block: Arc<dyn Block>,
    /// Its law as data, if it records one.
    pub law: Option<Arc<BlockLaw>>,
    /// Ports and states.
    pub interface: Interface,
    /// Copies that bring the inputs from the signals: from, length; in the order of the input ports.
    pub gather: Vec<(u32, u32)>,
    /// Start and end of each input port within the inputs of the block.
    pub inputs: Vec<(u32, u32)>,
    /// Start and end of each output port within the outputs of the block.
    pub outputs: Vec<(u32, u32)>,
    /// First of the block's values among all signals.
    pub y: usize,
    /// First of the block's continuous states.
    pub x: usize,
    /// First of the block's discrete states.
    pub d: usize,
    /// First of the block's guards.
    pub g: usize,
    /// Index in `Clock::rates` of a sampled block.
    pub rate: Option<usize>,
    /// Whether its guards can cross zero between major steps.
    pub watched: bool,
}

impl Instance {
    /// Groups by values, where the law of the block has them.
    fn values(&self) -> Option<&[ValueGroup]> {
        self.law.as_ref().and_then(|law| law.values.as_deref())
    }

    /// Number of output groups.
    pub fn groups(&self) -> usize {
        self.values().map_or(self.interface.groups.len(), <[ValueGroup]>::len)
    }

    /// Cells among the signals that an output group writes.
    pub fn written(&self, group: usize) -> impl Iterator<Item = usize> + '_ {
        let values = self.values();
        let cells = values.into_iter().flat_map(move |values| values[group].cells.iter().copied());
        let ports = self.outputs.iter().zip(&self.interface.group_of);
        let ports = ports.filter(move |(_, of)| values.is_none() && **of == group);
        cells.chain(ports.flat_map(|((start, end), _)| *start..*end)).map(|cell| self.y + cell as usize)
    }

    /// The output group that writes a cell of the outputs, counted from the first of them.
    pub fn group_of(&self, cell: usize) -> Option<usize> {
        if let (Some(law), Some(_)) = (&self.law, self.values()) {
            return law.group_of.get(cell).copied();
        }
        let at = |(start, end): &(u32, u32)| (*start as usize..*end as usize).contains(&cell);
        self.outputs.iter().position(at).map(|port| self.interface.group_of[port])
    }

    /// Cells among the signals that an output group reads at the same instant.
    pub fn read(&self, group: usize) -> impl Iterator<Item = usize> + '_ {
        let values = self.values();
        let cells = values.into_iter().flat_map(move |values| &values[group].reads);
        let cells = cells.map(|cell| self.source(*cell));
        let ports = self.gather.iter().enumerate();
        let ports = ports.filter(move |(port, _)| values.is_none() && self.interface.reads(group, *port));
        cells.chain(ports.flat_map(|(_, (from, len))| *from as usize..(*from + *len) as usize))
    }

    /// The cell among the signals that a cell of the inputs is copied from.
    fn source(&self, cell: u32) -> usize {
        let mut left = cell;
        for &(from, len) in &self.gather {
            if left < len {
                return (from + left) as usize;
            }
            left -= len;
        }
        unreachable!("a law reads inputs that it has")
    }
}

/// A block of the diagram that is part of another one when it runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockPart {
    /// Path: `arm/base/joint`.
    pub path: String,
    /// Where it is declared, if it is in a file.
    pub place: Option<Place>,
}

/// Evaluation of one output group of one block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step {
    /// Index in `Schedule::blocks`.
    pub block: u32,
    /// Output group.
    pub group: u32,
    /// When it must be evaluated.
    pub when: When,
    /// Whether derivatives, watched guards or memories depend on it at the same instant, and not by way of what is held. What jumps at a
    /// major step lets a solver begin anew only then.
    pub acts: bool,
    /// Whether it is evaluated in minor steps: it acts, and changes between major steps.
    pub minor: bool,
}

/// Steps, one behind the other, that form an algebraic loop. They can be evaluated in this order once some cells are known.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Loop {
    /// First of its steps.
    pub first: usize,
    /// Number of its steps.
    pub count: usize,
    /// Cells among the signals that are read before they are written: the unknowns of the loop.
    pub cells: Vec<usize>,
    /// The same of truth values and whole numbers, which are chosen anew until they stay as they are.
    pub chosen: Vec<usize>,
    /// How many of the unknowns, the last ones, belong to constraints: the steps do not write their values but what must become zero.
    pub sought: usize,
}

/// When an output group must be evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// Once at the start.
    Constant,
    /// At every major step; it does not change in between.
    Major,
    /// Always.
    Continuous,
    /// At the hits of this rate.
    Sampled(u32),
}

/// One output port of one block.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Path and port: `arm/base/joint.q`.
    pub path: String,
    /// First cell.
    pub offset: usize,
    /// Real, Bool or Int.
    pub kind: Kind,
    /// Scalar, vector or matrix.
    pub shape: Shape,
    /// Dimension; `None` when nothing says it.
    pub dimension: Option<Dimension>,
}

/// Sample times on an integer clock, so that they neither drift nor miss each other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Clock {
    /// Length of a tick, s; 0 without rates.
    pub tick: f64,
    /// The rates, fastest first.
    pub rates: Vec<Rate>,
}

/// A sample time in ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rate {
    /// Ticks between two hits.
    pub period: u64,
    /// Ticks before the first hit.
    pub offset: u64,
}

impl Clock {
    /// Time of a tick, s. Where a second is a whole number of ticks the time is the nearest number to it.
    pub fn time(&self, tick: u64) -> f64 {
        Ticks::new(self.tick).time(tick)
    }
}

/// Multiples of a tick, for who needs many of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ticks {
    /// A second is a whole number of ticks.
    PerSecond(f64),
    /// A tick has this length, s.
    Length(f64),
}

impl Ticks {
    /// Ticks of this length, s.
    pub fn new(length: f64) -> Self {
        let per_second = 1.0 / length;
        let whole = per_second.round();
        if (per_second - whole).abs() <= 1e-9 * whole {
            Ticks::PerSecond(whole)
        } else {
            Ticks::Length(length)
        }
    }

    /// Time of a tick, s; the nearest number to it where a second is a whole number of ticks.
    pub fn time(self, tick: u64) -> f64 {
        match self {
            Ticks::PerSecond(whole) => tick as f64 / whole,
            Ticks::Length(length) => tick as f64 * length,
        }
    }
}

/// A signal to record.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// Name of the column: `control/joint1/scope.set`, `arm.signals.Joint1OutBus.Angle`.
    pub path: String,
    /// Cell among the signals.
    pub cell: usize,
    /// Real, Bool or Int.
    pub kind: Kind,
    /// Dimension; `None` when nothing says it.
    pub dimension: Option<Dimension>,
    /// Unit to show it in, if the diagram says one.
    pub display: Option<String>,
    /// What its scope is called by `label`, behind the labels of the subsystems around it, the outermost first; empty
    /// where nothing has a label.
    pub title: Vec<String>,
    /// What it is called in legends, where that is not the name of the input.
    pub legend: Option<String>,
    /// Name of the column over which it is drawn; over time without.
    pub over: Option<String>,
    /// Which rows are kept, as far as the diagram says it.
    pub keep: Keep,
    /// Whether it keeps its value from one row to the next, since it changes at sample hits and events alone, or is a truth value.
    pub held: bool,
}

/// Which rows of a run are kept of a signal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Keep {
    /// All.
    #[default]
    All,
    /// The first one at or behind each multiple of this time, s.
    Every(f64),
    /// Every so many rows one.
    Rows(u32),
    /// The least and the largest value within each stretch of this time, s.
    Extremes(f64),
}

/// How to run a diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// End of the simulation, s.
    pub stop_time: f64,
    /// The method.
    pub solver: Solver,
    /// Which rows are recorded.
    pub output: OutputTimes,
    /// Seed of random sources.
    pub seed: u64,
    /// Where the run begins.
    pub start: Start,
    /// Absolute tolerances of single states.
    pub atol: Vec<StateTolerance>,
    /// What becomes of algebraic loops.
    pub algebraic_loops: LoopPolicy,
}

/// What becomes of algebraic loops that nobody has said to be meant, as constraints are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Deserialize)]
pub enum LoopPolicy {
    /// They are solved.
    #[default]
    Solve,
    /// They are errors.
    Refuse,
}

/// What counts as nothing of some states.
#[derive(Debug, Clone, PartialEq)]
pub struct StateTolerance {
    /// Block, or one of its states, as it is written.
    pub name: String,
    /// In SI units.
    pub value: f64,
    /// What the value is measured in, if it is written.
    pub dimension: Dimension,
    /// Which states.
    pub states: Vec<usize>,
}

/// Latest end of a run, s. Times are numbers of sixteen digits: at 1e15 s they go on by an eighth of a second.
pub const LATEST: f64 = 1e15;

impl Settings {
    /// Shortest time by which the run can get on near its end, s: steps, samples and rows cannot be closer.
    pub fn resolution(&self) -> f64 {
        4.0 * f64::EPSILON * self.stop_time
    }
}

/// Where a run begins.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Start {
    /// At the initial values that the blocks give.
    #[default]
    Given,
    /// In a steady state near them.
    Steady(Steady),
}

/// What a steady state is to fulfil besides that nothing moves (a *trim*).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Steady {
    /// Signals that must have a value there.
    pub hold: Vec<Held>,
    /// Constants whose values are found; those that are written are where the search begins.
    pub free: Vec<Free>,
    /// States, or blocks with all of theirs, that stay as they are written and may go on moving.
    pub drift: Vec<String>,
}

/// A signal that must have a value.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// As it was asked for.
    pub name: String,
    /// Cell among the signals.
    pub cell: usize,
    /// In SI units.
    pub value: f64,
    /// What the value is measured in, if it is written.
    pub dimension: Option<Dimension>,
}

/// A number of a `Constant` that is to be found.
#[derive(Debug, Clone, PartialEq)]
pub struct Free {
    /// Block and parameter: `volts.value`; of a list one element, `both.value[1]`.
    pub name: String,
    /// Index in `Schedule::blocks`.
    pub block: usize,
    /// Cell among the signals.
    pub cell: usize,
    /// What is measured, if anything says it.
    pub dimension: Option<Dimension>,
}

/// Which instants are recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OutputTimes {
    /// Every major step.
    Steps,
    /// Start, end and a grid with this spacing, s. Events are recorded as well.
    Every(f64),
}

/// Methods by the names that users write.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solver {
    /// A method of fixed step.
    Fixed {
        /// Which one.
        method: FixedMethod,
        /// Step, s.
        step: f64,
    },
    /// A method that chooses its step.
    Variable {
        /// Which one.
        method: VariableMethod,
        /// Relative tolerance.
        rtol: f64,
        /// Absolute tolerance, in SI units of each state; found from the size that each state has had if none is given.
        atol: Option<f64>,
        /// Largest step, s; infinite for the default, a fiftieth of the run.
        max_step: f64,
    },
}

/// Methods of fixed step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FixedMethod {
    /// Euler, order 1.
    Ode1,
    /// Heun, order 2.
    Ode2,
    /// Bogacki-Shampine, order 3.
    Ode3,
    /// Classical Runge-Kutta, order 4.
    Ode4,
    /// Dormand-Prince, order 5.
    Ode5,
}

/// Methods that choose their step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VariableMethod {
    /// `Ode45`, and `Ode15s` where stability limits the steps of that.
    Auto,
    /// Bogacki-Shampine 3(2).
    Ode23,
    /// Dormand-Prince 5(4).
    Ode45,
    /// Dormand-Prince 8(5,3), for tight tolerances.
    Dop853,
    /// The trapezoidal rule, order 2, for stiff systems without numerical damping.
    Ode23t,
    /// The trapezoidal rule and a differentiation formula in each step, order 2, for stiff systems.
    Ode23tb,
    /// Numerical differentiation formulas of orders 1 to 5, for stiff systems; keeps its Jacobian.
    Ode15s,
    /// Radau IIA, order 5, for stiff systems at tight tolerances.
    Radau5,
    /// Rosenbrock, order 4, for stiff systems; computes a Jacobian.
    Rodas4,
    /// Linearly implicit, order 3; uses only what blocks say of their stiffness (friction).
    RosW3,
}
