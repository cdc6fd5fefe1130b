//! Laws of members, linearised.

use crate::network::Network;

/// The linearised law of one member.
#[derive(Debug)]
pub(crate) struct Linear {
    /// Index of the seat.
    pub seat: usize,
    /// Index of the pin of its branch.
    pub pin: usize,
    pub a: Vec<f64>,
    pub c: Vec<f64>,
    /// `S B`.
    pub sb: Vec<f64>,
    pub pivots: Vec<usize>,
}

impl Linear {
    /// Room for all members that know how they change.
    pub(crate) fn rooms(network: &Network) -> Vec<Self> {
        let seats = network.seats.iter().enumerate();
        let knows = seats.filter(|(_, seat)| seat.member.part.linear && seat.held.is_none());
        knows
            .filter_map(|(index, seat)| {
                let n = seat.x.len();
                let pin = *network.rotation.branches.get(seat.branches.start)?;
                (n > 0 && seat.branches.len() == 1).then(|| Self {
                    seat: index,
                    pin,
                    a: vec![0.0; n * n],
                    c: vec![0.0; n],
                    sb: vec![0.0; n],
                    pivots: vec![0; n],
                })
            })
            .collect()
    }
}
