//! The steady state at a voltage, a frequency and a slip.

use super::circuit::Circuit;
use super::complex::{Complex, ZERO, complex};
use super::machine::Machine;

/// Phasors of a steady state, in per unit, in the frame of the voltage, which lies on the real axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    /// Current of the stator.
    pub i_s: Complex,
    /// Currents of the cages; the second is zero for a single cage.
    pub i_r: [Complex; 2],
    /// The main flux.
    pub psi_m: Complex,
    /// Torque on the rotor.
    pub torque: f64,
}

impl Circuit {
    /// The steady state at the voltage `v` (peak of a winding), the frequency `w` of the supply and the frequency `slip`
    /// (slip times `w`; `w` minus the speed of the rotor) that is induced in the rotor, all in per unit.
    ///
    /// The cages draw the current `-B psi_m` with `B = j slip (1, 1) (R + j slip L)^-1 (1, 1)`, so that
    ///
    /// ```text
    /// v = (r_s + j w l_ls) (i_m + B psi_m) + j w psi_m
    /// ```
    ///
    /// The absolute value of the right side rises with `|i_m|` (all circuits are passive), so that a voltage belongs to
    /// one line of the magnetisation curve; on it, the equation is quadratic.
    ///
    /// The result is not finite where nothing limits the current.
    pub fn steady_state(&self, v: f64, w: f64, slip: f64) -> Steady {
        let [i_1, i_2] = self.cages.currents(slip);
        let b = -(i_1 + i_2);
        let (z_s, j_w) = (complex(self.r_s, w * self.l_ls), complex(0.0, w));
        let voltage = |i: f64, psi: f64| z_s * (complex(i, 0.0) + psi * b) + psi * j_w;
        let knots = self.magnetisation.knots();
        let line = (1..knots.len() - 1).find(|k| voltage(knots[*k].0, knots[*k].1).abs() >= v.abs());
        let line = line.unwrap_or(knots.len() - 1);
        let ((i_a, psi_a), (i_b, psi_b)) = (knots[line - 1], knots[line]);
        let (start, along) = (voltage(i_a, psi_a), voltage(i_b - i_a, psi_b - psi_a));
        let (p, q) = (start.dot(along), v * v - start.square());
        let share = if q == 0.0 { 0.0 } else { q / (p + (p * p + along.square() * q).sqrt()) };
        let (i_m, psi) = (i_a + share * (i_b - i_a), psi_a + share * (psi_b - psi_a));
        if v == 0.0 {
            return Steady { i_s: ZERO, i_r: [ZERO; 2], psi_m: ZERO, torque: 0.0 };
        }
        let turn = complex(v, 0.0) / voltage(i_m, psi);
        let psi_m = psi * turn;
        let i_s = i_m * turn + b * psi_m;
        Steady { i_s, i_r: [i_1 * psi_m, i_2 * psi_m], psi_m, torque: psi_m.cross(i_s) }
    }
}

impl Machine {
    /// Fluxes of the steady state of [`Circuit::steady_state`] in the frame of the voltage; none in the zero sequence.
    pub fn steady_fluxes(&self, v: f64, w: f64, slip: f64) -> Vec<f64> {
        let circuit = &self.circuit;
        let Steady { i_s, i_r, psi_m, .. } = circuit.steady_state(v, w, slip);
        let (l_1, l_12, l_2) = circuit.cages.leakage();
        let fluxes = [
            circuit.l_ls * i_s + psi_m,
            l_1 * i_r[0] + l_12 * i_r[1] + psi_m,
            l_12 * i_r[0] + l_2 * i_r[1] + psi_m,
        ];
        let mut psi: Vec<f64> = fluxes.iter().take(self.n).flat_map(|flux| flux.vector()).collect();
        psi.resize(self.states(), 0.0);
        psi
    }
}

#[cfg(test)]
#[path = "steady_tests.rs"]
mod tests;
