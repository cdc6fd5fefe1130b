//! `Dop853`: Dormand and Prince's method of order 8 in the form of Hairer's code. Twelve stages, and the derivative at the end,
//! which begins the next step; an error estimate of order 7 out of embedded solutions of orders 5 and 3; explicit;
//! continuous extension of order 7, for which a step that is kept takes three more evaluations.
//!
//! For what is smooth and not stiff at tight tolerances, from about 1e-8 on: at 1e-10 it takes two thirds of the evaluations
//! of `Ode45`, at 1e-12 two fifths. Where events or kinks cut most steps short, long steps gain nothing; take `Ode45` there.
//!
//! P. J. Prince, J. R. Dormand: High order embedded Runge-Kutta formulae, J. Comput. Appl. Math. 7 (1981),
//! doi 10.1016/0771-050X(81)90010-3. Error estimate, extension and coefficients: E. Hairer, S. P. Nørsett, G. Wanner: Solving
//! Ordinary Differential Equations I, 2nd ed., sections II.5, II.6 and II.10, and the code DOP853 that goes with it.

mod table;

use crate::adaptive::{Adaptive, Fault, Method, Radius, Span, Work, difference_radius};
use crate::combine::{combine, combine_error};
use crate::weights::Weights;
use table::{A2, A3, A4, A5, A6, A7, A8, A9, A10, A11, A12, A14, A15, A16, B, B3, C, D, E5};

/// Order 8 for smooth systems at tight tolerances.
pub type Dop853 = Adaptive<DormandPrince8>;

/// How much the estimate of order 3 counts beside that of order 5.
const LOW: f64 = 0.1;

/// Stages of [`Dop853`].
pub struct DormandPrince8 {
    k: [Vec<f64>; 16],
    /// Where stage 12 was evaluated, at the end of the step as stage 13.
    twelfth: Vec<f64>,
    /// Where a stage of the extension is evaluated.
    between: Vec<f64>,
    /// The four highest terms of the extension.
    terms: [Vec<f64>; 4],
}

impl Method for DormandPrince8 {
    const NAME: &'static str = "Dop853";
    const ORDER: f64 = 8.0;
    const ERROR_POWER: f64 = 8.0;
    // Stability ends at 6.1.
    const NEAR_EDGE: f64 = 4.6;

    fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            k: std::array::from_fn(|_| zeros()),
            twelfth: zeros(),
            between: zeros(),
            terms: std::array::from_fn(|_| zeros()),
        }
    }

    fn radius(&self, weights: &Weights, x0: &[f64], x1: &[f64], h: f64) -> Radius {
        difference_radius(weights, [x0, x1], [&self.k[11], &self.k[12]], &self.twelfth, h)
    }

    fn begin(&mut self, work: &mut Work, t: f64, x: &[f64], known: bool) -> Result<(), Fault> {
        if known {
            self.k.swap(0, 12);
            return Ok(());
        }
        work.derivatives(t, x, &mut self.k[0])
    }

    fn last_derivative(&self) -> &[f64] {
        &self.k[12]
    }

    fn last_derivative_mut(&mut self) -> &mut [f64] {
        &mut self.k[12]
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
        let [k1, k2, k3, k4, k5, k6, k7, k8, k9, k10, k11, k12, k13, ..] = &mut self.k;
        combine(x1, x0, h, A2, [k1]);
        work.derivatives(t0 + C[1] * h, x1, k2)?;
        combine(x1, x0, h, A3, [k1, k2]);
        work.derivatives(t0 + C[2] * h, x1, k3)?;
        combine(x1, x0, h, A4, [k1, k3]);
        work.derivatives(t0 + C[3] * h, x1, k4)?;
        combine(x1, x0, h, A5, [k1, k3, k4]);
        work.derivatives(t0 + C[4] * h, x1, k5)?;
        combine(x1, x0, h, A6, [k1, k4, k5]);
        work.derivatives(t0 + C[5] * h, x1, k6)?;
        combine(x1, x0, h, A7, [k1, k4, k5, k6]);
        work.derivatives(t0 + C[6] * h, x1, k7)?;
        combine(x1, x0, h, A8, [k1, k4, k5, k6, k7]);
        work.derivatives(t0 + C[7] * h, x1, k8)?;
        combine(x1, x0, h, A9, [k1, k4, k5, k6, k7, k8]);
        work.derivatives(t0 + C[8] * h, x1, k9)?;
        combine(x1, x0, h, A10, [k1, k4, k5, k6, k7, k8, k9]);
        work.derivatives(t0 + C[9] * h, x1, k10)?;
        combine(x1, x0, h, A11, [k1, k4, k5, k6, k7, k8, k9, k10]);
        work.derivatives(t0 + C[10] * h, x1, k11)?;
        combine(x1, x0, h, A12, [k1, k4, k5, k6, k7, k8, k9, k10, k11]);
        self.twelfth.copy_from_slice(x1);
        work.derivatives(t1, x1, k12)?;
        combine(x1, x0, h, B, [k1, k6, k7, k8, k9, k10, k11, k12]);
        work.derivatives(t1, x1, k13)?;

        // What the solution differs from that of order 3, in the place of a stage that has served.
        let [b1, b6, b7, b8, b9, b10, b11, b12] = B;
        let e3 = [b1 - B3[0], b6, b7, b8, b9 - B3[1], b10, b11, b12 - B3[2]];
        combine_error(k2, h, e3, [k1, k6, k7, k8, k9, k10, k11, k12]);
        combine_error(error, h, E5, [k1, k6, k7, k8, k9, k10, k11, k12]);
        let low = LOW * work.weights.norm(x0, x1, k2, h);
        let high = work.weights.norm(x0, x1, error, h);
        if high.is_finite() && low.is_finite() && high > 0.0 {
            // err = err5 err5 / sqrt(err5^2 + 0.01 err3^2), which behaves as h^8.
            let part = high / high.hypot(low);
            error.iter_mut().for_each(|error| *error *= part);
        }
        Ok(())
    }

    fn finish(
        &mut self,
        work: &mut Work,
        Span { t0, h, .. }: Span,
        x0: &[f64],
        _x1: &[f64],
    ) -> Result<f64, Fault> {
        let [k1, _, _, _, _, k6, k7, k8, k9, k10, k11, k12, k13, k14, k15, k16] = &mut self.k;
        let x = &mut self.between;
        combine(x, x0, h, A14, [k1, k7, k8, k9, k10, k11, k12, k13]);
        work.derivatives(t0 + C[13] * h, x, k14)?;
        combine(x, x0, h, A15, [k1, k6, k7, k8, k11, k12, k13, k14]);
        work.derivatives(t0 + C[14] * h, x, k15)?;
        combine(x, x0, h, A16, [k1, k6, k7, k8, k9, k13, k14, k15]);
        work.derivatives(t0 + C[15] * h, x, k16)?;
        for (term, d) in self.terms.iter_mut().zip(D) {
            combine_error(term, h, d, [k1, k6, k7, k8, k9, k10, k11, k12, k13, k14, k15, k16]);
        }
        Ok(0.0)
    }

    fn interpolate(&self, theta: f64, h: f64, x0: &[f64], x1: &[f64], x: &mut [f64]) {
        let (k1, k13, [d1, d2, d3, d4]) = (&self.k[0], &self.k[12], &self.terms);
        let rest = 1.0 - theta;
        for i in 0..x.len() {
            let chord = x1[i] - x0[i];
            let start = h * k1[i] - chord;
            let end = chord - h * k13[i] - start;
            let high = d1[i] + theta * (d2[i] + rest * (d3[i] + theta * d4[i]));
            x[i] = x0[i] + theta * (chord + rest * (start + theta * (end + rest * high)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trees::{Family, largest_defect};

    /// A row of all sixteen stages.
    fn row<const M: usize>(stages: [usize; M], values: [f64; M]) -> Vec<f64> {
        let mut row = vec![0.0; 16];
        stages.into_iter().zip(values).for_each(|(stage, value)| row[stage - 1] = value);
        row
    }

    /// The matrix of the method and of its extension.
    fn matrix() -> Vec<Vec<f64>> {
        vec![
            row([], []),
            row([1], A2),
            row([1, 2], A3),
            row([1, 3], A4),
            row([1, 3, 4], A5),
            row([1, 4, 5], A6),
            row([1, 4, 5, 6], A7),
            row([1, 4, 5, 6, 7], A8),
            row([1, 4, 5, 6, 7, 8], A9),
            row([1, 4, 5, 6, 7, 8, 9], A10),
            row([1, 4, 5, 6, 7, 8, 9, 10], A11),
            row([1, 4, 5, 6, 7, 8, 9, 10, 11], A12),
            weights(),
            row([1, 7, 8, 9, 10, 11, 12, 13], A14),
            row([1, 6, 7, 8, 11, 12, 13, 14], A15),
            row([1, 6, 7, 8, 9, 13, 14, 15], A16),
        ]
    }

    fn weights() -> Vec<f64> {
        row([1, 6, 7, 8, 9, 10, 11, 12], B)
    }

    fn defect(b: &[f64], theta: f64, order: usize) -> f64 {
        largest_defect(Family::RungeKutta, &matrix(), &[], b, theta, order)
    }

    #[test]
    fn the_table_meets_the_conditions_of_order_eight_and_the_embedded_ones_those_of_five_and_three() {
        let less = |b: Vec<f64>| weights().iter().zip(b).map(|(w, b)| w - b).collect::<Vec<f64>>();
        let fifth = less(row([1, 6, 7, 8, 9, 10, 11, 12], E5));
        let third = row([1, 9, 12], B3);
        for (b, order) in [(weights(), 8), (fifth, 5), (third, 3)] {
            assert!(defect(&b, 1.0, order) < 1e-14, "{order}: {:e}", defect(&b, 1.0, order));
            assert!(defect(&b, 1.0, order + 1) > 1e-7, "{order}: {:e}", defect(&b, 1.0, order + 1));
        }
    }

    #[test]
    fn the_extension_meets_the_conditions_of_order_seven_anywhere() {
        for theta in [0.1, 0.3, 0.5, 0.8, 1.0] {
            // What each stage adds at theta, read from the extension itself.
            let of = |stage: usize| {
                let mut method = DormandPrince8::new(1);
                method.k[stage][0] = 1.0;
                let high = [1, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16].iter().position(|s| s - 1 == stage);
                for (term, d) in method.terms.iter_mut().zip(D) {
                    term[0] = high.map_or(0.0, |at| d[at]);
                }
                let mut x = [0.0];
                method.interpolate(theta, 1.0, &[0.0], &[weights()[stage]], &mut x);
                x[0]
            };
            let b: Vec<f64> = (0..16).map(of).collect();
            assert!(defect(&b, theta, 7) < 1e-12, "{theta}: {:e}", defect(&b, theta, 7));
            assert!(theta == 1.0 || defect(&b, theta, 8) > 1e-8, "{theta}");
        }
    }

    #[test]
    fn the_abscissae_are_the_sums_of_the_rows() {
        for (c, row) in C.iter().zip(matrix()) {
            assert!((c - row.iter().sum::<f64>()).abs() < 1e-14, "{c} {row:?}");
        }
    }
}
