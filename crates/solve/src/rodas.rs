//! `Rodas4`: Hairer and Wanner's Rosenbrock method. Order 4 with an error estimate of order 3, six stages, stiffly
//! accurate and L-stable; continuous extension of order 3, with the slope of the solution where a step begins.
//!
//! For stiff systems that change their slopes all the time: each accepted step takes a Jacobian by forward differences, at most
//! n + 1 evaluations with the time derivative, and each trial a factorisation. No Newton iteration, so nothing fails to
//! converge. Where a network knows its own stiffness, `Ros34pw2` does with less.
//!
//! E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, 2nd ed., section VI.4,
//! doi 10.1007/978-3-642-05221-7.

#![expect(clippy::excessive_precision, reason = "the digits are those of the tables")]

use crate::System;
use crate::adaptive::{Adaptive, Fault, Method, Span, Work};
use crate::combine::combine;
use crate::jacobian::Jacobian;
use crate::start_slope::bend;
use crate::within::{Has, Within};

/// Order 4 for small stiff systems.
pub type Rodas4 = Adaptive<Rodas>;

// In the variables u = Gamma k, which need no product with the Jacobian:
// (1/(h gamma) - J) u_i = f(t + c_i h, x + sum a_ij u_j) + sum C_ij u_j / h + h d_i f_t.
const GAMMA: f64 = 0.25;
const ABSCISSA: [f64; 4] = [0.0, 0.386, 0.21, 0.63];
const D: [f64; 4] = [0.25, -0.1043, 0.1035, -0.03620000000000023];

const A2: [f64; 1] = [1.544];
const A3: [f64; 2] = [0.9466785280815826, 0.2557011698983284];
const A4: [f64; 3] = [3.314825187068521, 2.896124015972201, 0.9986419139977817];
const A5: [f64; 4] = [1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950];

const C2: [f64; 1] = [-5.6688];
const C3: [f64; 2] = [-2.430093356833875, -0.2063599157091915];
const C4: [f64; 3] = [-0.1073529058151375, -9.594562251023355, -20.47028614809616];
const C5: [f64; 4] = [7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160];
const C6: [f64; 5] =
    [8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054];

/// Continuous extension: coefficients of theta (1 - theta) and of theta^2 (1 - theta).
const H2: [f64; 5] =
    [10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662];
const H3: [f64; 5] =
    [-0.6762803392801253, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872];

/// Stages and matrices of [`Rodas4`].
pub struct Rodas {
    u: [Vec<f64>; 6],
    /// f at the start of the step, and at a stage.
    f0: Vec<f64>,
    f: Vec<f64>,
    /// The partial derivative by t.
    ft: Vec<f64>,
    /// At the start of the step, and the factors of I - h gamma J.
    jacobian: Jacobian,
    jacobian_is_current: bool,
    within: Within,
}

impl Rodas {
    /// The Jacobian and the derivative by time.
    fn differentiate(&mut self, work: &mut Work, span: Span, x: &[f64]) -> Result<(), Fault> {
        let n = x.len();
        self.jacobian.evaluate(work, span.t0, x, &self.f0, span.h)?;
        // Within the step, because f may change its law behind either end.
        let t = span.t0 + (f64::EPSILON.sqrt() * span.t0.abs().max(span.h)).min(span.h);
        work.derivatives(t, x, &mut self.f)?;
        for i in 0..n {
            self.ft[i] = work.weights.difference(i, self.f[i], self.f0[i]) / (t - span.t0);
        }
        self.jacobian_is_current = true;
        Ok(())
    }

    /// u_i from f at its stage: u_i = (I - h gamma J)^-1 (h gamma (f + h d f_t) + gamma sum C_ij u_j).
    fn stage<const I: usize>(&mut self, h: f64, d: f64, c: [f64; I]) {
        let (known, rest) = self.u.split_at_mut(I);
        let u = &mut rest[0];
        for (i, u) in u.iter_mut().enumerate() {
            let mut sum = h * (self.f[i] + h * d * self.ft[i]);
            for j in 0..I {
                sum += c[j] * known[j][i];
            }
            *u = GAMMA * sum;
        }
        self.jacobian.solve(u);
    }

    /// Coefficients of theta (1 - theta) and of theta^2 (1 - theta) in the extension of state `i`.
    #[inline]
    fn extension(&self, i: usize) -> [f64; 2] {
        [H2, H3].map(|weights| weights.iter().zip(&self.u).map(|(weight, u)| weight * u[i]).sum())
    }
}

impl Method for Rodas {
    const NAME: &'static str = "Rodas4";
    const ORDER: f64 = 4.0;
    const ERROR_POWER: f64 = 4.0;

    fn new(n: usize) -> Self {
        Self {
            u: std::array::from_fn(|_| vec![0.0; n]),
            f0: vec![0.0; n],
            f: vec![0.0; n],
            ft: vec![0.0; n],
            jacobian: Jacobian::new(n),
            jacobian_is_current: false,
            within: Within::new(n),
        }
    }

    fn reserve(&mut self, system: &dyn System) {
        self.jacobian.reserve(system);
    }

    fn begin(&mut self, work: &mut Work, t: f64, x: &[f64], _known: bool) -> Result<(), Fault> {
        self.jacobian_is_current = false;
        work.derivatives(t, x, &mut self.f0)
    }

    fn first_derivative(&mut self) -> (&[f64], &mut [f64]) {
        (&self.f0, &mut self.f)
    }

    fn attempt(
        &mut self,
        work: &mut Work,
        span: Span,
        x0: &[f64],
        x1: &mut [f64],
        error: &mut [f64],
    ) -> Result<(), Fault> {
        let Span { t0, t1, h } = span;
        self.within.forget();
        if !self.jacobian_is_current {
            self.differentiate(work, span, x0)?;
        }
        self.jacobian.factor(work, h * GAMMA)?;

        self.f.copy_from_slice(&self.f0);
        self.stage(h, D[0], []);

        let [u1, ..] = &self.u;
        combine(x1, x0, 1.0, A2, [u1]);
        work.derivatives(t0 + ABSCISSA[1] * h, x1, &mut self.f)?;
        self.stage(h, D[1], C2);

        let [u1, u2, ..] = &self.u;
        combine(x1, x0, 1.0, A3, [u1, u2]);
        work.derivatives(t0 + ABSCISSA[2] * h, x1, &mut self.f)?;
        self.stage(h, D[2], C3);

        let [u1, u2, u3, ..] = &self.u;
        combine(x1, x0, 1.0, A4, [u1, u2, u3]);
        work.derivatives(t0 + ABSCISSA[3] * h, x1, &mut self.f)?;
        self.stage(h, D[3], C4);

        let [u1, u2, u3, u4, ..] = &self.u;
        combine(x1, x0, 1.0, A5, [u1, u2, u3, u4]);
        work.derivatives(t1, x1, &mut self.f)?;
        self.stage(h, 0.0, C5);

        // The embedded solution is the last stage; what the last u adds is its error.
        add(x1, &self.u[4]);
        work.derivatives(t1, x1, &mut self.f)?;
        self.stage(h, 0.0, C6);
        add(x1, &self.u[5]);
        error.copy_from_slice(&self.u[5]);
        Ok(())
    }

    fn finish(&mut self, work: &mut Work, span: Span, x0: &[f64], x1: &[f64]) -> Result<f64, Fault> {
        let mut within = std::mem::take(&mut self.within);
        let extension = |rodas: &Self, i: usize, theta: f64| {
            let [h2, h3] = rodas.extension(i);
            theta * (1.0 - theta) * (h2 + theta * h3)
        };
        let solve = |rodas: &mut Self, b: &mut [f64]| rodas.jacobian.solve(b);
        let found = within.find(self, work, span, [x0, x1], Has { gamma: GAMMA, extension, solve });
        self.within = within;
        found
    }

    fn interpolate(&self, theta: f64, h: f64, x0: &[f64], x1: &[f64], x: &mut [f64]) {
        if self.within.is_known() {
            return self.within.interpolate(theta, x0, x1, x);
        }
        let rest = 1.0 - theta;
        for i in 0..x.len() {
            let [h2, h3] = self.extension(i);
            let bend = bend(h * self.f0[i], x1[i] - x0[i] + h2, x1[i] - x0[i]);
            x[i] = rest * x0[i] + theta * (x1[i] + rest * (h2 + theta * h3 + rest * bend));
        }
    }
}

fn add(x: &mut [f64], u: &[f64]) {
    for (x, u) in x.iter_mut().zip(u) {
        *x += u;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear::{lu_factor, lu_solve};
    use crate::trees::{Family, largest_defect, square};

    struct Table {
        alpha: Vec<Vec<f64>>,
        gamma: Vec<Vec<f64>>,
        b: Vec<f64>,
        embedded: Vec<f64>,
    }

    /// The table in the variables k: Gamma^-1 = 1/gamma - C, alpha = A Gamma, b = m Gamma.
    fn classic_form() -> Table {
        let mut inverse: Vec<f64> = square(&[&[], &C2, &C3, &C4, &C5, &C6]).concat();
        for i in 0..6 {
            for j in 0..6 {
                inverse[i * 6 + j] = f64::from(i == j) / GAMMA - inverse[i * 6 + j];
            }
        }
        let mut pivots = [0; 6];
        lu_factor(&mut inverse, &mut pivots).unwrap();
        let mut gamma = vec![vec![0.0; 6]; 6];
        for j in 0..6 {
            let mut column = [0.0; 6];
            column[j] = 1.0;
            lu_solve(&inverse, &pivots, &mut column);
            for i in 0..6 {
                gamma[i][j] = column[i];
            }
        }
        let times_gamma =
            |row: &[f64]| (0..6).map(|j| (0..6).map(|l| row[l] * gamma[l][j]).sum()).collect::<Vec<f64>>();
        let a6 = [A5[0], A5[1], A5[2], A5[3], 1.0];
        let alpha = square(&[&[], &A2, &A3, &A4, &A5, &a6]).iter().map(|row| times_gamma(row)).collect();
        let b = times_gamma(&[A5[0], A5[1], A5[2], A5[3], 1.0, 1.0]);
        let embedded = times_gamma(&[A5[0], A5[1], A5[2], A5[3], 1.0, 0.0]);
        Table { alpha, gamma, b, embedded }
    }

    #[test]
    fn the_table_meets_the_conditions_of_order_four_and_its_estimate_those_of_order_three() {
        let Table { alpha, gamma, b, embedded } = classic_form();
        let defect = |b, order| largest_defect(Family::Rosenbrock, &alpha, &gamma, b, 1.0, order);
        assert!(defect(&b, 4) < 1e-12, "{:e}", defect(&b, 4));
        assert!(defect(&b, 5) > 1e-4);
        assert!(defect(&embedded, 3) < 1e-12, "{:e}", defect(&embedded, 3));
        assert!(defect(&embedded, 4) > 1e-4);
    }

    #[test]
    fn the_sums_of_the_rows_are_the_abscissae_and_the_factors_of_the_time_derivative() {
        let Table { alpha, gamma, .. } = classic_form();
        for i in 0..4 {
            assert!((alpha[i].iter().sum::<f64>() - ABSCISSA[i]).abs() < 1e-12);
            assert!((gamma[i].iter().sum::<f64>() - D[i]).abs() < 1e-12);
        }
        for i in 4..6 {
            assert!((alpha[i].iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(gamma[i].iter().sum::<f64>().abs() < 1e-12);
        }
    }
}
