//! What sticks in a network, and where its modes are.

use std::ops::Range;

use blocksim_block::event::{Event, Subject};
use blocksim_block::physical::LossModel;
use blocksim_block::{Crossing, Discrete, Guard, Interface};

use super::ROUNDING;
use crate::assembly::eliminate::Form;
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
    /// Meshes that cannot stand without each friction, nor it without them: all turn by fixed ratios.
    pub(super) beside: Vec<Vec<usize>>,
}

/// Whether one speed is the other one times a ratio, whatever moves.
fn are_parallel(a: (&Form, &Form), b: (&Form, &Form)) -> bool {
    let Some(ratio) = a.0.terms().first().zip(b.0.terms().first()).map(|(a, b)| a.1 / b.1) else {
        return false;
    };
    let same = |a: &Form, b: &Form| {
        let terms = || a.terms().iter().zip(b.terms());
        let agree = |((i, x), (k, y)): (&(u32, f64), &(u32, f64))| {
            i == k && (x - ratio * y).abs() <= ROUNDING * x.abs()
        };
        a.terms().len() == b.terms().len() && terms().all(agree)
    };
    same(a.0, b.0) && same(a.1, b.1)
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
        let forms = |place: &Place| match place {
            Place::Pin(pin) => (&rotation.pins[*pin].speed, &rotation.pins[*pin].prescribed),
            Place::Gear(gear) => (&rotation.gears[*gear].base, &rotation.gears[*gear].base_prescribed),
        };
        let beside = |friction: &Place| {
            let of = forms(friction);
            let meshes = parts.iter().enumerate().skip(frictions);
            meshes.filter(|(_, mesh)| are_parallel(of, forms(mesh))).map(|(i, _)| i).collect()
        };
        let beside = parts[..frictions].iter().map(beside).collect();
        Self {
            beside,
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

/// Sets of parts that are tried one after the other: all of a few; of many, those without one of them.
pub(super) struct Sets {
    pub parts: usize,
}

impl Sets {
    /// Parts of which all sets are tried.
    const FEW: usize = 10;

    pub fn len(&self) -> usize {
        if self.parts <= Self::FEW { 1 << self.parts } else { self.parts }
    }

    /// Whether a part is in a set.
    pub fn has(&self, set: usize, part: usize) -> bool {
        if self.parts <= Self::FEW { set >> part & 1 == 1 } else { part != set }
    }
}
