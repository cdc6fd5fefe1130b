//! Room for energies.

use crate::accounts::OWN;
use crate::network::Network;

/// Room for energies, J: those of motion and gravity, then those of the members.
#[derive(Debug, Clone, Default)]
pub(crate) struct Energies {
    pub parts: Vec<f64>,
    pub before: Vec<f64>,
    /// What sources have supplied while charges divided.
    pub pushed: f64,
    /// Shares of payloads.
    pub shares: Vec<f64>,
}

impl Energies {
    pub(crate) fn new(network: &Network) -> Self {
        if network.accounts.is_empty() {
            return Self::default();
        }
        let parts = OWN + network.seats.len();
        Self {
            parts: vec![0.0; parts],
            before: vec![0.0; parts],
            pushed: 0.0,
            shares: vec![0.0; network.frames.payloads.len()],
        }
    }
}
