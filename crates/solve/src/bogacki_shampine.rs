//! `Ode23`: Bogacki and Shampine's pair. Order 3 with an error estimate of order 2, four stages of which the last is
//! the first of the next step; explicit; continuous extension of order 3 (cubic Hermite).
//!
//! On x' = l x the error estimate of the pair is h x l (h l)^2 (1 + h l) / 48: it is zero for h = -1 / l, where a step is off by 3 % of x, and
//! steps of such a length are common where sample times end them. A second difference of the stages at the ends and in the middle, which is
//! of the same order and zero only beyond the limit of stability, stands beside it; the larger of both counts.
//!
//! For loose tolerances (1e-2 to 1e-4), for derivatives with many kinks, and for systems that are only a little stiff.
//!
//! P. Bogacki, L. F. Shampine: A 3(2) pair of Runge-Kutta formulas, Appl. Math. Lett. 2 (1989),
//! doi 10.1016/0893-9659(89)90079-7.

use crate::adaptive::{Adaptive, Fault, Method, Span, Work};
use crate::combine::{combine, combine_error};

/// Order 3 for loose tolerances and rough derivatives.
pub type Ode23 = Adaptive<BogackiShampine>;

pub(crate) const C2: f64 = 1.0 / 2.0;
pub(crate) const C3: f64 = 3.0 / 4.0;

pub(crate) const A2: [f64; 1] = [1.0 / 2.0];
pub(crate) const A3: [f64; 2] = [0.0, 3.0 / 4.0];
/// Weights of order 3, and the last row: stage 4 is the derivative at the end.
pub(crate) const B: [f64; 3] = [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0];
/// Weights of order 3 less those of order 2.
const E: [f64; 4] = [-5.0 / 72.0, 1.0 / 12.0, 1.0 / 9.0, -1.0 / 8.0];
/// Factor of the second difference of stages 1, 2 and 4: on x' = l x it is the other estimate then, as h becomes small.
const SECOND: f64 = 1.0 / 24.0;

/// Stages of [`Ode23`].
pub struct BogackiShampine {
    k: [Vec<f64>; 4],
}

impl Method for BogackiShampine {
    const NAME: &'static str = "Ode23";
    const ORDER: f64 = 3.0;
    const ERROR_POWER: f64 = 3.0;

    fn new(n: usize) -> Self {
        Self { k: std::array::from_fn(|_| vec![0.0; n]) }
    }

    fn begin(&mut self, work: &mut Work, t: f64, x: &[f64], known: bool) -> Result<(), Fault> {
        if known {
            self.k.swap(0, 3);
            return Ok(());
        }
        work.derivatives(t, x, &mut self.k[0])
    }

    fn last_derivative(&self) -> &[f64] {
        &self.k[3]
    }

    fn last_derivative_mut(&mut self) -> &mut [f64] {
        &mut self.k[3]
    }

    fn first_derivative(&mut self) -> (&[f64], &mut [f64]) {
        let [k1, k2, ..] = &mut self.k;
        (k1, k2)
    }

    fn attempt(
        &mut self,
        work: &mut Work,
        Span { t0, t1, h }: Span,
        x0: &[f64],
        x1: &mut [f64],
        error: &mut [f64],
    ) -> Result<(), Fault> {
        let [k1, k2, k3, k4] = &mut self.k;
        combine(x1, x0, h, A2, [k1]);
        work.derivatives(t0 + C2 * h, x1, k2)?;
        combine(x1, x0, h, A3, [k1, k2]);
        work.derivatives(t0 + C3 * h, x1, k3)?;
        combine(x1, x0, h, B, [k1, k2, k3]);
        work.derivatives(t1, x1, k4)?;
        combine_error(error, h, E, [k1, k2, k3, k4]);
        for (error, ((k1, k2), k4)) in error.iter_mut().zip(k1.iter().zip(&*k2).zip(&*k4)) {
            let other = h * SECOND * (k1 - 2.0 * k2 + k4);
            if other.abs() > error.abs() {
                *error = other;
            }
        }
        Ok(())
    }

    fn interpolate(&self, theta: f64, h: f64, x0: &[f64], x1: &[f64], x: &mut [f64]) {
        let [k1, _, _, k4] = &self.k;
        let rest = 1.0 - theta;
        for i in 0..x.len() {
            let chord = x1[i] - x0[i];
            let start = h * k1[i] - chord;
            let end = chord - h * k4[i];
            x[i] = x0[i] + theta * (chord + rest * (rest * start + theta * end));
        }
    }
}
