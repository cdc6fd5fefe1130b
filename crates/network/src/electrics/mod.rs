//! Potentials and currents: how they follow from sources, windings, resistances and valves.
//!
//! The electrical elements of a network fall into islands that share no node but ground. In each island, modified
//! nodal analysis is solved once for every set of valves that has conducted together so far ([`Solved`]); voltages and
//! currents are then linear forms over what components give: voltages of sources and capacitances, currents of
//! windings.
//!
//! | file | idea |
//! |---|---|
//! | `collect` | from elements to islands of two-pins |
//! | `solved` | nodal analysis for one set of conducting valves |
//! | `sparse` | elimination that keeps chains cheap |
//! | `loops` | voltages of capacitances that depend on each other |
//! | `slopes` | whose slope the currents in such loops ask for |
//! | `floating` | potentials of nodes where only inductances meet |
//! | `faults` | what is wrong with a circuit, in words |
//! | `early` | readings that follow from states alone |
//!
//! An evaluation then goes through these:
//!
//! | file | idea |
//! |---|---|
//! | `currents` | supplies, voltages and currents |
//! | `circuits` | the solutions that are kept, one for each set of conducting valves |
//! | `float` | potentials of the parts that float |
//! | `convert` | transformers whose ratio varies |
//! | `characteristics` | currents that follow from voltages by a law of their own |
//! | `heats` | heat that leaves parts by thermal ports, after torques |
//! | `commutation` | which valves conduct, chosen at events |
//! | `margin` | how far a valve is from having to change: verdict and guard |
//! | `cuts` | currents of inductances that current sources decide |
//! | `charges` | what capacitances do when a valve closes a loop of them |
//! | `drift` | where the margins go from here |
//! | `arc` | currents that have lost their path |
//! | `separate` | circuits that the network integrates by itself |
//! | `coupling` | how they and the mechanics fit together |

pub(crate) mod arc;
pub(crate) mod characteristics;
pub(crate) mod charges;
pub(crate) mod circuits;
pub(crate) mod commutation;
pub(crate) mod convert;
pub(crate) mod coupling;
pub(crate) mod currents;
pub(crate) mod cuts;
pub(crate) mod drift;
pub(crate) mod float;
pub(crate) mod heats;
pub(crate) mod inputs;
pub(crate) mod loops;
pub(crate) mod margin;
pub(crate) mod repeat;
mod separate;

mod collect;
mod conducting;
mod early;
mod faults;
mod floating;
mod slopes;
mod solved;
mod sparse;

use std::ops::Range;

use blocksim_block::physical::{Domain, ElementPlace, ValveKind};

use crate::assembly::eliminate::Form;
use crate::assembly::members::Members;
use crate::problem::NetworkProblem;

pub(crate) use conducting::{Conducting, Unsolvable};
pub(crate) use floating::{Crossing, Floating, coordinates};
pub(crate) use solved::{Solved, solve};

/// What a current that a component gives depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GivenBy {
    /// States alone.
    State,
    /// Inputs.
    Input,
    /// The voltage at the same instant.
    Voltage,
    /// The ratio of a variable transformer: it is the current of its secondary.
    Ratio,
    /// Voltages at the same instant, by a law that the network solves.
    Characteristic,
    /// What becomes heat, after torques.
    Heat,
}

/// Where the electrical values of a member lie.
#[derive(Debug, Clone, Default)]
pub(crate) struct Places {
    pub two_pins: Range<usize>,
    /// Among the given voltages.
    pub sources: Range<usize>,
    /// Among the given currents.
    pub windings: Range<usize>,
    pub valves: Range<usize>,
    /// Variable transformers.
    pub transformers: Range<usize>,
    /// Characteristics.
    pub characteristics: Range<usize>,
    /// Elements that have a name.
    pub named: Vec<ElementPlace>,
    /// Whether each two-pin is a resistance or a valve, whose heat the network books; nothing where the member has no port for it.
    pub dissipates: Vec<bool>,
    /// The island, if it has electrical elements.
    pub island: Option<usize>,
    /// How the three phases of a machine are connected, unless a source feeds it directly.
    pub machine: Option<Joined>,
}

/// How the windings of a machine appear in a circuit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Joined {
    /// Two independent voltages and currents, from phases a and b to phase c.
    Inside,
    /// Three separate windings.
    Outside,
}

/// A valve.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Valve {
    pub member: usize,
    pub kind: ValveKind,
    pub forward_voltage: f64,
    /// Current at the forward voltage, A: that of the leakage, below which it lets go.
    pub holding_current: f64,
    /// What rounding of the voltages leaves of that current, A: while it conducts, it is a difference of voltages over little resistance.
    pub rounding_current: f64,
    pub two_pin: usize,
}

/// A transformer whose ratio changes while the network runs: the voltage of its primary and the current of its secondary
/// are given values that the network finds itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Variable {
    /// Two-pin of the primary; the next one is the secondary.
    pub two_pin: usize,
    /// Index of the voltage of the primary among the given values.
    pub voltage: usize,
    /// Index of the current of the secondary among the given values.
    pub current: usize,
}

/// A current that follows from voltages by the law of a component. It is divided: `conductance` times its voltage is part of the
/// equations of the circuit, the rest is a given value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Characteristic {
    /// Two-pin.
    pub two_pin: usize,
    /// Index of the rest of its current among the given values.
    pub rest: usize,
    /// S.
    pub conductance: f64,
    /// Where the first search for its voltage begins, and the discrete state with that of the last major step, where others do.
    pub first_guess: f64,
    pub guess: Option<usize>,
}

/// Heat that leaves a part by a thermal port.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Heat {
    pub member: usize,
    /// Two-pin.
    pub two_pin: usize,
    /// Index of its flow among the given values, negative.
    pub given: usize,
}

/// Where the current of a two-pin comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Branch {
    /// A prescribed voltage: index among the given values.
    Source(usize),
    /// A wire whose current is looked at.
    Wire,
    /// Index among the given values.
    Given(usize),
    /// Conductance, S.
    Conductance(f64),
    /// A conductance, S, and beside it a given value: index among them.
    Characteristic(f64, usize),
    /// Index among the valves of the island.
    Valve { index: usize, on_resistance: f64, forward_voltage: f64, off_conductance: f64 },
    /// Only looks at the voltage.
    Probe,
    /// Primary of an ideal transformer, with its ratio; the next two-pin is the secondary.
    Primary(f64),
    /// Secondary of an ideal transformer.
    Secondary,
    /// Primary of a variable transformer: index of its voltage among the given values.
    Variable(usize),
}

/// A two-pin of an island. Nodes are those of the island, `None` is ground.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TwoPin {
    pub member: usize,
    /// Index among all two-pins.
    pub index: usize,
    pub p: Option<usize>,
    pub n: Option<usize>,
    pub branch: Branch,
    pub domain: Domain,
}

/// A voltage that is a state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Capacitance {
    /// Index of its voltage among the given values.
    pub source: usize,
    pub member: usize,
    /// Its place among the states of the member.
    pub state: usize,
    /// F.
    pub capacitance: f64,
    /// Voltage at the start, if it is given, V.
    pub start: Option<f64>,
    /// The discrete state that holds the sum of its jumps, V, if charges may divide there.
    pub jumps: Option<usize>,
}

/// What the sources in its loops add to the voltage of a capacitance: the state holds the rest.
#[derive(Debug, Clone)]
pub(crate) struct Shift {
    /// Index of the voltage among the given values.
    pub source: usize,
    pub member: usize,
    /// Place among the states of the member.
    pub state: usize,
    /// Over the given values.
    pub by: Form,
}

/// Elements that are connected electrically.
#[derive(Debug, Clone, Default)]
pub(crate) struct Island {
    /// Members, ascending.
    pub members: Vec<usize>,
    pub two_pins: Vec<TwoPin>,
    /// Index of each node of the island among all nodes, for messages.
    pub nodes: Vec<usize>,
    /// Index of each valve of the island among all valves.
    pub valves: Vec<usize>,
    /// Variable transformers: position of the primary among the two-pins of the island, and index among all of them.
    pub transformers: Vec<(usize, usize)>,
    /// Characteristics: position among the two-pins of the island, and index among all of them.
    pub characteristics: Vec<(usize, usize)>,
    /// Heat of parts: position among the two-pins of the island, and index among all of them.
    pub heats: Vec<(usize, usize)>,
    /// Voltages of capacitances that sources in their loops add to.
    pub shifts: Vec<Shift>,
    /// Members that tell how fast their voltages or currents change.
    pub rated: Vec<usize>,
    /// Members whose currents depend on those of current sources: their states are without what these have moved.
    pub in_cuts: Vec<usize>,
    /// Loops of capacitances that are there whatever valves do.
    pub loops: Option<loops::Law>,
    /// Valves may close loops of capacitances.
    pub divides: bool,
    /// All given values but currents of windings stay as they are until inputs or discrete states change.
    pub holds: bool,
    /// Some current follows from a voltage at the same instant.
    pub waits: bool,
    /// Some current is a state.
    pub has_windings: bool,
    /// Length of a coupling step, if the network integrates the island by itself.
    pub separate: Option<f64>,
    /// Where the discrete states lie that remember how large its voltages and currents have been.
    pub size: Option<usize>,
}

/// The electrical side of a network.
#[derive(Debug, Clone, Default)]
pub(crate) struct Electrics {
    pub places: Vec<Places>,
    /// Number of voltages that components give: the first of the given values. Then come currents, then the slopes of those
    /// voltages and currents that others ask for, then the number 1.
    pub sources: usize,
    /// Those of them that are voltages of capacitances, ascending.
    pub capacitances: Vec<Capacitance>,
    /// The voltages and currents whose slopes are among the given values, ascending, and whether anything tells them.
    pub slopes: Vec<(usize, bool)>,
    /// Whether somebody looks at the voltage or the current of each two-pin.
    pub looked: Vec<bool>,
    /// What each current that a component gives depends on.
    pub windings: Vec<GivenBy>,
    /// Number of two-pins.
    pub two_pins: usize,
    pub valves: Vec<Valve>,
    pub transformers: Vec<Variable>,
    pub characteristics: Vec<Characteristic>,
    /// Those of one member follow each other.
    pub heats: Vec<Heat>,
    pub islands: Vec<Island>,
    /// Voltage or current of each two-pin that is a sensor whose reading follows from states alone.
    pub early: Vec<Option<Early>>,
}

/// A circuit that the network integrates by itself.
#[derive(Debug, Clone)]
pub(crate) struct Separate {
    pub island: usize,
    pub members: Vec<usize>,
    /// Length of a coupling step, s.
    pub step: f64,
    /// Discrete states with the times of the beginning and the end of the current step; behind them what [`cells`](Self::cells)
    /// names.
    pub times: usize,
}

/// Where it lies how a circuit takes its coupling step in parts.
pub(crate) struct Cells {
    /// How many parts the present coupling step has, 0 before the first.
    pub parts: usize,
    /// How many of them are still to come, and when the next one does.
    pub left: usize,
    pub until: usize,
    /// Relative tolerance of the run; 0 with a method of fixed step.
    pub rtol: usize,
    /// The greatest error in a coupling step since one was last tried, over what the tolerance allows.
    pub need: usize,
    /// Parts below which it does not go any more; 0 or 1 while its coupling steps are whole.
    pub least: usize,
    /// The same as `outlasts`, remembered over the last trials of divided steps, and the greatest of that.
    pub lasting: usize,
    pub most: usize,
    /// Length of the last coupling step, or part of one, s.
    pub span: usize,
    /// When inputs were noted last, s.
    pub noted: usize,
    /// The same within the step at hand, s, and the sum of the cubes of the lengths between, s^3.
    pub since: usize,
    pub cubes: usize,
    /// [`CUT`](repeat::CUT) where the step at hand is what is left of one in which an input has jumped; less by one with each step.
    pub cut: usize,
    /// 1 where the step at hand must end because parameters change.
    pub interrupted: usize,
    /// The same as `need`, of speeds and of the states of what gives torques alone: what others are off by shows in these.
    pub outlasts: usize,
}

impl Separate {
    /// Whether its last step, or the last part of one, ends at `t`.
    pub(crate) fn is_due(&self, t: f64, d: &[f64]) -> bool {
        t >= d[self.times + 1]
    }

    pub(crate) fn cells(&self) -> Cells {
        let [
            parts,
            left,
            until,
            rtol,
            need,
            least,
            lasting,
            most,
            span,
            noted,
            since,
            cubes,
            cut,
            interrupted,
            outlasts,
        ] = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16].map(|k| self.times + k);
        Cells {
            parts,
            left,
            until,
            rtol,
            need,
            least,
            lasting,
            most,
            span,
            noted,
            since,
            cubes,
            cut,
            interrupted,
            outlasts,
        }
    }

    /// The circuits that ask for it; where they lie is not known yet.
    pub(crate) fn of(electrics: &Electrics) -> Vec<Self> {
        let islands = electrics.islands.iter().enumerate();
        islands
            .filter_map(|(index, island)| {
                let step = island.separate?;
                Some(Self { island: index, members: island.members.clone(), step, times: 0 })
            })
            .collect()
    }
}

/// A reading over the given values.
#[derive(Debug, Clone)]
pub(crate) enum Early {
    Voltage(Form),
    Current(Form),
}

impl Electrics {
    /// Whether energy is stored in fields that follow from potentials, not from states.
    pub(crate) fn has_fields(&self) -> bool {
        self.islands.iter().flat_map(|island| &island.two_pins).any(|pin| pin.domain == Domain::Magnetic)
    }

    /// Number of given values.
    pub(crate) fn given(&self) -> usize {
        self.sources + self.windings.len() + self.slopes.len() + 1
    }

    /// The capacitance that gives the voltage of a branch.
    pub(crate) fn capacitance(&self, branch: &Branch) -> Option<&Capacitance> {
        let Branch::Source(index) = branch else { return None };
        let place = self.capacitances.binary_search_by_key(index, |c| c.source);
        place.ok().map(|place| &self.capacitances[place])
    }

    /// Where the slope of a given voltage or current lies among the given values.
    pub(crate) fn slope_of(&self, source: usize) -> Option<usize> {
        let place = self.slopes.binary_search_by_key(&source, |slope| slope.0);
        place.ok().map(|place| self.sources + self.windings.len() + place)
    }

    /// Whether current sources decide about the current of a winding.
    pub(crate) fn follows(&self, winding: usize) -> bool {
        let member = self.places.iter().position(|places| places.windings.contains(&winding));
        member.is_some_and(|member| self.islands.iter().any(|island| island.in_cuts.contains(&member)))
    }

    /// Two-pins of the windings of a member whose currents are states.
    pub(crate) fn winding_pins(&self, member: usize) -> Vec<usize> {
        let Some(island) = self.places[member].island else { return Vec::new() };
        let pins = self.islands[island].two_pins.iter().filter(|pin| pin.member == member);
        let of_state = |branch: &Branch| match branch {
            Branch::Given(index) => self.windings[index - self.sources] == GivenBy::State,
            _ => false,
        };
        pins.filter(|pin| of_state(&pin.branch)).map(|pin| pin.index).collect()
    }

    /// Valves that conduct by themselves, in circuits that the solver integrates.
    pub(crate) fn natural(&self) -> Vec<usize> {
        let natural = |valve: &usize| self.valves[*valve].kind != ValveKind::Switch;
        let islands = self.islands.iter().filter(|island| island.separate.is_none());
        islands.flat_map(|island| island.valves.iter().copied().filter(natural)).collect()
    }
}

/// Finds the islands of a network and what is wrong with them. `fed` tells which members are supplies and machines
/// that need no circuit, because an ideal source feeds the machines directly.
pub(crate) fn build(m: &Members, fed: &[bool]) -> Result<Electrics, Vec<NetworkProblem>> {
    let mut electrics = collect::collect(m, fed);
    slopes::declare(m, &mut electrics);
    let mut problems = Vec::new();
    for island in &electrics.islands {
        problems.extend(faults::faults(m, &electrics, island));
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    electrics.early = early::readings(&electrics);
    Ok(electrics)
}
