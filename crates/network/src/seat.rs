//! Members of a network and where their values lie.

use std::ops::Range;
use std::sync::Arc;

use blocksim_block::physical::{Component, ElementPlace, Needs};
use blocksim_block::{Block, Context};

use crate::electrics::{Electrics, GivenBy, Island, Joined};
use crate::member::Member;
use crate::readings::{Givers, Read, Shown};

/// Output group of what depends on states alone.
pub(crate) const STATE: usize = 0;
/// Output group of what depends on voltages.
pub(crate) const ELECTRICS: usize = 1;
/// Output group of what depends on torques and accelerations.
pub(crate) const MOTION: usize = 2;
/// Output group of the electrical readings that depend on states alone. Apart from the other readings of states, because
/// drives ask for them in every minor step and for the rest only controllers and scopes do.
pub(crate) const CHARGE: usize = 3;

/// A member and where its values lie. An evaluation reads all seats some times over: they should be small.
#[derive(Debug)]
pub(crate) struct Seat {
    pub member: Box<Member>,
    /// That of the member.
    pub block: Arc<dyn Block>,
    pub x: Range<usize>,
    pub d: Range<usize>,
    pub g: Range<usize>,
    /// The network integrates it by itself; `x` and `d` are then places among the discrete states.
    pub held: Option<Held>,
    pub u: Range<usize>,
    pub inputs: Vec<(u32, u32)>,
    pub y: Range<usize>,
    pub pins: Range<usize>,
    pub two_pins: Range<usize>,
    pub gears: Range<usize>,
    pub branches: Range<usize>,
    pub frictions: Range<usize>,
    /// Meshes with stiction.
    pub dry: Range<usize>,
    pub sources: Range<usize>,
    pub windings: Range<usize>,
    pub valves: Range<usize>,
    /// Elements that have a name.
    pub places: Vec<ElementPlace>,
    /// Whether each two-pin is a resistance or a valve, whose heat the network books; nothing where the member has no port for it.
    pub dissipates: Vec<bool>,
    /// Two-pins of the windings whose currents are states.
    pub winding_pins: Vec<usize>,
    pub speed_sources: Range<usize>,
    /// Speeds of its joint, as it counts them.
    pub joint: Range<usize>,
    /// Index of the ball of its joint.
    pub ball: Option<usize>,
    /// Frames that it looks at.
    pub frames: Range<usize>,
    /// Where its supply lies: that of the source that feeds it, or its own.
    pub supply: Option<usize>,
    /// Of a machine in a circuit: the supply of the source that it hangs at, and whether contacts may exchange phases on the way.
    pub grid: Option<(usize, bool)>,
    pub role: Role,
    /// Where its states lie as they are with what sources in loops of capacitances add to them.
    pub shifted: Option<usize>,
    /// Its voltages are states.
    pub is_capacitance: bool,
    /// Its readings follow from states alone.
    pub is_early: bool,
    /// Which outputs the component computes, by group, under the need that it knows them by.
    pub measures: [Vec<Needs>; 4],
    /// The outputs that are numbers of the network.
    pub reads: Vec<Read>,
    /// The voltages and currents that it gives as it finds them.
    pub gives: Givers,
    /// Of which lists it has a share.
    pub shares: Shares,
}

/// Of which lists a member has a share. Most have one of few, and the laws of all are put together some hundred times in an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Shares(u8);

impl Shares {
    pub(crate) const INPUTS: Self = Self(1);
    pub(crate) const PINS: Self = Self(1 << 1);
    pub(crate) const MODES: Self = Self(1 << 2);
    pub(crate) const TWO_PINS: Self = Self(1 << 3);
    pub(crate) const SUPPLY: Self = Self(1 << 4);
    /// It sees a joint or a frame.
    pub(crate) const SPACE: Self = Self(1 << 5);
    /// Sources add to its states.
    pub(crate) const OWN: Self = Self(1 << 6);
    pub(crate) const GEARS: Self = Self(1 << 7);

    /// Those of a seat whose other values are final.
    pub(crate) fn of(seat: &Seat) -> Self {
        let has = [
            (!seat.u.is_empty(), Self::INPUTS),
            (!seat.pins.is_empty(), Self::PINS),
            (!(seat.frictions.is_empty() && seat.dry.is_empty()), Self::MODES),
            (!seat.two_pins.is_empty(), Self::TWO_PINS),
            (seat.supply.is_some(), Self::SUPPLY),
            (!seat.joint.is_empty() || seat.ball.is_some() || !seat.frames.is_empty(), Self::SPACE),
            (seat.shifted.is_some(), Self::OWN),
            (!seat.gears.is_empty(), Self::GEARS),
        ];
        Self(has.into_iter().filter(|(has, _)| *has).fold(0, |all, (_, one)| all | one.0))
    }

    #[inline(always)]
    pub(crate) fn has(self, share: Self) -> bool {
        self.0 & share.0 != 0
    }
}

/// Where a member that the network integrates by itself has its values at the end of a coupling step, all among the
/// discrete states.
#[derive(Debug, Clone)]
pub(crate) struct Held {
    /// Times of the beginning and the end of the step.
    pub times: usize,
    pub x_end: Range<usize>,
    pub d_end: Range<usize>,
    /// Mean torque of each branch, and by how much the straight line that stands for its course is more at the end of the step.
    pub torque: Range<usize>,
    pub course: Range<usize>,
    /// Means over the step: states, voltages and currents of the two-pins, space vector and zero sequence of the supply.
    pub mean: Range<usize>,
    /// Cells of outputs that show the beginning of the step, not means: states, currents and fluxes.
    pub instants: Vec<usize>,
    /// Integrals of the same since the last hit, where the coupling step is taken in parts.
    pub sum: Range<usize>,
    /// These integrals as they were when the step at hand began.
    pub sum_before: Range<usize>,
    /// Impulse of each branch that the mechanics lacked at the beginning of the step, and what the step gives of it, N*m*s.
    pub owed: Range<usize>,
    pub given: Range<usize>,
    /// Speed and acceleration of each pin at the beginning of the step.
    pub speed: Range<usize>,
    pub acceleration: Range<usize>,
    /// By how much the speed of each pin has jumped since then.
    pub struck: Range<usize>,
    /// Speed of each pin that is expected at the end of the step, and how much more than by torques and accelerations at its
    /// beginning the speeds have changed in the last step and in the one before.
    pub expected: Range<usize>,
    pub bent: Range<usize>,
    pub bent_before: Range<usize>,
    /// Where it lies how far off speeds have been of late, and the greatest speed so far.
    pub missed: usize,
    /// What [`errors`](Self::errors) divides.
    pub errors: Range<usize>,
    /// What the last steps say of the inputs, each in so many cells as [`InputCells`](crate::electrics::inputs::InputCells) counts.
    pub inputs: Range<usize>,
}

impl Held {
    /// Where it lies for a pin what the coupling does to its speed: in a step, summed up, and that at most; and how much loads bend the
    /// speed in a step, and the mean change in it, of late.
    pub(crate) fn errors(&self, pin: usize) -> [usize; 5] {
        [0, 1, 2, 3, 4].map(|k| self.errors.start + 5 * pin + k)
    }

    /// Where in its coupling step an instant lies: from -1 at the beginning to 1 at the end.
    pub(crate) fn place(&self, c: &Context) -> f64 {
        let (begin, end) = (c.d[self.times], c.d[self.times + 1]);
        let half = 0.5 * (end - begin);
        if half > 0.0 && half.is_finite() { ((c.t - begin) / half - 1.0).clamp(-1.0, 1.0) } else { 0.0 }
    }
}

impl Seat {
    /// The laws of the member.
    #[inline(always)]
    pub(crate) fn component(&self) -> Option<&dyn Component> {
        self.block.component()
    }

    /// States and discrete states of the member.
    #[inline]
    pub(crate) fn states<'a>(&self, c: &Context<'a>) -> (&'a [f64], &'a [f64]) {
        let of = |list: &'a [f64], range: &Range<usize>| list.get(range.clone()).unwrap_or(&[]);
        match &self.held {
            None => (of(c.x, &self.x), of(c.d, &self.d)),
            Some(held) if c.d.get(held.times + 1).is_some_and(|end| c.t >= *end) => {
                (of(c.d, &held.x_end), of(c.d, &held.d_end))
            }
            Some(_) => (of(c.d, &self.x), of(c.d, &self.d)),
        }
    }
}

/// What a member is in a three-phase system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// Gives a supply: directly to machines, or to a circuit.
    Source,
    /// A machine that an ideal source feeds directly.
    Fed,
    /// A machine in a circuit.
    Machine(Joined),
    Other,
}

/// Indices of the members that have something to say in a phase.
#[derive(Debug, Default)]
pub(crate) struct Active {
    pub speed_sources: Vec<usize>,
    /// Ideal sources that feed machines directly, and these machines.
    pub sources: Vec<usize>,
    pub fed: Vec<usize>,
    /// Members of circuits with voltages or currents of their own.
    pub circuit: Vec<usize>,
    pub branches: Vec<usize>,
    pub joints: Vec<usize>,
    pub frames: Vec<usize>,
    pub frictions: Vec<usize>,
    pub dry: Vec<usize>,
    pub states: Vec<usize>,
    pub jumps: Vec<usize>,
    /// Circuits with valves.
    pub valves: Vec<usize>,
    pub guards: Vec<usize>,
    /// None of them needs torques, voltages or currents.
    pub guards_of_state: bool,
    pub time_events: Vec<usize>,
    pub measures: [Vec<usize>; 4],
    /// Outputs that are numbers of the network, by group.
    pub shown: [Vec<Shown>; 4],
    /// Whether a member measures how frames accelerate.
    pub accelerations: bool,
    /// The members of each circuit, by what they do in it.
    pub islands: Vec<OfIsland>,
}

/// Members of a circuit that there is something to ask: most resistors only stand in its equations.
#[derive(Debug, Clone, Default)]
pub(crate) struct OfIsland {
    /// They give voltages.
    pub voltages: Vec<usize>,
    /// They give currents.
    pub currents: Vec<usize>,
    /// All these currents follow from states, and from those as the solver has them.
    pub follows_states: bool,
    /// They have space vectors.
    pub vectors: Vec<usize>,
}

impl Active {
    pub(crate) fn new(seats: &[Seat], electrics: &Electrics) -> Self {
        let of_island = |island: &Island| {
            let which = |has: &dyn Fn(&Seat) -> bool| {
                island.members.iter().copied().filter(|i| has(&seats[*i])).collect::<Vec<_>>()
            };
            OfIsland {
                voltages: which(&|seat| !seat.sources.is_empty()),
                currents: which(&|seat| !seat.windings.is_empty()),
                follows_states: which(&|seat| !seat.windings.is_empty()).iter().map(|i| &seats[*i]).all(
                    |seat| {
                        let by_state = |i: usize| electrics.windings[i] == GivenBy::State;
                        seat.shifted.is_none() && seat.windings.clone().all(by_state)
                    },
                ),
                vectors: which(&|seat| seat.supply.is_some()),
            }
        };
        let which = |has: &dyn Fn(&Seat) -> bool| {
            seats.iter().enumerate().filter(|(_, seat)| has(seat)).map(|(i, _)| i).collect::<Vec<_>>()
        };
        Self {
            speed_sources: which(&|seat| !seat.speed_sources.is_empty()),
            sources: which(&|seat| seat.role == Role::Source && seat.sources.is_empty()),
            fed: which(&|seat| seat.role == Role::Fed),
            circuit: which(&|seat| {
                seat.held.is_none() && (!seat.sources.is_empty() || !seat.windings.is_empty())
            }),
            branches: which(&|seat| !seat.branches.is_empty()),
            joints: which(&|seat| !seat.joint.is_empty()),
            frames: which(&|seat| !seat.frames.is_empty()),
            frictions: which(&|seat| !seat.frictions.is_empty()),
            dry: which(&|seat| !seat.dry.is_empty()),
            states: which(&|seat| seat.held.is_none() && !seat.x.is_empty()),
            jumps: which(&|seat| seat.held.is_none() && seat.member.part.jumps),
            valves: Vec::new(),
            islands: electrics.islands.iter().map(of_island).collect(),
            guards: which(&|seat| !seat.g.is_empty()),
            guards_of_state: seats
                .iter()
                .all(|seat| seat.g.is_empty() || seat.held.is_none() && seat.member.part.guards_of_state),
            time_events: which(&|seat| seat.held.is_none() && seat.member.part.time_events),
            measures: [STATE, ELECTRICS, MOTION, CHARGE].map(|group| which(&|seat| seat.is_asked(group))),
            shown: [STATE, ELECTRICS, MOTION, CHARGE].map(|group| Shown::of(seats, group)),
            accelerations: seats
                .iter()
                .any(|seat| !seat.frames.is_empty() && !seat.measures[MOTION].is_empty()),
        }
    }
}
