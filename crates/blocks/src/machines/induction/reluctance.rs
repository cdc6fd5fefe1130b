//! How the currents of the stator answer its voltage: what a network needs where they are not free.

use super::complex::{Complex, ZERO};
use super::machine::{MOST, Machine};

/// `di_s/dt = inverse (v - internal)` in the frame of the fluxes, everything in per unit but time, which is in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reluctance {
    /// Inverse of the transient inductance, 1/s; symmetric.
    pub inverse: [[f64; 2]; 2],
    /// Voltage at which the current would not change.
    pub internal: [f64; 2],
    /// The same for the zero sequence; zero when there is none.
    pub zero_inverse: f64,
    /// The voltage at which the current of the zero sequence would not change.
    pub zero_internal: f64,
}

impl Machine {
    /// The answer of the stator currents at these fluxes, in a frame of speed `w`, at the rotor speed `w_r`.
    pub fn reluctance(&self, psi: &[f64], w: f64, w_r: f64) -> Reluctance {
        let mut change = [0.0; 2 * MOST + 1];
        self.derivatives(psi, ZERO, 0.0, w, w_r, &mut change);
        let incremental = self.incremental(psi);
        let without_voltage: Complex =
            (0..self.n).fold(ZERO, |sum, k| sum + incremental(0, k).of(Self::flux(&change, k)));
        let inverse = incremental(0, 0).plus(0.0, self.w_base);
        Reluctance {
            inverse: inverse.matrix(),
            internal: (-inverse.inverse().of(without_voltage)).vector(),
            zero_inverse: self.circuit.l_0.map_or(0.0, |l_0| self.w_base / l_0),
            zero_internal: self.circuit.r_s * self.zero_current(psi),
        }
    }
}
