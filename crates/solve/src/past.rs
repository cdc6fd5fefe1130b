//! How long the steps of `Ode15s` could be, told by the last states of the method that is at work instead.
//!
//! The error of a formula of order k is a multiple of h^(k+1) times the derivative of that order, which the divided difference
//! of the last k + 2 states tells. That is what the formulas go by themselves: what an explicit method must follow for
//! stability alone is not in it. LSODA decides between its methods in the same way.
//!
//! L. Petzold: Automatic selection of methods for solving stiff and nonstiff systems of ordinary differential equations,
//! SIAM J. Sci. Stat. Comput. 4 (1983), doi 10.1137/0904010.

use crate::ode15s::{MAX, error_constant};
use crate::weights::Weights;

/// States that are kept: those of the formula of the highest order, and the one that it finds.
const POINTS: usize = MAX + 2;
/// What the formulas aim at, below the tolerance: steps of theirs are rejected too.
const SAFETY: f64 = 0.8;

/// The last states of a solution without jumps, each with its time. Takes no memory after it was made.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Past {
    times: [f64; POINTS],
    /// State after state, in a ring.
    states: Vec<f64>,
    dimension: usize,
    /// How many are known, and where in the ring the next one goes.
    known: usize,
    next: usize,
}

impl Past {
    /// Of a solution with as many states.
    pub fn new(dimension: usize) -> Self {
        Self { times: [0.0; POINTS], states: vec![0.0; POINTS * dimension], dimension, known: 0, next: 0 }
    }

    /// Forgets all of them.
    pub fn clear(&mut self) {
        self.known = 0;
    }

    /// Notes the state `x` at `t`, which is later than all before.
    pub fn push(&mut self, t: f64, x: &[f64]) {
        self.times[self.next] = t;
        self.states[self.next * self.dimension..][..self.dimension].copy_from_slice(x);
        self.known = (self.known + 1).min(POINTS);
        self.next = (self.next + 1) % POINTS;
    }

    /// The longest step of the formulas, s, whose error is within the tolerance; zero while too few states are known.
    pub fn longest_step(&self, weights: &Weights) -> f64 {
        if self.known < POINTS || self.dimension == 0 {
            return 0.0;
        }
        // Latest first.
        let place = |p: usize| (self.next + POINTS - 1 - p) % POINTS;
        let times: [f64; POINTS] = std::array::from_fn(|p| self.times[place(p)]);
        let mut squares = [0.0; POINTS];
        for i in 0..self.dimension {
            let mut differences: [f64; POINTS] =
                std::array::from_fn(|p| self.states[place(p) * self.dimension + i]);
            let unit = weights.unit(i, differences[0].abs());
            for k in 1..POINTS {
                for p in 0..POINTS - k {
                    differences[p] = (differences[p] - differences[p + 1]) / (times[p] - times[p + k]);
                }
                squares[k] += (differences[0] / unit).powi(2);
            }
        }
        let mut longest: f64 = 0.0;
        let mut factorial = 1.0;
        for order in 1..=MAX {
            factorial *= (order + 1) as f64;
            let derivative = factorial * (squares[order + 1] / self.dimension as f64).sqrt();
            let step = SAFETY * (error_constant(order) * derivative).powf(-1.0 / (order + 1) as f64);
            longest = longest.max(step);
        }
        longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Tolerances;

    /// The past of x = e^-t and y = 3, at steps that vary, up to t = 1.
    fn past() -> Past {
        let mut past = Past::new(2);
        for t in [0.3, 0.55, 0.6, 0.65, 0.7, 0.8, 0.85, 0.95, 1.0] {
            past.push(t, &[f64::exp(-t), 3.0]);
        }
        past
    }

    #[test]
    fn the_longest_step_is_that_of_the_best_order() {
        // Of e^-t every derivative is e^-t; in the root mean square of two states it counts as e^-t / sqrt 2.
        let best = |relative: f64| {
            let norm = |order: usize| error_constant(order) / (relative * 2f64.sqrt());
            (1..=MAX).map(|order| SAFETY * norm(order).powf(-1.0 / (order + 1) as f64)).fold(0.0, f64::max)
        };
        for relative in [1e-3, 1e-6, 1e-9] {
            let weights = Weights::new(Tolerances::uniform(2, relative, 0.0));
            let found = past().longest_step(&weights);
            // A divided difference is the derivative in the middle of its points, 0.2 s earlier.
            assert!((found / best(relative) - 1.0).abs() < 0.08, "{relative}: {found}, {}", best(relative));
        }
    }

    #[test]
    fn too_few_states_tell_nothing() {
        let weights = Weights::new(Tolerances::uniform(2, 1e-6, 0.0));
        let mut past = past();
        past.clear();
        for k in 0..POINTS - 1 {
            past.push(k as f64, &[1.0, 2.0]);
            assert_eq!(past.longest_step(&weights), 0.0);
        }
    }
}
