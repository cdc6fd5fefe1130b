//! `Ros34pw2`: Rang and Angermann's W-method. Order 3 with an error estimate of order 2, four stages, stiffly accurate;
//! continuous extension of order 2.
//!
//! A W-method keeps its order with any approximation J of the Jacobian, even with none (J = 0 makes it an explicit
//! method); with the exact one it is L-stable. So the system may give just the part of the Jacobian that is stiff and
//! cheap to factor, such as a diagonal or a few small blocks, through [`System::prepare`](crate::System::prepare) and
//! [`System::solve`](crate::System::solve). For large systems whose stiffness is known to sit in few places.
//!
//! Stability asks for the stiff diagonal only; speed asks for more. Where a fast state and a slow one act on each other,
//! as the current and the speed of a motor do, J should hold the coupling in both directions: without it the error falls
//! as h^2 only, and at a relative tolerance of 1e-6 ten times the steps may be needed (see the tests of stiff systems).
//!
//! Time enters as one more state with dt/dt = 1 whose row and column in J are zero. That is one more approximation, so
//! stages at the abscissae alpha_i keep order 3 and no derivative by t is needed.
//!
//! The extension is a parabola made of the stages. Unlike a cubic through the derivatives at both ends it stays bounded
//! when a step is much longer than a decay it damps out, and it costs no evaluation. Where a step resolves a state it leaves the start
//! with the slope of the solution, so that an event just behind the start is where it should be: what bounces in ever smaller
//! flights gained speed by the error of that slope, and never came to rest.
//!
//! J. Rang, L. Angermann: New Rosenbrock W-methods of order 3 for partial differential algebraic equations of index 1,
//! BIT 45 (2005), doi 10.1007/s10543-005-0035-y.

#![expect(clippy::excessive_precision, reason = "the digits are those of the tables")]

use crate::adaptive::{Adaptive, Fault, Method, Span, Work};
use crate::combine::{combine, combine_error};
use crate::start_slope::bend;

/// Order 3 for stiff systems that know a cheap part of their Jacobian.
pub type Ros34pw2 = Adaptive<RangAngermann>;

const GAMMA: f64 = 4.358_665_215_084_59e-1;

/// alpha.
const ALPHA: [[f64; 4]; 4] = [
    [0.0, 0.0, 0.0, 0.0],
    [8.7173304301691801e-01, 0.0, 0.0, 0.0],
    [8.4457060015369423e-01, -1.1299064236484185e-01, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
];

/// Gamma.
const GAMMAS: [[f64; 4]; 4] = [
    [GAMMA, 0.0, 0.0, 0.0],
    [-8.7173304301691801e-01, GAMMA, 0.0, 0.0],
    [-9.0338057013044082e-01, 5.4180672388095326e-02, GAMMA, 0.0],
    [2.4212380706095346e-01, -1.2232505839045147e+00, 5.4526025533510214e-01, GAMMA],
];

/// Weights of order 3.
const B: [f64; 4] =
    [2.4212380706095346e-01, -1.2232505839045147e+00, 1.5452602553351020e+00, 4.3586652150845900e-01];

/// Weights of order 2.
const B_EMBEDDED: [f64; 4] =
    [3.7810903145819369e-01, -9.6042292212423178e-02, 5.0e-01, 2.1793326075422950e-01];

/// Weights of the extension: b(theta) = P theta + (B - P) theta^2. P is fixed by the conditions of order 2 and by one of
/// order 3, sum b_i gamma_ij gamma_j = 0, at all theta.
const P: [f64; 4] =
    [-2.002_615_084_029_18e-1, -8.120_532_019_829_45e0, 8.352_049_352_211_21e0, 9.687_441_760_211_53e-1];

// The method in the variables u = Gamma k, which need no product with the Jacobian:
// (I - h gamma J) u_i = h gamma f(t + alpha_i h, x + sum A_ij u_j) + gamma sum C_ij u_j, x1 = x + sum M_i u_i.
const INVERSE: [[f64; 4]; 4] = invert_lower(&GAMMAS);
const A: [[f64; 4]; 4] = [
    times(&ALPHA[0], &INVERSE),
    times(&ALPHA[1], &INVERSE),
    times(&ALPHA[2], &INVERSE),
    times(&ALPHA[3], &INVERSE),
];
const M: [f64; 4] = times(&B, &INVERSE);
const E: [f64; 4] = times(&difference(&B, &B_EMBEDDED), &INVERSE);
const DENSE: [[f64; 4]; 2] = [times(&P, &INVERSE), times(&difference(&B, &P), &INVERSE)];
const ABSCISSA: [f64; 3] = [ALPHA[1][0], ALPHA[2][0] + ALPHA[2][1], 1.0];

/// Inverse of a lower triangular matrix, by forward substitution column by column.
const fn invert_lower(l: &[[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let mut inverse = [[0.0; 4]; 4];
    let mut j = 0;
    while j < 4 {
        let mut i = j;
        while i < 4 {
            let mut sum = if i == j { 1.0 } else { 0.0 };
            let mut k = j;
            while k < i {
                sum -= l[i][k] * inverse[k][j];
                k += 1;
            }
            inverse[i][j] = sum / l[i][i];
            i += 1;
        }
        j += 1;
    }
    inverse
}

/// Row times matrix.
const fn times(row: &[f64; 4], m: &[[f64; 4]; 4]) -> [f64; 4] {
    let mut product = [0.0; 4];
    let mut j = 0;
    while j < 4 {
        product[j] = row[0] * m[0][j] + row[1] * m[1][j] + row[2] * m[2][j] + row[3] * m[3][j];
        j += 1;
    }
    product
}

const fn difference(a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

/// Stages of [`Ros34pw2`].
pub struct RangAngermann {
    u: [Vec<f64>; 4],
    /// f at the start of the step, and at a stage.
    f0: Vec<f64>,
    f: Vec<f64>,
}

impl RangAngermann {
    /// Stage I from its f: u_I = (I - h gamma J)^-1 (h gamma f + gamma sum C_Ij u_j), with C = 1/gamma - Gamma^-1.
    fn stage<const I: usize>(&mut self, work: &mut Work, h: f64, first: bool) {
        let (known, rest) = self.u.split_at_mut(I);
        let u = &mut rest[0];
        let f = if first { &self.f0 } else { &self.f };
        for (i, u) in u.iter_mut().enumerate() {
            let mut sum = h * f[i];
            for j in 0..I {
                sum -= INVERSE[I][j] * known[j][i];
            }
            *u = GAMMA * sum;
        }
        work.system.solve(u);
    }
}

impl Method for RangAngermann {
    const NAME: &'static str = "Ros34pw2";
    const ORDER: f64 = 3.0;
    const ERROR_POWER: f64 = 3.0;

    fn new(n: usize) -> Self {
        Self { u: std::array::from_fn(|_| vec![0.0; n]), f0: vec![0.0; n], f: vec![0.0; n] }
    }

    fn begin(&mut self, work: &mut Work, t: f64, x: &[f64], _known: bool) -> Result<(), Fault> {
        work.derivatives(t, x, &mut self.f0)
    }

    fn first_derivative(&mut self) -> (&[f64], &mut [f64]) {
        (&self.f0, &mut self.f)
    }

    fn attempt(
        &mut self,
        work: &mut Work,
        Span { t0, t1, h }: Span,
        x0: &[f64],
        x1: &mut [f64],
        error: &mut [f64],
    ) -> Result<(), Fault> {
        work.counts.factorisations += 1;
        work.system.prepare(t0, x0, h * GAMMA).map_err(|_| Fault::System)?;
        self.stage::<0>(work, h, true);

        let [u1, ..] = &self.u;
        combine(x1, x0, 1.0, [A[1][0]], [u1]);
        work.derivatives(t0 + ABSCISSA[0] * h, x1, &mut self.f)?;
        self.stage::<1>(work, h, false);

        let [u1, u2, ..] = &self.u;
        combine(x1, x0, 1.0, [A[2][0], A[2][1]], [u1, u2]);
        work.derivatives(t0 + ABSCISSA[1] * h, x1, &mut self.f)?;
        self.stage::<2>(work, h, false);

        let [u1, u2, u3, ..] = &self.u;
        combine(x1, x0, 1.0, [A[3][0], A[3][1], A[3][2]], [u1, u2, u3]);
        work.derivatives(t1, x1, &mut self.f)?;
        self.stage::<3>(work, h, false);

        let u = self.u.each_ref().map(Vec::as_slice);
        combine(x1, x0, 1.0, M, u);
        combine_error(error, 1.0, E, u);
        Ok(())
    }

    fn interpolate(&self, theta: f64, h: f64, x0: &[f64], x1: &[f64], x: &mut [f64]) {
        let weight = std::array::from_fn(|j| theta * (DENSE[0][j] + theta * DENSE[1][j]));
        combine(x, x0, 1.0, weight, self.u.each_ref().map(Vec::as_slice));
        let away = theta * (1.0 - theta).powi(2);
        for (i, x) in x.iter_mut().enumerate() {
            let has: f64 = DENSE[0].iter().zip(&self.u).map(|(weight, u)| weight * u[i]).sum();
            *x += away * bend(h * self.f0[i], has, x1[i] - x0[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trees::{Family, largest_defect};

    fn defect(family: Family, b: &[f64], theta: f64, order: usize) -> f64 {
        let rows = |m: &[[f64; 4]; 4]| m.map(|row| row.to_vec()).to_vec();
        largest_defect(family, &rows(&ALPHA), &rows(&GAMMAS), b, theta, order)
    }

    #[test]
    fn the_table_meets_all_eight_conditions_of_a_w_method_of_order_three() {
        assert!(defect(Family::W, &B, 1.0, 3) < 1e-14);
        assert!(defect(Family::W, &B, 1.0, 4) > 1e-3);
        assert!(defect(Family::Rosenbrock, &B, 1.0, 3) < 1e-14);
    }

    #[test]
    fn the_estimate_meets_the_conditions_of_order_two() {
        assert!(defect(Family::W, &B_EMBEDDED, 1.0, 2) < 1e-14);
        assert!(defect(Family::W, &B_EMBEDDED, 1.0, 3) > 1e-3);
    }

    #[test]
    fn the_extension_meets_the_conditions_of_order_two_anywhere() {
        for theta in [0.1, 0.4, 0.7, 1.0] {
            let b: [f64; 4] = std::array::from_fn(|i| P[i] * theta + (B[i] - P[i]) * theta * theta);
            assert!(
                defect(Family::W, &b, theta, 2) < 1e-13,
                "{theta}: {:e}",
                defect(Family::W, &b, theta, 2)
            );
        }
    }

    #[test]
    fn the_table_is_stiffly_accurate() {
        for j in 0..4 {
            assert!((ALPHA[3][j] + GAMMAS[3][j] - B[j]).abs() < 1e-15);
        }
    }
}
