//! Base values of quantities in per unit.

use std::f64::consts::{SQRT_2, TAU};

/// Base values of a machine in delta: peak values of a winding.
///
/// Given per unit, impedances of a machine refer to this base whichever way its windings are connected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Base {
    /// Rated angular frequency, rad/s.
    pub w: f64,
    /// Peak winding voltage `sqrt(2) V_n`, V.
    pub v: f64,
    /// Peak winding current `sqrt(2) S_n / (3 V_n)`, A.
    pub i: f64,
    /// Impedance `3 V_n^2 / S_n`, ohm.
    pub z: f64,
    /// Flux linkage `V_base / w_base`, Wb.
    pub psi: f64,
    /// Torque `S_n N / w_base`, N*m.
    pub t: f64,
    /// Speed in per unit for a speed of the shaft of 1 rad/s.
    pub speed: f64,
}

impl Base {
    /// From rated apparent power (V*A), rated voltage (V, RMS from line to line), rated frequency (Hz) and number
    /// of pole pairs.
    pub fn of(power: f64, voltage: f64, frequency: f64, pole_pairs: u32) -> Self {
        let (w, v) = (TAU * frequency, SQRT_2 * voltage);
        let speed = f64::from(pole_pairs) / w;
        Self {
            w,
            v,
            i: SQRT_2 * power / (3.0 * voltage),
            z: 3.0 * voltage.powi(2) / power,
            psi: v / w,
            t: power * speed,
            speed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_values_are_those_of_a_machine_in_delta() {
        let base = Base::of(15e3, 220.0, 60.0, 1);
        assert!((base.z - 9.68).abs() < 1e-12);
        assert!((base.v - 311.1270).abs() < 0.51e-4);
        assert!((base.i - 32.14122).abs() < 0.51e-5);
        assert!((base.t - 39.78874).abs() < 0.51e-5);
        assert!((base.psi - 0.825_290_0).abs() < 0.51e-7);
        assert!((base.v / base.i - base.z).abs() < 1e-12);
    }
}
