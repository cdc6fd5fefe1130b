//! `Radau5`: Radau IIA, three implicit stages of order 5, L-stable and stiffly accurate; continuous extension of order 3. For
//! stiff systems at tight tolerances, where differentiation formulas take many short steps.
//!
//! Stages are found by simplified Newton iteration in coordinates in which the three equations are one and a pair; the pair
//! is solved as one of twice the size. The Jacobian is kept as long as the iteration converges
//! quickly, the factors as long as the step stays, too.
//!
//! E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, 2nd ed., section IV.8,
//! doi 10.1007/978-3-642-05221-7.

#![expect(clippy::excessive_precision, reason = "the digits are those of the tables")]

use crate::System;
use crate::adaptive::{Adaptive, Fault, Method, Span, Work};
use crate::jacobian::{Age, Jacobian, Twice};
use crate::newton::{Change, Convergence, MORE, ROUNDING, SHAKEN, STANDING};
use crate::shake::shake;
use crate::stepper::Stages;

/// Order 5 for stiff systems at tight tolerances.
pub type Radau5 = Adaptive<RadauIIA>;

const SQRT6: f64 = 2.449_489_742_783_178;
const C: [f64; 3] = [(4.0 - SQRT6) / 10.0, (4.0 + SQRT6) / 10.0, 1.0];

/// Eigenvalues of the inverse of the matrix of the method: one real, and a complex pair by its parts.
const REAL: f64 = 3.637_834_252_744_495_7;
const PAIR: (f64, f64) = (2.681_082_873_627_752_1, 3.050_430_199_247_410_6);

/// Coordinates in which it is that real one and [a b; -b a], and back: Z = T W, W = I Z.
const T: [[f64; 3]; 3] = [
    [0.09443876248897524, -0.14125529502095421, 0.03002919410514742],
    [0.25021312296533332, 0.20412935229379994, -0.38294211275726192],
    [1.0, 1.0, 0.0],
];
const I: [[f64; 3]; 3] = [
    [4.17871859155190428, 0.32768282076106237, 0.52337644549944951],
    [-4.17871859155190428, -0.32768282076106237, 0.47662355450055044],
    [0.50287263494578682, -2.57192694985560522, 0.59603920482822492],
];

/// Weights of the error estimate.
const E: [f64; 3] = [(-13.0 - 7.0 * SQRT6) / 3.0, (-13.0 + 7.0 * SQRT6) / 3.0, -1.0 / 3.0];

/// The extension: coefficients of theta, theta^2, theta^3 for each stage.
const P: [[f64; 3]; 3] = [
    [13.0 / 3.0 + 7.0 * SQRT6 / 3.0, -23.0 / 3.0 - 22.0 * SQRT6 / 3.0, 10.0 / 3.0 + 5.0 * SQRT6],
    [13.0 / 3.0 - 7.0 * SQRT6 / 3.0, -23.0 / 3.0 + 22.0 * SQRT6 / 3.0, 10.0 / 3.0 - 5.0 * SQRT6],
    [1.0 / 3.0, -8.0 / 3.0, 10.0 / 3.0],
];

/// Where the extension gets the derivative of f as well. There the polynomial that is zero at the start and at the stages
/// is its slope over REAL, so that one step of Newton's method takes the matrix that is already factored.
const BETWEEN: f64 = 0.338_355_649_213_923_25;
/// By how many tolerances the extension without that may be off there.
const FAR: f64 = 10.0;

/// Newton iterations of one step, at most.
const ITERATIONS: usize = 7;
/// Error of the iteration, as a part of what the step may err by.
const CONVERGED: f64 = 0.03;
/// Convergence that is quick enough to keep the Jacobian.
const QUICK: f64 = 1e-3;

/// Stages and matrices of [`Radau5`].
pub struct RadauIIA {
    jacobian: Jacobian,
    pair: Twice,
    /// Whether there is a Jacobian, and whether it belongs to the start of this step.
    slopes: Age,
    /// Step that the factors belong to; not a number if there are none.
    factored: f64,
    /// Whether the last iteration was so quick that its Jacobian may serve on.
    quick: bool,
    f0: Vec<f64>,
    f: [Vec<f64>; 3],
    /// What the stages add to the state, and the same in the other coordinates.
    z: [Vec<f64>; 3],
    w: [Vec<f64>; 3],
    /// Corrections of the pair.
    both: Vec<f64>,
    one: Vec<f64>,
    /// Corrections that are left, and what the last bits of the states change in them.
    left: Vec<[f64; 3]>,
    noise: Vec<f64>,
    /// What was left of the equations of each state before the last correction, and the correction before: the largest of the three.
    missing: Vec<f64>,
    past: Vec<f64>,
    /// Size of the step before, if `z` are its stages and may be continued; and of a trial from the same start.
    before: Option<f64>,
    tried: Option<f64>,
    /// What is missing in the extension where it is made right, and in its slope at the start.
    off: Vec<f64>,
    start: Vec<f64>,
}

/// How an iteration ended.
enum Iteration {
    Converged,
    Slow,
    Failed(Fault),
}

impl RadauIIA {
    /// First values of the stages: the polynomial of the step before goes on, or nothing moves.
    fn guess(&mut self, h: f64) {
        let n = self.f0.len();
        let (shift, length) = (if self.tried.is_some() { 0.0 } else { 1.0 }, self.tried.or(self.before));
        (self.before, self.tried) = (None, None);
        let Some(length) = length else {
            self.z.iter_mut().chain(&mut self.w).for_each(|column| column.fill(0.0));
            return;
        };
        for i in 0..n {
            let z = [self.z[0][i], self.z[1][i], self.z[2][i]];
            let mut next = [0.0; 3];
            for (next, c) in next.iter_mut().zip(C) {
                *next = extension(&z, shift + c * h / length) - shift * z[2];
            }
            for j in 0..3 {
                self.z[j][i] = next[j];
                self.w[j][i] = I[j][0] * next[0] + I[j][1] * next[1] + I[j][2] * next[2];
            }
        }
    }

    /// What the stages are still off by, in `one` and `both`; of the number zero, or with other last bits of the states.
    fn correct(
        &mut self,
        work: &mut Work,
        span: Span,
        x0: &[f64],
        x1: &mut [f64],
        number: usize,
    ) -> Result<(), Fault> {
        let (h, n) = (span.h, x0.len());
        for (j, c) in C.into_iter().enumerate() {
            x1.iter_mut().zip(x0).zip(&self.z[j]).for_each(|((x, x0), z)| *x = x0 + z);
            if number > 0 {
                self.one.copy_from_slice(x1);
                shake(&self.one, number + j * SHAKEN, x1);
            }
            let t = if j == 2 { span.t1 } else { span.t0 + c * h };
            work.derivatives(t, x1, &mut self.f[j])?;
        }
        // In units of the step: h / gamma (I F) - W for the real one, h / a for the pair.
        for i in 0..n {
            let f = [self.f[0][i], self.f[1][i], self.f[2][i]];
            let of = |row: &[f64; 3]| h * (row[0] * f[0] + row[1] * f[1] + row[2] * f[2]);
            let (a, b) = PAIR;
            self.one[i] = of(&I[0]) / REAL - self.w[0][i];
            self.both[i] = of(&I[1]) / a - self.w[1][i] - b / a * self.w[2][i];
            self.both[n + i] = of(&I[2]) / a - self.w[2][i] + b / a * self.w[1][i];
        }
        for i in 0..n {
            self.missing[i] = largest(self.corrections(i));
        }
        self.jacobian.solve(&mut self.one);
        self.pair.solve(&mut self.both);
        Ok(())
    }

    /// Whether a state may be far from what it should be, although its last corrections are small, as for a single equation.
    fn hides(&self, work: &Work, x0: &[f64], x1: &[f64], h: f64, seen: bool) -> bool {
        (0..x0.len()).any(|i| {
            let change =
                Change { left: self.missing[i], now: largest(self.corrections(i)), before: self.past[i] };
            change.hides(work, x0[i].abs().max(x1[i].abs()), (i, h), seen)
        })
    }

    /// The corrections of a state, in the other coordinates.
    fn corrections(&self, i: usize) -> [f64; 3] {
        let n = self.one.len();
        [self.one[i], self.both[i], self.both[n + i]]
    }

    /// Whether changes of the last bits of the states make as much difference to the next correction as there is left of it.
    fn is_rounding(&mut self, work: &mut Work, span: Span, x0: &[f64], x1: &mut [f64]) -> bool {
        self.noise.fill(0.0);
        for number in 0..=SHAKEN {
            if self.correct(work, span, x0, x1, number).is_err() {
                return false;
            }
            let mut is_little = true;
            for i in 0..x0.len() {
                let now = self.corrections(i);
                if number == 0 {
                    self.left[i] = now;
                    continue;
                }
                let changed = now.iter().zip(self.left[i]).map(|(a, b)| (a - b).abs());
                self.noise[i] = changed.fold(self.noise[i], f64::max);
                x1[i] = x0[i] + self.z[2][i];
                let unit = work.weights.scale(i, x0[i].abs().max(x1[i].abs()), span.h);
                let multiple = if number == SHAKEN { ROUNDING } else { MORE };
                let bound = (multiple * self.noise[i]).max(STANDING * unit);
                // What is not a number is no rounding.
                is_little &= self.left[i].iter().all(|left| left.abs() <= bound);
            }
            if !is_little {
                return false;
            }
        }
        true
    }

    /// Finds the stages. Where that fails again and again with the Jacobian of now they are as near as they get if all that is left is
    /// rounding.
    fn iterate(&mut self, work: &mut Work, span: Span, x0: &[f64], x1: &mut [f64]) -> Iteration {
        let iteration = self.search(work, span, x0, x1);
        if matches!(iteration, Iteration::Slow)
            && self.slopes == Age::Current
            && work.weights.may_be_rounding()
            && self.is_rounding(work, span, x0, x1)
        {
            self.quick = false;
            return Iteration::Converged;
        }
        iteration
    }

    fn search(&mut self, work: &mut Work, span: Span, x0: &[f64], x1: &mut [f64]) -> Iteration {
        let (h, n) = (span.h, x0.len());
        let mut size_before = f64::NAN;
        let mut slowest: f64 = 0.0;
        // Where rounding of one state may be what stands, the others come as near as they get.
        let is_patient = self.slopes == Age::Current && work.weights.may_be_rounding();
        for iteration in 0..ITERATIONS {
            if let Err(fault) = self.correct(work, span, x0, x1, 0) {
                return Iteration::Failed(fault);
            }
            let corrections = [&self.one[..], &self.both[..n], &self.both[n..]];
            for (w, correction) in self.w.iter_mut().zip(corrections) {
                w.iter_mut().zip(correction).for_each(|(w, c)| *w += c);
            }
            for i in 0..n {
                let w = [self.w[0][i], self.w[1][i], self.w[2][i]];
                for (z, row) in self.z.iter_mut().zip(&T) {
                    z[i] = row[0] * w[0] + row[1] * w[1] + row[2] * w[2];
                }
                x1[i] = x0[i] + self.z[2][i];
            }
            // What begins at zero has the size that the step gives it.
            let squares = corrections.map(|correction| work.weights.norm(x0, x1, correction, h).powi(2));
            let size = (squares.iter().sum::<f64>() / 3.0).sqrt();
            if !size.is_finite() {
                return Iteration::Slow;
            }
            let least = 10.0 * f64::EPSILON / work.weights.relative().max(f64::EPSILON);
            if size <= least.min(CONVERGED) {
                self.quick = slowest <= QUICK;
                return Iteration::Converged;
            }
            if iteration > 0 {
                let rate = size / size_before;
                if rate >= 0.99 {
                    if is_patient {
                        size_before = size;
                        continue;
                    }
                    return Iteration::Slow;
                }
                slowest = slowest.max(rate);
                let left = rate / (1.0 - rate) * size;
                if left <= CONVERGED && !self.hides(work, x0, x1, h, iteration > 1) {
                    self.quick = slowest <= QUICK;
                    return Iteration::Converged;
                }
                if left * rate.powi((ITERATIONS - 1 - iteration) as i32) > CONVERGED && !is_patient {
                    return Iteration::Slow;
                }
            }
            size_before = size;
            for i in 0..n {
                self.past[i] = largest(self.corrections(i));
            }
        }
        Iteration::Slow
    }

    fn differentiate(&mut self, work: &mut Work, span: Span, x0: &[f64]) -> Result<(), Fault> {
        self.jacobian.evaluate(work, span.t0, x0, &self.f0, span.h)?;
        (self.slopes, self.factored) = (Age::Current, f64::NAN);
        Ok(())
    }

    fn factor(&mut self, work: &mut Work, h: f64) -> Result<(), Fault> {
        if self.factored != h {
            self.factored = f64::NAN;
            self.jacobian.factor(work, h / REAL)?;
            self.jacobian.factor_pair(work, &mut self.pair, h / PAIR.0, PAIR.1 / PAIR.0)?;
            self.factored = h;
        }
        Ok(())
    }
}

fn largest(values: [f64; 3]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// How much the state has changed at a fraction of the step.
fn extension(z: &[f64; 3], theta: f64) -> f64 {
    let mut sum = 0.0;
    for (z, p) in z.iter().zip(&P) {
        sum += z * theta * (p[0] + theta * (p[1] + theta * p[2]));
    }
    sum
}

/// What that grows by at a fraction of the step, as the way over the step.
fn slope(z: &[f64; 3], theta: f64) -> f64 {
    let terms = z.iter().zip(&P).map(|(z, p)| z * (p[0] + theta * (2.0 * p[1] + theta * 3.0 * p[2])));
    terms.sum()
}

/// Zero at the start and at the stages.
fn bump(theta: f64) -> f64 {
    C.into_iter().fold(theta, |product, c| product * (theta - c))
}

impl Method for RadauIIA {
    const NAME: &'static str = "Radau5";
    const ORDER: f64 = 5.0;
    const ERROR_POWER: f64 = 4.0;
    const KEEPS_SIZE: bool = true;

    fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            jacobian: Jacobian::new(n),
            pair: Twice::new(n),
            slopes: Age::Unknown,
            factored: f64::NAN,
            quick: false,
            f0: zeros(),
            f: std::array::from_fn(|_| zeros()),
            z: std::array::from_fn(|_| zeros()),
            w: std::array::from_fn(|_| zeros()),
            both: vec![0.0; 2 * n],
            one: zeros(),
            left: vec![[0.0; 3]; n],
            noise: zeros(),
            missing: zeros(),
            past: zeros(),
            before: None,
            tried: None,
            off: zeros(),
            start: zeros(),
        }
    }

    fn reserve(&mut self, system: &dyn System) {
        self.jacobian.reserve(system);
    }

    fn begin(&mut self, work: &mut Work, t: f64, x: &[f64], known: bool) -> Result<(), Fault> {
        if self.slopes == Age::Current {
            self.slopes = Age::Old;
        }
        self.before = self.tried.take().filter(|_| known);
        self.quick &= known;
        work.derivatives(t, x, &mut self.f0)
    }

    fn first_derivative(&mut self) -> (&[f64], &mut [f64]) {
        (&self.f0, &mut self.f[0])
    }

    fn attempt(
        &mut self,
        work: &mut Work,
        span: Span,
        x0: &[f64],
        x1: &mut [f64],
        error: &mut [f64],
    ) -> Result<(), Fault> {
        let h = span.h;
        if self.slopes == Age::Unknown || self.slopes == Age::Old && !self.quick {
            self.differentiate(work, span, x0)?;
        }
        self.guess(h);
        loop {
            self.factor(work, h)?;
            match self.iterate(work, span, x0, x1) {
                Iteration::Converged => break,
                Iteration::Failed(fault) => return Err(fault),
                Iteration::Slow if self.slopes == Age::Current => {
                    return Err(Fault::NotFinite(work.weights.worst(x0, x0, &self.one, h)));
                }
                Iteration::Slow => {
                    self.differentiate(work, span, x0)?;
                    self.guess(h);
                }
            }
        }
        let n = x0.len();
        let jump = |z: &[Vec<f64>; 3], i: usize| (E[0] * z[0][i] + E[1] * z[1][i] + E[2] * z[2][i]) / h;
        for i in 0..n {
            x1[i] = x0[i] + self.z[2][i];
            error[i] = h / REAL * (self.f0[i] + jump(&self.z, i));
        }
        self.jacobian.solve(error);
        if work.weights.norm(x0, x1, error, h) >= 1.0 {
            // What is stiff hides the error; once more, from where the estimate leads.
            for i in 0..n {
                self.one[i] = x0[i] + error[i];
            }
            work.derivatives(span.t0, &self.one, &mut self.f[0])?;
            for (i, error) in error.iter_mut().enumerate() {
                *error = h / REAL * (self.f[0][i] + jump(&self.z, i));
            }
            self.jacobian.solve(error);
        }
        self.tried = Some(h);
        Ok(())
    }

    fn finish(&mut self, work: &mut Work, span: Span, x0: &[f64], x1: &[f64]) -> Result<f64, Fault> {
        let h = span.h;
        let Self { z, f: [f, slopes, _], one, .. } = self;
        for i in 0..x0.len() {
            let z = [z[0][i], z[1][i], z[2][i]];
            one[i] = x0[i] + extension(&z, BETWEEN);
            slopes[i] = slope(&z, BETWEEN);
        }
        work.derivatives(span.t0 + BETWEEN * h, one, f)?;
        for i in 0..x0.len() {
            self.off[i] = (h * f[i] - slopes[i]) / REAL;
        }
        self.jacobian.solve(&mut self.off);
        for i in 0..x0.len() {
            let has = slope(&[self.z[0][i], self.z[1][i], self.z[2][i]], 0.0);
            self.start[i] = h * self.f0[i] - has + self.off[i] * C[0] * C[1] / bump(BETWEEN);
        }
        self.jacobian.solve(&mut self.start);
        Ok(work.weights.norm(x0, x1, &self.off, h) / FAR)
    }

    /// The polynomial through the start and the stages that has the derivative of f at one place between as well, and leaves the
    /// start with the slope that f has there, as far as that is not the beginning of a decay that the step damps out.
    fn interpolate(&self, theta: f64, _h: f64, x0: &[f64], _x1: &[f64], x: &mut [f64]) {
        let more = bump(theta) / bump(BETWEEN);
        let bend = bump(theta) / (C[0] * C[1]) * (theta / BETWEEN - 1.0);
        for i in 0..x.len() {
            let z = [self.z[0][i], self.z[1][i], self.z[2][i]];
            x[i] = x0[i] + extension(&z, theta) + more * self.off[i] + bend * self.start[i];
        }
    }

    fn stages(&self) -> Option<Box<Stages>> {
        Some(Box::new(Stages {
            newton: Convergence {
                slopes: (self.slopes != Age::Unknown).then(|| self.jacobian.slopes()),
                ..Convergence::default()
            },
            quick: self.quick,
            tried: self.tried,
            columns: self.z.to_vec(),
        }))
    }

    fn recall(&mut self, stages: &Stages) {
        (self.slopes, self.factored) = (Age::Unknown, f64::NAN);
        if let Some(slopes) = &stages.newton.slopes {
            self.jacobian.recall(slopes);
            self.slopes = Age::Old;
        }
        (self.quick, self.before, self.tried) = (stages.quick, None, stages.tried);
        self.z.clone_from_slice(&stages.columns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trees::{Family, largest_defect};

    /// The matrix of the method.
    fn table() -> [[f64; 3]; 3] {
        let s = SQRT6;
        [
            [(88.0 - 7.0 * s) / 360.0, (296.0 - 169.0 * s) / 1800.0, (-2.0 + 3.0 * s) / 225.0],
            [(296.0 + 169.0 * s) / 1800.0, (88.0 + 7.0 * s) / 360.0, (-2.0 - 3.0 * s) / 225.0],
            [(16.0 - s) / 36.0, (16.0 + s) / 36.0, 1.0 / 9.0],
        ]
    }

    fn times(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    }

    #[test]
    fn the_table_meets_the_conditions_of_order_five() {
        let a = table().map(|row| row.to_vec());
        let defect = |order| largest_defect(Family::RungeKutta, &a, &[], &table()[2], 1.0, order);
        assert!(defect(5) < 1e-14, "{:e}", defect(5));
        assert!(defect(6) > 1e-4);
    }

    #[test]
    fn the_place_between_fits_the_matrix() {
        // The slope of the polynomial over itself there, by its zeros.
        let found = C.into_iter().fold(1.0 / BETWEEN, |sum, c| sum + 1.0 / (BETWEEN - c));
        assert!((found / REAL - 1.0).abs() < 1e-13, "{found}");
        const { assert!(C[0] < BETWEEN && BETWEEN < C[1]) };
    }

    #[test]
    fn the_coordinates_take_the_equations_apart() {
        // T [gamma 0 0; 0 a b; 0 -b a] I is the inverse of the matrix.
        let (a, b) = PAIR;
        let parts = [[REAL, 0.0, 0.0], [0.0, a, b], [0.0, -b, a]];
        let one = times(&times(&times(&T, &parts), &I), &table());
        for (i, row) in one.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert!((entry - f64::from(i == j)).abs() < 1e-13, "{one:?}");
            }
        }
    }

    #[test]
    fn the_extension_passes_through_the_stages() {
        for (k, c) in C.into_iter().enumerate() {
            let mut z = [0.0; 3];
            z[k] = 1.0;
            for (j, other) in C.into_iter().enumerate() {
                assert!((extension(&z, other) - f64::from(j == k)).abs() < 1e-13, "{c} {other}");
            }
        }
    }
}
