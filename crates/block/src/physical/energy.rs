//! What accounts of energy book.

use std::ops::{Add, AddAssign};

/// Energy that something holds, and the powers that do not stay within the network: where all three are right,
/// `d(stored)/dt = supplied - dissipated + what comes in through the ports`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// Energy in fields, springs and motion, J. Where it is zero is free.
    pub stored: f64,
    /// Power from outside: sources and inputs, W.
    pub supplied: f64,
    /// Power that becomes heat, W.
    pub dissipated: f64,
}

impl Energy {
    /// Energy in a field or a spring, J.
    pub fn stored(stored: f64) -> Self {
        Self { stored, ..Self::default() }
    }

    /// Power from outside, W.
    pub fn supplied(supplied: f64) -> Self {
        Self { supplied, ..Self::default() }
    }

    /// Power that becomes heat, W.
    pub fn dissipated(dissipated: f64) -> Self {
        Self { dissipated, ..Self::default() }
    }
}

impl Add for Energy {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            stored: self.stored + other.stored,
            supplied: self.supplied + other.supplied,
            dissipated: self.dissipated + other.dissipated,
        }
    }
}

impl AddAssign for Energy {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
