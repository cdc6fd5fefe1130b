//! `Ode1` to `Ode5`: explicit Runge-Kutta methods with a fixed step.
//!
//! For runs that must take the same steps every time, such as on a real-time target, and for comparison with such runs.
//! There is no error estimate: halve the step and compare. References stand at the tableaus.
//!
//! Steps have the given size until less than two remain to the limit; those are two even steps or one. The state in
//! between comes from the stages alone, so it costs no evaluation; its order is that of the solution up to 2, then 2 for
//! `Ode3` and 3 for `Ode4` and `Ode5`.

use crate::tableau::{BOGACKI_SHAMPINE, CLASSIC, DORMAND_PRINCE, EULER, HEUN, Tableau};
use crate::{Counts, StepError, Stepper, System};

/// What remains to the limit may exceed the step by this factor, so that rounding of t makes no extra step.
const STRETCH: f64 = 1.0 + 1e-6;

/// A stepper of fixed step size.
pub struct FixedStep {
    tableau: &'static Tableau,
    h: f64,
    k: Vec<Vec<f64>>,
    x0: Vec<f64>,
    x1: Vec<f64>,
    /// Begin, end and size of the last step.
    last: (f64, f64, f64),
    /// Whether the stages of the last step are known, which the system may have made by itself.
    are_stages_known: bool,
    counts: Counts,
}

impl FixedStep {
    /// Euler's method, order 1, for `dimension` states with steps of `h` > 0 seconds.
    pub fn ode1(dimension: usize, h: f64) -> Self {
        Self::new(&EULER, dimension, h)
    }

    /// Heun's method, order 2.
    pub fn ode2(dimension: usize, h: f64) -> Self {
        Self::new(&HEUN, dimension, h)
    }

    /// Bogacki and Shampine's method, order 3.
    pub fn ode3(dimension: usize, h: f64) -> Self {
        Self::new(&BOGACKI_SHAMPINE, dimension, h)
    }

    /// The classic Runge-Kutta method, order 4.
    pub fn ode4(dimension: usize, h: f64) -> Self {
        Self::new(&CLASSIC, dimension, h)
    }

    /// Dormand and Prince's method, order 5.
    pub fn ode5(dimension: usize, h: f64) -> Self {
        Self::new(&DORMAND_PRINCE, dimension, h)
    }

    fn new(tableau: &'static Tableau, dimension: usize, h: f64) -> Self {
        Self {
            tableau,
            h,
            k: vec![vec![0.0; dimension]; tableau.b.len()],
            x0: vec![0.0; dimension],
            x1: vec![0.0; dimension],
            last: (0.0, 0.0, 0.0),
            are_stages_known: true,
            counts: Counts::default(),
        }
    }

    /// What the method says, for a system that makes steps by itself.
    pub fn weights(&self) -> Weights {
        Weights { nodes: self.tableau.c, stages: self.tableau.a, result: self.tableau.b }
    }

    /// End and size of the step from `t` towards `limit`.
    fn plan(&self, t: f64, limit: f64) -> (f64, f64) {
        let remaining = limit - t;
        if remaining <= self.h * STRETCH {
            (limit, remaining)
        } else if remaining < 2.0 * self.h {
            (t + 0.5 * remaining, 0.5 * remaining)
        } else {
            (t + self.h, self.h)
        }
    }
}

/// What an explicit method of Runge and Kutta adds up for a step of size h from x0 at t: the stages
/// `k[s] = f(t + nodes[s] h, x0 + (h stages[s][0]) k[0] + (h stages[s][1]) k[1] + ...)`, and with `result` the states at its end. Sums
/// are taken from the left, without weights 0 at the beginning of a row, and the time of a node 1 is the end of the step itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weights {
    /// When each stage is, as a part of the step.
    pub nodes: &'static [f64],
    /// Weights of the stages before each one.
    pub stages: &'static [&'static [f64]],
    /// Weights of all stages in the states at the end.
    pub result: &'static [f64],
}

impl Stepper for FixedStep {
    fn restart(&mut self) {
        // Nothing is carried from one step to the next.
    }

    fn step(
        &mut self,
        system: &mut dyn System,
        t: &mut f64,
        x: &mut [f64],
        limit: f64,
    ) -> Result<(), StepError> {
        if limit <= *t || limit.is_nan() {
            return Ok(());
        }
        let (t1, h) = self.plan(*t, limit);
        if t1 <= *t || t1.is_nan() {
            return Err(StepError::Underflow { t: *t, h, state: 0 });
        }
        self.are_stages_known = !system.step(*t, t1, h, x);
        if !self.are_stages_known {
            self.counts.evaluations += self.tableau.b.len() as u64;
            self.counts.accepted += 1;
            self.last = (*t, t1, h);
            *t = t1;
            return Ok(());
        }
        self.x0.copy_from_slice(x);
        for (stage, (&c, row)) in self.tableau.c.iter().zip(self.tableau.a).enumerate() {
            let (known, rest) = self.k.split_at_mut(stage);
            add_stages(&mut self.x1, &self.x0, h, row, known);
            let t = if c == 1.0 { t1 } else { *t + c * h };
            self.counts.evaluations += 1;
            let dx = &mut rest[0];
            system.derivatives(t, &self.x1, dx).map_err(|_| StepError::System)?;
            if let Some(state) = dx.iter().position(|v| !v.is_finite()) {
                return Err(StepError::NotFinite { t, state });
            }
        }
        add_stages(&mut self.x1, &self.x0, h, self.tableau.b, &self.k);
        self.counts.accepted += 1;
        self.last = (*t, t1, h);
        *t = t1;
        x.copy_from_slice(&self.x1);
        Ok(())
    }

    fn interpolate(&self, t: f64, x: &mut [f64]) {
        let (t0, t1, h) = self.last;
        if !self.are_stages_known {
            // The system has promised that nobody asks.
            x.fill(f64::NAN);
            return;
        }
        if t == t1 {
            x.copy_from_slice(&self.x1);
            return;
        }
        let theta = (t - t0) / h;
        x.copy_from_slice(&self.x0);
        for (d, k) in self.tableau.dense.iter().zip(&self.k) {
            let weight = h * theta * (d[0] + theta * (d[1] + theta * d[2]));
            for (x, k) in x.iter_mut().zip(k) {
                *x += weight * k;
            }
        }
    }

    fn single(&self) -> Option<f64> {
        Some(self.h * STRETCH)
    }

    fn made(&mut self, steps: u64, t: f64, t1: f64) {
        if steps > 0 {
            self.are_stages_known = false;
            self.counts.evaluations += steps * self.tableau.b.len() as u64;
            self.counts.accepted += steps;
            self.last = (t, t1, t1 - t);
        }
    }

    fn last_step(&self) -> (f64, f64) {
        (self.last.0, self.last.1)
    }

    fn counts(&self) -> Counts {
        self.counts
    }

    fn name(&self) -> &'static str {
        self.tableau.name
    }
}

/// x1 = x0 + (h a1) k1 + (h a2) k2 + ..., summed from the left: a row of [`Weights`] for a step of size `h`. All slices are as long as
/// there are states.
pub fn add_stages(x1: &mut [f64], x0: &[f64], h: f64, a: &[f64], k: &[Vec<f64>]) {
    let zeros = a.iter().take_while(|a| **a == 0.0).count();
    let (a, k) = (&a[zeros..], &k[zeros..]);
    // Four states go abreast. Most systems have few, and a loop over them for each stage would cost more than its sums.
    let (fours, rest) = x1.as_chunks_mut::<4>();
    let first = 4 * fours.len();
    for (i, (x1, x0)) in fours.iter_mut().zip(x0.as_chunks::<4>().0).enumerate() {
        let mut sums = *x0;
        for (a, k) in a.iter().zip(k) {
            let (weight, k) = (h * a, &k.as_chunks::<4>().0[i]);
            sums.iter_mut().zip(k).for_each(|(sum, k)| *sum += weight * k);
        }
        *x1 = sums;
    }
    for (i, x1) in rest.iter_mut().enumerate() {
        *x1 = a.iter().zip(k).fold(x0[first + i], |sum, (a, k)| sum + h * a * k[first + i]);
    }
}
