//! Members of a network and where their values lie.

use std::ops::Range;

use blocksim_block::physical::Needs;

use crate::assembly::Member;

/// Output group of what depends on states alone.
pub(crate) const STATE: usize = 0;
/// Output group of what depends on voltages.
pub(crate) const ELECTRICS: usize = 1;
/// Output group of what depends on torques and accelerations.
pub(crate) const MOTION: usize = 2;

/// A member and where its values lie.
#[derive(Debug)]
pub(crate) struct Seat {
    pub member: Member,
    pub x: Range<usize>,
    pub d: Range<usize>,
    pub g: Range<usize>,
    pub u: Range<usize>,
    pub inputs: Vec<(u32, u32)>,
    pub y: Range<usize>,
    pub pins: Range<usize>,
    pub two_pins: Range<usize>,
    pub gears: Range<usize>,
    pub branches: Range<usize>,
    pub sources: Range<usize>,
    pub windings: Range<usize>,
    pub speed_sources: Range<usize>,
    pub joint: Option<usize>,
    pub supply: Option<usize>,
    pub is_machine: bool,
    /// Its voltages are states.
    pub is_capacitance: bool,
    /// Which outputs it has, by group, under the need that the component knows them by.
    pub measures: [Option<Needs>; 3],
}

/// Indices of the members that have something to say in a phase.
#[derive(Debug, Default)]
pub(crate) struct Active {
    pub speed_sources: Vec<usize>,
    pub machines: Vec<usize>,
    pub sources: Vec<usize>,
    pub windings: Vec<usize>,
    pub branches: Vec<usize>,
    pub states: Vec<usize>,
    pub jumps: Vec<usize>,
    pub guards: Vec<usize>,
    pub time_events: Vec<usize>,
    pub measures: [Vec<usize>; 3],
}

impl Active {
    pub(crate) fn new(seats: &[Seat]) -> Self {
        let which = |has: &dyn Fn(&Seat) -> bool| {
            seats.iter().enumerate().filter(|(_, seat)| has(seat)).map(|(i, _)| i).collect::<Vec<_>>()
        };
        Self {
            speed_sources: which(&|seat| !seat.speed_sources.is_empty()),
            machines: which(&|seat| seat.is_machine),
            sources: which(&|seat| !seat.sources.is_empty()),
            windings: which(&|seat| !seat.windings.is_empty()),
            branches: which(&|seat| !seat.branches.is_empty()),
            states: which(&|seat| !seat.x.is_empty()),
            jumps: which(&|seat| seat.member.part.jumps),
            guards: which(&|seat| !seat.g.is_empty()),
            time_events: which(&|seat| seat.member.part.time_events),
            measures: [STATE, ELECTRICS, MOTION].map(|group| which(&|seat| seat.measures[group].is_some())),
        }
    }
}
