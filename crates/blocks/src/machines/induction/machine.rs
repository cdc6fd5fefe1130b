//! Currents, torque and changes of the fluxes.

use super::circuit::{Cages, Circuit};
use super::complex::{Complex, ZERO, complex};
use super::magnetisation::Rising;

/// Most circuits for each axis: stator and two cages.
pub(super) const MOST: usize = 3;

/// A squirrel-cage machine in per unit and in a frame of any speed; all that does not change while it runs.
///
/// The states are flux linkages: `psi_ds, psi_qs`, for each cage `psi_dr, psi_qr`, and `psi_0s` if the circuit has
/// a zero sequence. With the leakage matrix `L` (diagonal but for what two cages have in common),
///
/// ```text
/// psi_k = sum of L_kl i_l + psi_m,   psi_m = f(|i_m|) i_m / |i_m|,   i_m = sum of i_k
/// ```
///
/// so that `i = L^-1 (psi - psi_m)`. Summed up, this is one scalar equation: with `n_k` the sums of the rows of `L^-1`
/// and `z = |sum of n_k psi_k|`,
///
/// ```text
/// z = i_m + (sum of n_k) f(i_m)
/// ```
///
/// The right side rises and is linear between the knots of the magnetisation curve, and so is its inverse: saturation
/// costs a look-up, without iteration. A circuit without leakage, at most one, has the main flux itself: then `z` is
/// this flux, and `i_m` the value that is looked up.
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    pub(super) circuit: Circuit,
    /// Rated angular frequency, rad/s.
    pub(super) w_base: f64,
    /// Number of circuits for each axis.
    pub(super) n: usize,
    r: [f64; MOST],
    /// Currents over fluxes; with saturation, the part that is constant: `i = constant psi + sign n response`.
    constant: [[f64; MOST]; MOST],
    saturable: Option<Saturable>,
}

/// The part of the currents that saturation changes.
#[derive(Debug, Clone, PartialEq)]
struct Saturable {
    /// `n_k` of the machine's description; a unit vector where a circuit has no leakage.
    n: [f64; MOST],
    /// -1; 1 where a circuit has no leakage.
    sign: f64,
    response: Rising,
}

/// A linear map of space vectors that is stretched differently along an axis and across it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    along: f64,
    across: f64,
    /// Unit vector.
    axis: Complex,
}

impl Stretch {
    const NONE: Self = Self { along: 0.0, across: 0.0, axis: complex(1.0, 0.0) };

    /// `constant + factor * self`.
    pub(super) fn plus(self, constant: f64, factor: f64) -> Self {
        Self { along: constant + factor * self.along, across: constant + factor * self.across, ..self }
    }

    pub(super) fn of(self, v: Complex) -> Complex {
        self.across * v + ((self.along - self.across) * self.axis.dot(v)) * self.axis
    }

    pub(super) fn inverse(self) -> Self {
        Self { along: 1.0 / self.along, across: 1.0 / self.across, ..self }
    }

    /// As a symmetric matrix.
    pub(super) fn matrix(self) -> [[f64; 2]; 2] {
        let (d, q) = (self.of(complex(1.0, 0.0)), self.of(complex(0.0, 1.0)));
        [[d.re, q.re], [d.im, q.im]]
    }
}

impl Machine {
    /// From a circuit that [`Circuit::validate`] accepts and the rated angular frequency, rad/s.
    pub fn new(circuit: Circuit, w_base: f64) -> Self {
        let n = 1 + circuit.cages.count();
        let [r_1, r_2] = circuit.cages.resistances();
        let (pinned, gamma) = inverse_leakage(&circuit);
        let rows: [f64; MOST] = std::array::from_fn(|k| gamma[k].iter().sum());
        let total: f64 = rows.iter().sum();
        let knots = circuit.magnetisation.knots().iter();
        let (constant, saturable) = match pinned {
            None => {
                let points = knots.map(|&(i, psi)| (i + total * psi, psi));
                (gamma, Saturable { n: rows, sign: -1.0, response: Rising::through(points) })
            }
            Some(pin) => {
                // i_k = sum of gamma_kl (psi_l - psi_pin), i_pin = i_m - sum of the others.
                let mut constant = gamma;
                for k in 0..MOST {
                    constant[k][pin] -= rows[k];
                    constant[pin][k] -= rows[k];
                }
                constant[pin][pin] += total;
                let mut n = [0.0; MOST];
                n[pin] = 1.0;
                let points = knots.map(|&(i, psi)| (psi, i));
                (constant, Saturable { n, sign: 1.0, response: Rising::through(points) })
            }
        };
        let mut machine = Self { w_base, n, r: [circuit.r_s, r_1, r_2], constant, saturable: None, circuit };
        if machine.circuit.magnetisation.is_linear() {
            let slope = saturable.sign * saturable.response.ratio_and_slope(0.0).1;
            for k in 0..n {
                for l in 0..n {
                    machine.constant[k][l] += slope * saturable.n[k] * saturable.n[l];
                }
            }
        } else {
            machine.saturable = Some(saturable);
        }
        machine
    }

    /// The circuit it was made from.
    pub fn circuit(&self) -> &Circuit {
        &self.circuit
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        2 * self.n + usize::from(self.circuit.l_0.is_some())
    }

    /// Names of the states in their order.
    pub fn names(&self) -> Vec<&'static str> {
        let mut names = match self.circuit.cages {
            Cages::Single { .. } => vec!["psi_ds", "psi_qs", "psi_dr", "psi_qr"],
            Cages::Double { .. } => vec!["psi_ds", "psi_qs", "psi_dr", "psi_qr", "psi_dr2", "psi_qr2"],
        };
        names.extend(self.circuit.l_0.map(|_| "psi_0s"));
        names
    }

    /// Space vector of the flux of a circuit: 0 is the stator.
    #[inline]
    pub(super) fn flux(psi: &[f64], circuit: usize) -> Complex {
        complex(psi[2 * circuit], psi[2 * circuit + 1])
    }

    /// What passes through the saturable part: `sum of n_k psi_k`.
    #[inline]
    fn excitation(&self, saturable: &Saturable, psi: &[f64]) -> Complex {
        (0..self.n).fold(ZERO, |sum, k| sum + saturable.n[k] * Self::flux(psi, k))
    }

    /// Current of the stator and then those of the cages; the last is zero for a single cage.
    #[inline]
    pub fn currents(&self, psi: &[f64]) -> [Complex; MOST] {
        let mut i = [ZERO; MOST];
        for (row, i) in self.constant.iter().zip(&mut i).take(self.n) {
            for (l, factor) in row.iter().enumerate().take(self.n) {
                *i = *i + *factor * Self::flux(psi, l);
            }
        }
        if let Some(saturable) = &self.saturable {
            let z = self.excitation(saturable, psi);
            let response = (saturable.sign * saturable.response.ratio_and_slope(z.abs()).0) * z;
            for (i, n) in i.iter_mut().zip(saturable.n).take(self.n) {
                *i = *i + n * response;
            }
        }
        i
    }

    /// Current of the zero sequence.
    #[inline]
    pub fn zero_current(&self, psi: &[f64]) -> f64 {
        self.circuit.l_0.map_or(0.0, |l_0| psi[2 * self.n] / l_0)
    }

    /// The flux that links stator and rotor.
    pub fn main_flux(&self, psi: &[f64]) -> Complex {
        Self::flux(psi, 0) - self.circuit.l_ls * self.currents(psi)[0]
    }

    /// Torque on the rotor: `T = psi_ds i_qs - psi_qs i_ds`.
    #[inline]
    pub fn torque(&self, psi: &[f64]) -> f64 {
        Self::flux(psi, 0).cross(self.currents(psi)[0])
    }

    /// Changes of the fluxes, 1/s, in a frame that turns at `w`, at the rotor speed `w_r`, with the voltage `v` at the
    /// stator and `v_0` in its zero sequence:
    ///
    /// ```text
    /// psi_s' = w_base (v - r_s i_s - j w psi_s),   psi_r' = -w_base (r_r i_r + j (w - w_r) psi_r)
    /// psi_0' = w_base (v_0 - r_s i_0)
    /// ```
    #[inline]
    pub fn derivatives(&self, psi: &[f64], v: Complex, v_0: f64, w: f64, w_r: f64, d_psi: &mut [f64]) {
        let i = self.currents(psi);
        for k in 0..self.n {
            let (v, w) = if k == 0 { (v, w) } else { (ZERO, w - w_r) };
            let flux = Self::flux(psi, k);
            d_psi[2 * k] = self.w_base * (v.re - self.r[k] * i[k].re + w * flux.im);
            d_psi[2 * k + 1] = self.w_base * (v.im - self.r[k] * i[k].im - w * flux.re);
        }
        if self.circuit.l_0.is_some() {
            d_psi[2 * self.n] = self.w_base * (v_0 - self.r[0] * self.zero_current(psi));
        }
    }

    /// Energy of the fields over that of one radian of the base frequency at the base power, and heat, both per unit.
    pub fn energy(&self, psi: &[f64]) -> (f64, f64) {
        let (i, i_0) = (self.currents(psi), self.zero_current(psi));
        let flux = |k: usize| Self::flux(psi, k);
        let mut field = 0.0;
        let mut heat = 2.0 * self.r[0] * i_0 * i_0;
        for (k, i) in i.iter().enumerate().take(self.n) {
            field += (0..self.n).map(|l| 0.5 * self.constant[k][l] * flux(k).dot(flux(l))).sum::<f64>();
            heat += self.r[k] * i.square();
        }
        if let Some(saturable) = &self.saturable {
            field += saturable.sign * saturable.response.integral(self.excitation(saturable, psi).abs());
        }
        if let Some(l_0) = self.circuit.l_0 {
            field += l_0 * i_0 * i_0;
        }
        (field, heat)
    }

    /// Speed at which the flux of the (first) cage turns, in per unit, at the rotor speed `w_r`: `w_r` and what the voltage
    /// over its resistance adds. `w_r` where there is no flux.
    pub fn rotor_flux_speed(&self, psi: &[f64], w_r: f64) -> f64 {
        let flux = Self::flux(psi, 1);
        let square = flux.square();
        if square == 0.0 { w_r } else { w_r - self.r[1] * flux.cross(self.currents(psi)[1]) / square }
    }

    /// The sense in which the flux of the stator turns at the voltage `v`, both in a frame that stands still: positive or negative.
    pub fn stator_flux_turn(&self, psi: &[f64], v: Complex) -> f64 {
        Self::flux(psi, 0).cross(v - self.r[0] * self.currents(psi)[0])
    }

    /// How the current of circuit `k` changes with the flux of circuit `l`: the inverse of the incremental inductances,
    /// which saturation makes smaller along the main flux than across it.
    pub(super) fn incremental(&self, psi: &[f64]) -> impl Fn(usize, usize) -> Stretch + '_ {
        let (stretch, n) = match &self.saturable {
            None => (Stretch::NONE, [0.0; MOST]),
            Some(saturable) => {
                let z = self.excitation(saturable, psi);
                let (across, along) = saturable.response.ratio_and_slope(z.abs());
                let axis = if z == ZERO { complex(1.0, 0.0) } else { (1.0 / z.abs()) * z };
                let sign = saturable.sign;
                (Stretch { along: sign * along, across: sign * across, axis }, saturable.n)
            }
        };
        move |k, l| stretch.plus(self.constant[k][l], n[k] * n[l])
    }
}

/// The inverse of the leakage matrix, and the circuit that has no leakage, whose row and column are then zero.
fn inverse_leakage(circuit: &Circuit) -> (Option<usize>, [[f64; MOST]; MOST]) {
    let mut gamma = [[0.0; MOST]; MOST];
    let mut pinned = None;
    if circuit.l_ls > 0.0 {
        gamma[0][0] = 1.0 / circuit.l_ls;
    } else {
        pinned = Some(0);
    }
    match circuit.cages {
        Cages::Single { l, .. } if l > 0.0 => gamma[1][1] = 1.0 / l,
        Cages::Single { .. } => pinned = Some(1),
        Cages::Double { l, common, .. } => {
            let determinant = l[0] * l[1] + common * (l[0] + l[1]);
            if determinant > 0.0 {
                gamma[1][1] = (l[1] + common) / determinant;
                gamma[2][2] = (l[0] + common) / determinant;
                gamma[1][2] = -common / determinant;
                gamma[2][1] = gamma[1][2];
            } else {
                let (without, other) = if l[0] == 0.0 { (1, 2) } else { (2, 1) };
                pinned = Some(without);
                gamma[other][other] = 1.0 / l[other - 1];
            }
        }
    }
    (pinned, gamma)
}

#[cfg(test)]
#[path = "machine_tests.rs"]
mod tests;
