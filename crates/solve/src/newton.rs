//! Simplified Newton iteration for the one implicit equation of a step or stage, with a Jacobian and factors that serve on
//! over many steps.
//!
//! What is sought is a state x = predicted + d with g f(t, x) = known + d. The Jacobian is kept until the iteration is slow,
//! its factors until g changes, and the rate of convergence that was seen with them tells after a single correction
//! whether another is needed. That rate is one of the norm; from the second correction on each state is looked at as well. A Jacobian
//! that is far too large makes corrections small whether or not they are right, so after an event it is a new one, and where much is
//! left of an equation its small correction has to be followed by a smaller one.
//!
//! E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, section IV.8.

use crate::adaptive::{Fault, Work};
use crate::jacobian::{Age, Jacobian, Slopes};
use crate::shake::shake;

/// What is left of the equation of a state, in units of its tolerance, from which on a small correction of it is looked at again. Less
/// is no more than what other errors of a step come to, and would be looked at in nearly every step.
const HIDDEN: f64 = 3.0;
/// Iterations of one equation, at most.
const ITERATIONS: usize = 4;
/// Error of the iteration, as a part of what the step may err by.
const CONVERGED: f64 = 0.03;
/// Factor of a correction from one iteration to the next above which the iteration is too slow.
const SLOW: f64 = 0.9;

/// Correction of one state, in units of its tolerance, that must not stay as it is.
pub(crate) const STANDING: f64 = 1e-3;

/// Times that the last bits of the states are changed, to see what that does to a correction.
pub(crate) const SHAKEN: usize = 2;
/// Multiple of what it does above which a correction is more than rounding.
pub(crate) const ROUNDING: f64 = 4.0;
/// Multiple of what one such change does above which no other one is tried.
pub(crate) const MORE: f64 = 64.0;

/// Iteration, Jacobian and factors of one method.
pub(crate) struct Newton {
    pub jacobian: Jacobian,
    /// Whether there is a Jacobian, and whether it belongs to the start of this step.
    pub slopes: Age,
    /// The g of the factors of I - g J; not a number if there are none.
    factored: f64,
    /// Convergence rate of the iteration with these factors, if known.
    rate: Option<f64>,
    /// The derivative that was evaluated last.
    pub f: Vec<f64>,
    /// What the iteration adds to the predicted state, and its last correction.
    pub step: Vec<f64>,
    pub correction: Vec<f64>,
    /// The correction before.
    before: Vec<f64>,
    /// What was left of the equation before the last correction.
    left: Vec<f64>,
    /// A state with other last bits, and what that changes in a correction.
    shaken: Vec<f64>,
    noise: Vec<f64>,
}

/// The equation g f(t, predicted + d) = known + d.
pub(crate) struct Equation<'a> {
    pub t: f64,
    pub g: f64,
    pub predicted: &'a [f64],
    pub known: &'a [f64],
    /// State at the start of the step, and its size, by which errors are weighed.
    pub x0: &'a [f64],
    pub h: f64,
}

/// A correction of one state: what was left of its equation, the correction that this has led to, and the one before.
pub(crate) struct Change {
    pub left: f64,
    pub now: f64,
    pub before: f64,
}

impl Change {
    /// Whether state `i` may be far from what it should be, in a step of the size `h`: with a Jacobian that is too large, of before or of the
    /// start of the step, a correction is too small by as much. What was left of the equation tells how much that may be. Where the
    /// correction before is one of the same Jacobian too (`seen`), one that has become smaller speaks for it.
    pub fn hides(&self, work: &Work, magnitude: f64, (i, h): (usize, f64), seen: bool) -> bool {
        let least = 100.0 * f64::EPSILON / work.weights.relative().max(f64::EPSILON);
        let unit = work.weights.scale(i, magnitude, h);
        self.left > HIDDEN * unit && self.now > least * unit && !(seen && self.now <= SLOW * self.before)
    }
}

/// How an iteration ended.
pub(crate) enum Iteration {
    Converged,
    Slow,
    Failed(Fault),
}

/// What an iteration carries from one step to the next.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Convergence {
    pub slopes: Option<Slopes>,
    pub factored: Option<f64>,
    pub rate: Option<f64>,
}

impl Newton {
    pub fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            jacobian: Jacobian::new(n),
            slopes: Age::Unknown,
            factored: f64::NAN,
            rate: None,
            f: zeros(),
            step: zeros(),
            correction: zeros(),
            before: zeros(),
            left: zeros(),
            shaken: zeros(),
            noise: zeros(),
        }
    }

    /// Has the rate found anew, which takes two iterations.
    pub fn doubt(&mut self) {
        self.rate = None;
    }

    /// Whether a state is corrected by as much as the time before. Where a Jacobian of before is far larger than that of now,
    /// corrections of a state are too small by as much and hidden by those of the others.
    fn stands(&self, work: &Work, x0: &[f64], x1: &[f64], h: f64) -> bool {
        let least = STANDING.max(100.0 * f64::EPSILON / work.weights.relative().max(f64::EPSILON));
        self.before.iter().zip(&self.correction).enumerate().any(|(i, (before, now))| {
            let unit = work.weights.scale(i, x0[i].abs().max(x1[i].abs()), h);
            now.abs() > least * unit && now.abs() > SLOW * before.abs()
        })
    }

    /// Something else may be at work from here: a valve that conducts makes a Jacobian of before larger by many orders than that of now, and
    /// such a one hides nearly all that a correction should be.
    pub fn distrust(&mut self) {
        self.slopes = Age::Unknown;
    }

    /// Whether a state may be far from what it should be, although its last correction is small.
    fn hides(&self, work: &Work, x0: &[f64], x1: &[f64], h: f64, seen: bool) -> bool {
        let changes = self.left.iter().zip(&self.correction).zip(&self.before).enumerate();
        changes.into_iter().any(|(i, ((left, now), before))| {
            let change = Change { left: left.abs(), now: now.abs(), before: before.abs() };
            change.hides(work, x0[i].abs().max(x1[i].abs()), (i, h), seen)
        })
    }

    /// A new step begins: the Jacobian is one of before.
    pub fn begin(&mut self) {
        if self.slopes == Age::Current {
            self.slopes = Age::Old;
        }
    }

    /// Forgets the Jacobian and all that follows from it.
    pub fn forget(&mut self) {
        self.jacobian.forget();
        (self.slopes, self.factored, self.rate) = (Age::Unknown, f64::NAN, None);
    }

    /// Evaluates the Jacobian at (`t`, `x`), where a step of the size `h` begins.
    pub fn differentiate(&mut self, work: &mut Work, t: f64, x: &[f64], h: f64) -> Result<(), Fault> {
        work.derivatives(t, x, &mut self.f)?;
        self.jacobian.evaluate(work, t, x, &self.f, h)?;
        (self.slopes, self.factored) = (Age::Current, f64::NAN);
        Ok(())
    }

    /// Factors I - g J unless that is done.
    pub fn factor(&mut self, work: &mut Work, g: f64) -> Result<(), Fault> {
        if self.factored != g {
            self.factored = f64::NAN;
            self.jacobian.factor(work, g)?;
            (self.factored, self.rate) = (g, None);
        }
        Ok(())
    }

    /// Finds `x1` = predicted + `step`. Where that fails again and again with the Jacobian of now it is as near as it gets if all that is
    /// left is rounding.
    pub fn iterate(&mut self, work: &mut Work, equation: &Equation, x1: &mut [f64]) -> Iteration {
        let iteration = self.search(work, equation, x1);
        if matches!(iteration, Iteration::Slow)
            && self.slopes == Age::Current
            && work.weights.may_be_rounding()
            && self.is_rounding(work, equation, x1)
        {
            return Iteration::Converged;
        }
        iteration
    }

    /// Whether changes of the last bits of `x1` make as much difference to its next correction as there is left of it.
    fn is_rounding(&mut self, work: &mut Work, equation: &Equation, x1: &[f64]) -> bool {
        let &Equation { t, g, known, x0, h, .. } = equation;
        let Self { jacobian, f, step, correction, before, shaken, noise, .. } = self;
        noise.fill(0.0);
        for number in 0..=SHAKEN {
            shake(x1, number, shaken);
            let at = if number == 0 { x1 } else { &shaken[..] };
            if work.derivatives(t, at, f).is_err() {
                return false;
            }
            for (i, correction) in correction.iter_mut().enumerate() {
                *correction = g * f[i] - known[i] - step[i];
            }
            jacobian.solve(correction);
            if number == 0 {
                before.copy_from_slice(correction);
                continue;
            }
            for ((noise, a), b) in noise.iter_mut().zip(&*correction).zip(&*before) {
                *noise = noise.max((a - b).abs());
            }
            let multiple = if number == SHAKEN { ROUNDING } else { MORE };
            // What is not a number is no rounding.
            let is_little = |i: usize| {
                let unit = work.weights.scale(i, x0[i].abs().max(x1[i].abs()), h);
                before[i].abs() <= (multiple * noise[i]).max(STANDING * unit)
            };
            if !(0..x1.len()).all(is_little) {
                return false;
            }
        }
        true
    }

    fn search(&mut self, work: &mut Work, equation: &Equation, x1: &mut [f64]) -> Iteration {
        let &Equation { t, g, predicted, known, x0, h } = equation;
        self.step.fill(0.0);
        x1.copy_from_slice(predicted);
        let mut before = f64::NAN;
        for iteration in 0..ITERATIONS {
            if let Err(fault) = work.derivatives(t, x1, &mut self.f) {
                return Iteration::Failed(fault);
            }
            for (i, correction) in self.correction.iter_mut().enumerate() {
                *correction = g * self.f[i] - known[i] - self.step[i];
            }
            self.left.copy_from_slice(&self.correction);
            self.jacobian.solve(&mut self.correction);
            for i in 0..self.step.len() {
                self.step[i] += self.correction[i];
                x1[i] = predicted[i] + self.step[i];
            }
            let size = work.weights.norm(x0, x1, &self.correction, h);
            // Rounding of the states themselves.
            let least = 100.0 * f64::EPSILON / work.weights.relative().max(f64::EPSILON);
            if size <= least.min(CONVERGED) {
                return Iteration::Converged;
            }
            if iteration > 0 {
                let rate = size / before;
                if rate > SLOW {
                    return Iteration::Slow;
                }
                self.rate = Some(self.rate.map_or(rate, |known| rate.max(SLOW * known)));
            }
            if let Some(rate) = self.rate {
                let left = size * rate / (1.0 - rate);
                // With the Jacobian of now what stands until the end is noise.
                let last = iteration + 1 == ITERATIONS && self.slopes == Age::Current;
                if left <= CONVERGED
                    && (iteration == 0 || last || !self.stands(work, x0, x1, h))
                    && !self.hides(work, x0, x1, h, iteration > 1)
                {
                    return Iteration::Converged;
                }
                let more = (ITERATIONS - 1 - iteration) as i32;
                if left * rate.powi(more) > CONVERGED {
                    return Iteration::Slow;
                }
            }
            before = size;
            self.before.copy_from_slice(&self.correction);
        }
        Iteration::Slow
    }

    /// What another needs to go on from here.
    pub fn memory(&self) -> Convergence {
        Convergence {
            slopes: (self.slopes != Age::Unknown).then(|| self.jacobian.slopes()),
            factored: Some(self.factored).filter(|g| g.is_finite()),
            rate: self.rate,
        }
    }

    /// Takes over what another knows.
    pub fn recall(&mut self, memory: &Convergence) {
        (self.slopes, self.factored, self.rate) = (Age::Unknown, f64::NAN, memory.rate);
        if let Some(slopes) = &memory.slopes {
            self.jacobian.recall(slopes);
            self.slopes = Age::Old;
            if let Some(g) = memory.factored.filter(|&g| self.jacobian.refactor(g)) {
                self.factored = g;
            }
        }
    }
}
