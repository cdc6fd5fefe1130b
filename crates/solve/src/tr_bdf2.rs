//! `Ode23tb` and `Ode23t`: the trapezoidal rule, with and without a second formula that damps. Order 2; implicit, with a
//! Jacobian that is kept; for stiff systems at loose tolerances.
//!
//! `Ode23tb` makes each step of two parts: the trapezoidal rule up to 2 - sqrt 2 of it, and from there to the end the
//! differentiation formula of order 2 through the three points. Both have the same matrix I - d h J. The method is L-stable: what is
//! fast fades at once. An embedded solution of order 3 tells the error.
//!
//! `Ode23t` makes its steps by the trapezoidal rule alone, which is A-stable and damps nothing: an oscillation keeps its amplitude
//! whatever the step. What is fast does not fade by it either, but alternates. So the first step, and each one after an event, is
//! one of `Ode23tb`, which takes out what the start is not in equilibrium with. The error, h^3/12 x''', follows from the slopes
//! at the last three points.
//!
//! Both estimates pass through the matrix of the iteration, without which they would be far too large where the
//! system is stiff. The state in between is that of the parabola that belongs to the formula: through the three points, or for the
//! trapezoidal rule the one whose slope passes straight from that at the start to that at the end.
//!
//! M. E. Hosea, L. F. Shampine: Analysis and implementation of TR-BDF2, Appl. Numer. Math. 20 (1996),
//! doi 10.1016/0168-9274(95)00115-8. `ode23t`: L. F. Shampine, M. W. Reichelt, J. A. Kierzenka: Solving index-1 DAEs in MATLAB and
//! Simulink, SIAM Rev. 41 (1999), doi 10.1137/S003614459933425X.

use std::f64::consts::SQRT_2;

use crate::System;
use crate::adaptive::{Adaptive, Fault, Method, Span, Work};
use crate::combine::combine_error;
use crate::jacobian::Age;
use crate::newton::{Equation, Iteration, Newton};
use crate::start_slope::bend;
use crate::stepper::Stages;
use crate::within::{Has, Within};

/// Order 2 for stiff systems at loose tolerances; what is fast fades.
pub type Ode23tb = Adaptive<TrBdf2<true>>;

/// Order 2 for stiff systems at loose tolerances; oscillations keep their amplitude.
pub type Ode23t = Adaptive<TrBdf2<false>>;

/// Where the trapezoidal rule ends within a step of two parts.
const GAMMA: f64 = 2.0 - SQRT_2;
/// Weight of the slope at the end of either part.
const D: f64 = GAMMA / 2.0;
/// Weight of the other two slopes in the second part.
const W: f64 = SQRT_2 / 4.0;
/// Weights of order 2 less those of order 3.
const E: [f64; 3] = [(4.0 * W - 1.0) / 3.0, -1.0 / 3.0, 2.0 * D / 3.0];
/// How far ahead, in steps before, the step before is continued to begin an iteration.
const AHEAD: f64 = 2.0;

/// Error of the trapezoidal rule that is not worth a look at where it comes from.
const LITTLE: f64 = 0.01;
/// By how many tolerances a step of two parts may be off as the slopes say, of which the matrix takes out what is stiff: the state in
/// between is off by about half of that. With more, it would not know of an oscillation that a stiff state follows.
const FAR: f64 = 100.0;
/// Part of an error that the matrix leaves where not much of it is stiff.
const STIFF: f64 = 0.25;

/// Slopes and iteration of [`Ode23tb`], if every step is `DAMPED`, and [`Ode23t`].
pub struct TrBdf2<const DAMPED: bool> {
    newton: Newton,
    /// Slopes at the start, between, and at the end, as the formulas have them: what an iteration leaves of an equation does not
    /// come back multiplied by the stiffness.
    k: [Vec<f64>; 3],
    /// State between.
    middle: Vec<f64>,
    /// Where the last trial began, and state and slope where the step before began.
    start: Vec<f64>,
    past: [Vec<f64>; 2],
    predicted: Vec<f64>,
    known: Vec<f64>,
    /// Size of the last trial, and of the step before if it continues.
    tried: Option<f64>,
    before: Option<f64>,
    /// Whether the last trial was one of two parts.
    parts: bool,
    /// Its error as the slopes alone say, in units of the tolerances.
    plain: f64,
    within: Within,
}

/// A cubic through two states with their slopes, continued to the fraction `theta` of its length `h`.
fn hermite(theta: f64, h: f64, x: [f64; 2], k: [f64; 2]) -> f64 {
    let rest = 1.0 - theta;
    let chord = x[1] - x[0];
    let (start, end) = (h * k[0] - chord, chord - h * k[1]);
    x[0] + theta * (chord + rest * (rest * start + theta * end))
}

impl<const DAMPED: bool> TrBdf2<DAMPED> {
    /// Guesses the state `ahead` seconds after the start.
    fn predict(&mut self, ahead: f64, x0: &[f64]) {
        for (i, (predicted, &x0)) in self.predicted.iter_mut().zip(x0).enumerate() {
            let k0 = self.k[0][i];
            *predicted = match self.before {
                Some(before) if ahead <= AHEAD * before => {
                    hermite(1.0 + ahead / before, before, [self.past[0][i], x0], [self.past[1][i], k0])
                }
                Some(_) => x0 + ahead * k0,
                // Behind an event the slope may be that of a decay that is over long before.
                None => x0,
            };
        }
    }

    /// Solves x1 = x0 + h (a1 k1 + a2 k2) + g k for the slope k = f(t, x1), which is put in the place `to`.
    fn solve(
        &mut self,
        work: &mut Work,
        Part { t, h, a, g, to }: Part,
        x0: &[f64],
        x1: &mut [f64],
    ) -> Iteration {
        if let Err(fault) = self.newton.factor(work, g) {
            return Iteration::Failed(fault);
        }
        let Self { newton, k, predicted, known, .. } = self;
        for i in 0..x0.len() {
            known[i] = predicted[i] - x0[i] - h * (a[0] * k[0][i] + a[1] * k[1][i]);
        }
        let iteration = newton.iterate(work, &Equation { t, g, predicted, known, x0, h }, x1);
        for ((k, known), step) in k[to].iter_mut().zip(known).zip(&newton.step) {
            *k = (*known + step) / g;
        }
        iteration
    }

    /// A step of two parts.
    fn composite(&mut self, work: &mut Work, span: Span, x0: &[f64], x1: &mut [f64]) -> Iteration {
        let Span { t0, t1, h } = span;
        self.predict(GAMMA * h, x0);
        let g = D * h;
        let iteration = self.solve(work, Part { t: t0 + GAMMA * h, h, a: [D, 0.0], g, to: 1 }, x0, x1);
        let Iteration::Converged = iteration else { return iteration };
        self.middle.copy_from_slice(x1);
        for (i, (predicted, &x0)) in self.predicted.iter_mut().zip(x0).enumerate() {
            let k = [self.k[0][i], self.k[1][i]];
            *predicted = hermite(1.0 / GAMMA, GAMMA * h, [x0, self.middle[i]], k);
        }
        self.solve(work, Part { t: t1, h, a: [W, W], g, to: 2 }, x0, x1)
    }

    /// A step of the trapezoidal rule.
    fn rule(&mut self, work: &mut Work, span: Span, x0: &[f64], x1: &mut [f64]) -> Iteration {
        let Span { t1, h, .. } = span;
        self.predict(h, x0);
        self.solve(work, Part { t: t1, h, a: [0.5, 0.0], g: 0.5 * h, to: 2 }, x0, x1)
    }

    /// Makes the estimate of a step of two parts small where that is stiff, by a Jacobian that is not one of before: one that
    /// is larger than it should be would hide any error.
    fn filter(&mut self, work: &mut Work, span: Span, x0: &[f64], error: &mut [f64]) -> Result<(), Fault> {
        if self.newton.slopes == Age::Current {
            return Ok(());
        }
        self.newton.differentiate(work, span.t0, x0, span.h)?;
        self.newton.factor(work, D * span.h)?;
        self.estimate(span.h, error);
        self.newton.jacobian.solve(error);
        Ok(())
    }

    /// How far the extension of state `i` is from the straight line over the step, as a part of theta (1 - theta).
    #[inline]
    fn bow(&self, i: usize, h: f64, x0: &[f64], x1: &[f64]) -> f64 {
        if self.parts {
            (self.middle[i] - x0[i] - GAMMA * (x1[i] - x0[i])) / (GAMMA * (1.0 - GAMMA))
        } else {
            0.5 * h * (self.k[0][i] - self.k[2][i])
        }
    }

    /// Estimates the error of the last trial, but for the matrix.
    fn estimate(&self, h: f64, error: &mut [f64]) {
        let [k0, k1, k2] = &self.k;
        match self.before.filter(|_| !self.parts) {
            None => combine_error(error, h, E, [k0, k1, k2]),
            Some(before) => {
                // h^3/12 times twice the second divided difference of the slopes.
                let weight = h.powi(3) / (6.0 * (h + before));
                for (i, error) in error.iter_mut().enumerate() {
                    *error = weight * ((k2[i] - k0[i]) / h - (k0[i] - self.past[1][i]) / before);
                }
            }
        }
    }
}

/// One of the equations of a step.
struct Part {
    /// End of the part, s, and size of the step, s.
    t: f64,
    h: f64,
    /// Weights of the slopes at the start and between, as parts of the step.
    a: [f64; 2],
    /// Weight of the slope that is sought, s.
    g: f64,
    /// Where that is put.
    to: usize,
}

impl<const DAMPED: bool> Method for TrBdf2<DAMPED> {
    const NAME: &'static str = if DAMPED { "Ode23tb" } else { "Ode23t" };
    const ORDER: f64 = 2.0;
    const ERROR_POWER: f64 = 3.0;
    const KEEPS_SIZE: bool = true;

    const IS_ROUGH_WITHIN: bool = true;
    const SEES_WITHIN: bool = DAMPED;

    fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            newton: Newton::new(n),
            k: std::array::from_fn(|_| zeros()),
            middle: zeros(),
            start: zeros(),
            past: [zeros(), zeros()],
            predicted: zeros(),
            known: zeros(),
            tried: None,
            before: None,
            parts: true,
            plain: 0.0,
            within: Within::new(n),
        }
    }

    fn reserve(&mut self, system: &dyn System) {
        self.newton.jacobian.reserve(system);
    }

    fn begin(&mut self, work: &mut Work, t: f64, x: &[f64], known: bool) -> Result<(), Fault> {
        self.newton.begin();
        self.newton.doubt();
        if !known {
            self.newton.distrust();
        }
        self.before = self.tried.take().filter(|_| known);
        if known {
            let [past, past_slope] = &mut self.past;
            std::mem::swap(past, &mut self.start);
            std::mem::swap(past_slope, &mut self.k[0]);
            self.k.swap(0, 2);
            return Ok(());
        }
        work.derivatives(t, x, &mut self.k[0])
    }

    fn last_derivative(&self) -> &[f64] {
        &self.k[2]
    }

    fn last_derivative_mut(&mut self) -> &mut [f64] {
        &mut self.k[2]
    }

    fn first_derivative(&mut self) -> (&[f64], &mut [f64]) {
        let [k0, k1, _] = &mut self.k;
        (k0, k1)
    }

    fn attempt(
        &mut self,
        work: &mut Work,
        span: Span,
        x0: &[f64],
        x1: &mut [f64],
        error: &mut [f64],
    ) -> Result<(), Fault> {
        self.start.copy_from_slice(x0);
        self.within.forget();
        self.parts = DAMPED || self.before.is_none();
        if self.newton.slopes == Age::Unknown {
            self.newton.differentiate(work, span.t0, x0, span.h)?;
        }
        loop {
            let iteration =
                if self.parts { self.composite(work, span, x0, x1) } else { self.rule(work, span, x0, x1) };
            match iteration {
                Iteration::Converged => {}
                Iteration::Failed(fault) => return Err(fault),
                Iteration::Slow if self.newton.slopes == Age::Current => {
                    let state = work.weights.worst(x0, x0, &self.newton.correction, span.h);
                    return Err(Fault::NotFinite(state));
                }
                Iteration::Slow => {
                    self.newton.differentiate(work, span.t0, x0, span.h)?;
                    continue;
                }
            }
            self.estimate(span.h, error);
            let plain = work.weights.norm(x0, x1, error, span.h);
            self.plain = plain;
            if !self.parts && plain <= LITTLE {
                break;
            }
            self.newton.jacobian.solve(error);
            let filtered = work.weights.norm(x0, x1, error, span.h);
            if self.parts {
                if filtered <= 1.0 && plain > 1.0 {
                    self.filter(work, span, x0, error)?;
                }
                break;
            }
            if filtered > STIFF * plain {
                self.estimate(span.h, error);
                break;
            }
            // What is small by the matrix alone alternates from step to step and must be damped.
            self.parts = true;
        }
        self.tried = Some(span.h);
        Ok(())
    }

    fn finish(&mut self, _work: &mut Work, _kept: Span, _x0: &[f64], _x1: &[f64]) -> Result<f64, Fault> {
        Ok(if self.parts { self.plain / FAR } else { 0.0 })
    }

    fn sharpen(&mut self, work: &mut Work, span: Span, x0: &[f64], x1: &[f64]) -> Result<(), Fault> {
        if self.within.is_known() {
            return Ok(());
        }
        let mut within = std::mem::take(&mut self.within);
        let extension =
            |method: &Self, i: usize, theta: f64| theta * (1.0 - theta) * method.bow(i, span.h, x0, x1);
        let solve = |method: &mut Self, b: &mut [f64]| method.newton.jacobian.solve(b);
        // The matrix is that of the last slope.
        let weight = if self.parts { D } else { 0.5 };
        let found = within.find(self, work, span, [x0, x1], Has { gamma: weight, extension, solve });
        self.within = within;
        found.map(drop)
    }

    fn interpolate(&self, theta: f64, h: f64, x0: &[f64], x1: &[f64], x: &mut [f64]) {
        if self.within.is_known() {
            return self.within.interpolate(theta, x0, x1, x);
        }
        let rest = 1.0 - theta;
        for i in 0..x.len() {
            let chord = x1[i] - x0[i];
            let bow = self.bow(i, h, x0, x1);
            let bend = if self.parts { bend(h * self.k[0][i], chord + bow, chord) } else { 0.0 };
            x[i] = x0[i] + theta * (chord + rest * (bow + rest * bend));
        }
    }

    fn stages(&self) -> Option<Box<Stages>> {
        Some(Box::new(Stages {
            newton: self.newton.memory(),
            quick: false,
            tried: self.tried,
            columns: vec![self.start.clone(), self.k[0].clone()],
        }))
    }

    fn recall(&mut self, stages: &Stages) {
        self.newton.recall(&stages.newton);
        (self.before, self.tried) = (None, stages.tried);
        if let [start, slope] = &stages.columns[..] {
            self.start.clone_from(start);
            self.k[0].clone_from(slope);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trees::{Family, largest_defect, square};

    #[test]
    fn the_step_of_two_parts_has_order_two_and_its_embedded_solution_order_three() {
        let b = [W, W, D];
        let a = square(&[&[], &[D, D], &b]);
        let embedded: Vec<f64> = b.iter().zip(E).map(|(b, e)| b - e).collect();
        let defect = |b: &[f64], order| largest_defect(Family::RungeKutta, &a, &[], b, 1.0, order);
        assert!(defect(&b, 2) < 1e-15 && defect(&b, 3) > 1e-2);
        assert!(defect(&embedded, 3) < 1e-15 && defect(&embedded, 4) > 1e-2);
        // The second part is the differentiation formula: x1 = (x_gamma - (1 - gamma)^2 x0) / (gamma (2 - gamma)) + d h k1.
        let through = 1.0 / (GAMMA * (2.0 - GAMMA));
        assert!((through * D - W).abs() < 1e-15 && ((1.0 - GAMMA) / (2.0 - GAMMA) - D).abs() < 1e-15);
        assert!((through * (1.0 - (1.0 - GAMMA).powi(2)) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_cubic_is_continued_as_it_is() {
        let (x, slope) = (|t: f64| t.powi(3) - 2.0 * t, |t: f64| 3.0 * t * t - 2.0);
        let found = hermite(2.5, 2.0, [x(1.0), x(3.0)], [slope(1.0), slope(3.0)]);
        assert!((found - x(6.0)).abs() < 1e-12);
    }
}
