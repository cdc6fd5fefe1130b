//! The books of accounts of energy: what each keeps among the discrete states, and its balance.

use blocksim_block::Interface;
use blocksim_block::physical::Element;

use crate::seat::Seat;

/// Energies in front of those of the members: of motion and of gravity.
pub(crate) const MOTION: usize = 0;
pub(crate) const GRAVITY: usize = 1;
pub(crate) const OWN: usize = 2;

/// Cells of an account in front of its lists: whether it has been opened, and the largest energy turned over.
pub(crate) const OPEN: usize = 0;
pub(crate) const TURNED: usize = 1;
pub(crate) const LISTS: usize = 2;

/// The accounts of a network.
#[derive(Debug, Clone, Default)]
pub(crate) struct Accounts {
    pub list: Vec<Account>,
    /// Pins of the sources of speed.
    pub sources: Vec<usize>,
    pub payloads: usize,
}

/// An account.
#[derive(Debug, Clone)]
pub(crate) struct Account {
    pub seat: usize,
    /// Error that is allowed, relative to the largest energy turned over.
    pub tolerance: Option<f64>,
    /// Energy that counts as turned over at least, J.
    pub floor: f64,
    /// First of its cells: opened, turned over, share of each payload, energies at the start.
    pub cells: usize,
}

impl Accounts {
    /// Adds the cells of all accounts to the interface, behind all other discrete states.
    pub(crate) fn new(seats: &[Seat], payloads: usize, interface: &mut Interface) -> Self {
        let mut accounts = Self { payloads, ..Self::default() };
        for (index, seat) in seats.iter().enumerate() {
            let mut pin = seat.pins.start;
            for element in &seat.member.part.elements {
                match *element {
                    Element::EnergyAccount { tolerance, floor } => {
                        let cells = interface.discrete.len();
                        let path = &seat.member.path;
                        for cell in 0..LISTS + payloads + OWN + seats.len() {
                            *interface =
                                std::mem::take(interface).discrete(format!("{path}.account[{cell}]"), 0.0);
                        }
                        accounts.list.push(Account { seat: index, tolerance, floor, cells });
                    }
                    Element::SpeedSource { .. } => {
                        accounts.sources.push(pin);
                        pin += 1;
                    }
                    Element::Branch { .. }
                    | Element::Friction { .. }
                    | Element::Rigid { .. }
                    | Element::SpeedProbe { .. }
                    | Element::AbsoluteSpeedProbe { .. } => pin += 1,
                    _ => {}
                }
            }
        }
        accounts
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

impl Account {
    /// Share of each payload when it was last looked at.
    pub(crate) fn shares<'a>(&self, d: &'a [f64], payloads: usize) -> &'a [f64] {
        &d[self.cells + LISTS..self.cells + LISTS + payloads]
    }

    pub(crate) fn shares_mut<'a>(&self, d: &'a mut [f64], payloads: usize) -> &'a mut [f64] {
        &mut d[self.cells + LISTS..self.cells + LISTS + payloads]
    }

    /// Energies at the start.
    pub(crate) fn start<'a>(&self, d: &'a [f64], payloads: usize, parts: usize) -> &'a [f64] {
        let first = self.cells + LISTS + payloads;
        &d[first..first + parts]
    }

    /// Error of the balance and the energy turned over, J, with the supplied and the dissipated energy.
    pub(crate) fn balance(
        &self,
        d: &[f64],
        payloads: usize,
        parts: &[f64],
        [supplied, heat]: [f64; 2],
    ) -> (f64, f64) {
        if d[self.cells + OPEN] == 0.0 {
            return (0.0, 0.0);
        }
        let changes = || parts.iter().zip(self.start(d, payloads, parts.len())).map(|(now, then)| now - then);
        let error = changes().sum::<f64>() - supplied + heat;
        (error, changes().map(f64::abs).sum::<f64>() + supplied.abs() + heat.abs())
    }
}
