//! What sticks in a network, and where its modes are.

use std::ops::Range;

use blocksim_block::event::{Event, Subject};
use blocksim_block::physical::LossModel;
use blocksim_block::{Crossing, Discrete, Guard, Interface};

use crate::mechanics::rotation::Rotation;
use crate::seat::Seat;

/// What sticks in a network: frictions and meshes of gears.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stiction {
    /// Where their modes lie among the discrete states.
    pub(super) modes: Range<usize>,
    /// Where their guards lie.
    pub(super) guards: Range<usize>,
    /// Where the prescribed speeds and accelerations at the end of the last step lie among the discrete states, if any of them may
    /// throw what is stuck.
    pub(crate) sources: Range<usize>,
    /// Frictions, then meshes.
    pub(super) parts: Vec<Place>,
    /// Number of frictions.
    pub(super) frictions: usize,
    /// Index of the first friction among the branches.
    pub(super) first: usize,
}

/// Where something that sticks is.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    /// Index of the pin of a friction.
    Pin(usize),
    /// Index of a gear with losses.
    Gear(usize),
}

impl Stiction {
    /// Adds modes and guards to the interface, behind those of the members.
    pub(crate) fn new(seats: &[Seat], rotation: &Rotation, interface: &mut Interface) -> Self {
        let (d, g) = (interface.discrete.len(), interface.guards.len());
        let mut parts: Vec<Place> =
            rotation.branches[rotation.smooth..].iter().map(|pin| Place::Pin(*pin)).collect();
        let frictions = parts.len();
        let gears = rotation.gears.iter().enumerate();
        let dry = gears.filter(|(_, gear)| gear.loss.model == LossModel::Stiction);
        parts.extend(dry.map(|(i, _)| Place::Gear(i)));
        for (what, of) in [
            ("friction", (|seat| seat.frictions.len()) as fn(&Seat) -> usize),
            ("mesh", |seat| seat.dry.len()),
        ] {
            for seat in seats {
                for i in 0..of(seat) {
                    let several = of(seat) > 1;
                    let number = if several { (i + 1).to_string() } else { String::new() };
                    let name = format!("{}.mode{number}", seat.member.path);
                    let detail = several.then(|| format!("{what} {number}"));
                    let subject = Subject { part: Some(seat.member.path.clone()), detail };
                    let words = seat.member.part.friction.0;
                    interface.discrete.push(Discrete::new(name.clone(), 0.0).changes(words, subject.clone()));
                    let guard = Guard { event: Event::Mode, subject, ..Guard::new(name, Crossing::Either) };
                    interface.guards.push(guard);
                }
            }
        }
        interface.jumps |= !parts.is_empty();
        let first_source = interface.discrete.len();
        let reads = |place: &Place| match place {
            Place::Pin(pin) => !rotation.pins[*pin].prescribed.is_empty(),
            Place::Gear(gear) => !rotation.gears[*gear].base_prescribed.is_empty(),
        };
        if parts.iter().any(reads) {
            for what in ["speed", "acceleration"] {
                for k in 0..rotation.sources {
                    interface.discrete.push(Discrete::new(format!("prescribed.{what}[{k}]"), 0.0));
                }
            }
            interface.accepts = true;
        }
        Self {
            sources: first_source..interface.discrete.len(),
            modes: d..d + parts.len(),
            guards: g..g + parts.len(),
            parts,
            frictions,
            first: rotation.smooth,
        }
    }

    /// Number of parts that stick.
    pub(crate) fn len(&self) -> usize {
        self.parts.len()
    }

    /// Number of meshes that stick.
    pub(crate) fn meshes(&self) -> usize {
        self.parts.len() - self.frictions
    }

    /// The modes among discrete states.
    pub(super) fn of<'a>(&self, d: &'a [f64]) -> &'a [f64] {
        d.get(self.modes.clone()).unwrap_or(&[])
    }
}

/// What is to be decided about a friction at an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rest {
    /// Nothing: it slides in this direction.
    Moves(f64),
    /// Whether it sticks, and which way it slides otherwise.
    Stands,
    /// Which way it slides; nothing holds it.
    Free,
    /// Nothing: nothing presses it.
    Open,
}
