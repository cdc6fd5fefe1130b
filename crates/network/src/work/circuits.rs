//! Room for what is solved about circuits.

use blocksim_block::physical::Torque;

use crate::electrics::Electrics;
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
}

impl Room {
    pub(crate) fn new(network: &Network) -> Self {
        let (d, pins) = (network.interface.discrete.len(), network.rotation.pins.len());
        let branches = network.rotation.branches.len();
        let room = Vec::with_capacity;
        Self {
            d: room(d),
            start: room(d),
            sum: room(d),
            slope: room(d),
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
        }
    }
}
