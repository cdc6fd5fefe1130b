//! Room for what is solved about circuits.

use blocksim_block::physical::Torque;

use crate::electrics::inputs::Course;
use crate::electrics::{Electrics, Island};
use crate::network::Network;

/// Room for the variable transformers of an island.
#[derive(Debug, Default)]
pub(crate) struct Convert {
    pub ratio: Vec<f64>,
    /// `1 - R M` by rows, and `R f`.
    pub matrix: Vec<f64>,
    pub right: Vec<f64>,
}

impl Convert {
    pub(crate) fn new(electrics: &Electrics) -> Self {
        let n = 2 * electrics.islands.iter().map(|island| island.transformers.len()).max().unwrap_or(0);
        Self {
            ratio: vec![0.0; electrics.transformers.len()],
            matrix: Vec::with_capacity(n * n),
            right: Vec::with_capacity(n),
        }
    }
}

/// Room for characteristics. What is unknown in an island are their voltages, then two values for each variable transformer.
#[derive(Debug, Default)]
pub(crate) struct CharacteristicRoom {
    /// Voltage and current of all characteristics, by their numbers, as they were found last.
    pub voltage: Vec<f64>,
    pub current: Vec<f64>,
    /// Slopes of the currents of one member.
    pub slope: Vec<f64>,
    /// Which unknown each given value follows from; [`u32::MAX`] for none.
    pub unknown_of: Vec<u32>,
    /// How what the equations say changes with the given values that follow from unknowns, by rows.
    pub coupling: Vec<f64>,
    /// What the equations say apart from these.
    pub offset: Vec<f64>,
    pub unknown: Vec<f64>,
    pub trial: Vec<f64>,
    pub residual: Vec<f64>,
    /// Given values at the voltages that are tried.
    pub given: Vec<f64>,
    /// Sizes of the terms that the given values are differences of.
    pub terms: Vec<f64>,
    /// The greatest part of its terms that is left of an equation at the voltages that are tried.
    pub noise: f64,
    pub step: Vec<f64>,
    /// The step that is left at a trial, and what the unknowns are measured in.
    pub left_step: Vec<f64>,
    pub units: Vec<f64>,
    pub jacobian: Vec<f64>,
    /// Slopes of given values over unknowns, by rows.
    pub slopes: Vec<f64>,
    pub pivots: Vec<usize>,
    pub ratio: Vec<f64>,
    /// Voltages on the way, for a message.
    pub way: Vec<f64>,
    /// A characteristic whose law had no value where it was tried last without one, and what was tried there.
    pub outside: Option<usize>,
    pub tried: Vec<f64>,
}

impl CharacteristicRoom {
    pub(crate) fn new(electrics: &Electrics) -> Self {
        let all = electrics.characteristics.len();
        if all == 0 {
            return Self::default();
        }
        let unknowns = |island: &Island| match island.characteristics.len() {
            0 => 0,
            n => n + 2 * island.transformers.len(),
        };
        let n = electrics.islands.iter().map(unknowns).max().unwrap_or(0);
        let most = electrics.places.iter().map(|places| places.characteristics.len()).max().unwrap_or(0);
        let (vector, square) = (|| vec![0.0; n], || vec![0.0; n * n]);
        let mut unknown_of = vec![u32::MAX; electrics.given()];
        for island in electrics.islands.iter().filter(|island| !island.characteristics.is_empty()) {
            let rest = island.characteristics.iter().map(|(_, i)| electrics.characteristics[*i].rest);
            let ratio = island.transformers.iter().flat_map(|(_, i)| {
                let transformer = &electrics.transformers[*i];
                [transformer.voltage, transformer.current]
            });
            rest.chain(ratio).enumerate().for_each(|(k, given)| unknown_of[given] = k as u32);
        }
        Self {
            voltage: vec![0.0; all],
            current: vec![0.0; all],
            slope: Vec::with_capacity(most * most),
            unknown_of,
            coupling: square(),
            offset: vector(),
            unknown: vector(),
            trial: vector(),
            residual: vector(),
            given: vector(),
            terms: vector(),
            noise: f64::INFINITY,
            step: vector(),
            left_step: vector(),
            units: vector(),
            jacobian: square(),
            slopes: square(),
            pivots: vec![0; n],
            ratio: vec![0.0; electrics.transformers.len()],
            way: Vec::with_capacity(8 * n),
            outside: None,
            tried: vector(),
        }
    }
}

/// Room for floating parts, sized once for an island.
#[derive(Debug, Default)]
pub(crate) struct FloatRoom {
    pub internal: Vec<f64>,
    pub inverse: Vec<f64>,
    /// `W' Gamma W` and its right-hand side.
    pub matrix: Vec<f64>,
    pub phi: Vec<f64>,
    /// `Gamma W` of one member, and the voltages of its windings.
    pub product: Vec<f64>,
    pub voltage: Vec<f64>,
    /// States of one member.
    pub state: Vec<f64>,
}

impl FloatRoom {
    pub(crate) fn new(electrics: &Electrics) -> Self {
        let most = electrics.islands.iter().map(|island| island.two_pins.len() + 3).max().unwrap_or(0);
        let (vector, square) = (|| Vec::with_capacity(most), || Vec::with_capacity(most * most));
        Self {
            internal: vector(),
            inverse: square(),
            matrix: square(),
            phi: vector(),
            product: square(),
            voltage: vector(),
            state: vector(),
        }
    }
}

/// Room for the integration of circuits.
#[derive(Debug, Default)]
pub(crate) struct Room {
    /// Discrete states of the network while a trial point is evaluated.
    pub d: Vec<f64>,
    /// States at the beginning of a step of the integrator.
    pub start: Vec<f64>,
    /// Sum of the weighted slopes, and the last slope.
    pub sum: Vec<f64>,
    pub slope: Vec<f64>,
    /// The first two slopes of a step, which tell with the third how fast the circuit is; and moments at its beginning.
    pub first: Vec<f64>,
    pub second: Vec<f64>,
    pub moment_before: Vec<f64>,
    /// How fast the circuit has been found to change in the step at hand, 1/s.
    pub pace: f64,
    /// How large each state has become in it, where it lies in `d`.
    pub largest: Vec<f64>,
    /// Speeds and accelerations of all pins at the hit.
    pub speed: Vec<f64>,
    pub acceleration: Vec<f64>,
    pub torque: Vec<Torque>,
    /// Integrals of the torques since the hit, and over the step of the integrator at hand, N*m*s.
    pub mean: Vec<f64>,
    pub gained: Vec<f64>,
    /// Integrals of the torques times the time since the middle of the coupling step, N*m*s^2.
    pub moment: Vec<f64>,
    /// Torques that the accelerations at the hit know of.
    pub base: Vec<f64>,
    /// Integral of what each torque is more than these, N*m*s.
    pub kick: Vec<f64>,
    /// What a torque of each branch changes about the acceleration of each pin, by pins.
    pub yields: Vec<f64>,
    /// How much more than by torques and accelerations at its beginning the speed of each pin is expected to change in the step, and
    /// by how much this may be wrong.
    pub bend: Vec<f64>,
    pub doubt: Vec<f64>,
    /// Length of the step at hand: the coupling step or a part of it, s.
    pub step: f64,
    /// It is a part.
    pub is_part: bool,
    /// States at the end of a trial.
    pub trial_d: Vec<f64>,
    /// The step is a trial: the doubt is added.
    pub tries: bool,
    /// Integrals of the torques over a trial, N*m*s.
    pub trial: Vec<f64>,
    /// Sums for the means of what is measured, where the discrete states will hold them.
    pub average: Vec<f64>,
    /// Branches of the members of the circuit at hand.
    pub own: Vec<usize>,
    /// Inputs of the network at a trial point, and how each of them goes on.
    pub u: Vec<f64>,
    pub courses: Vec<Course>,
    /// One of them moves.
    pub leads: bool,
    /// Inputs of the network at the beginning of the step that is over, and how each of them has gone on since.
    pub was: Vec<f64>,
    pub went: Vec<Course>,
    /// Speeds and accelerations of all pins at that time.
    pub past_speed: Vec<f64>,
    pub past_acceleration: Vec<f64>,
    /// The step that is over is integrated once more: how the speeds have gone on is known.
    pub repeats: bool,
    /// Impulse of each branch that is given besides its own in the step at hand, N*m*s.
    pub given: Vec<f64>,
}

impl Room {
    pub(crate) fn new(network: &Network) -> Self {
        let (d, pins) = (network.interface.discrete.len(), network.rotation.pins.len());
        let branches = network.rotation.branches.len();
        let inputs = network.seats.iter().map(|seat| seat.u.len()).sum();
        let room = Vec::with_capacity;
        Self {
            d: room(d),
            start: room(d),
            sum: room(d),
            slope: room(d),
            first: room(d),
            second: room(d),
            moment_before: room(branches),
            pace: 0.0,
            largest: room(d),
            speed: room(pins),
            acceleration: room(pins),
            torque: Vec::with_capacity(branches),
            mean: room(branches),
            gained: room(branches),
            moment: room(branches),
            base: room(branches),
            kick: room(branches),
            bend: room(pins),
            doubt: room(pins),
            step: 0.0,
            is_part: false,
            trial_d: room(d),
            tries: false,
            trial: room(branches),
            yields: room(if network.separate.is_empty() { 0 } else { pins * branches }),
            average: room(d),
            own: Vec::with_capacity(branches),
            u: room(inputs),
            courses: Vec::with_capacity(inputs),
            leads: false,
            was: room(inputs),
            went: Vec::with_capacity(inputs),
            past_speed: room(pins),
            past_acceleration: room(pins),
            repeats: false,
            given: room(branches),
        }
    }
}
