//! The choice of the step size: PI controller, and how steps meet a limit.
//!
//! E. Hairer, S. P. Nørsett, G. Wanner: Solving Ordinary Differential Equations I, 2nd ed., section II.4;
//! K. Gustafsson: Control-theoretic techniques for stepsize selection in explicit Runge-Kutta methods,
//! ACM TOMS 17 (1991), doi 10.1145/210232.210242.

use crate::StepLimits;
use crate::stepper::Experience;

/// Aims below the tolerance, so that few steps are rejected.
const SAFETY: f64 = 0.9;
/// The least factor from one trial to the next, also when the error is not finite.
const SHRINK: f64 = 0.2;
/// The largest factor from one step to the next.
const GROW: f64 = 10.0;
/// Growth that is not worth new factors, for methods that keep them.
const LITTLE: f64 = 1.2;
/// Errors far below the tolerance say little; the controller remembers none smaller. Logarithm of 1e-4.
const SMALLEST_REMEMBERED: f64 = -4.0 * std::f64::consts::LN_10;
/// A step is stretched by up to this factor to land on a limit instead of leaving a sliver.
const STRETCH: f64 = 1.01;
/// The same for a step at its maximum, where only rounding of the limits is forgiven.
const STRETCH_AT_MAXIMUM: f64 = 1.0 + 1e-9;

/// One attempt at a step from `t0` to `t1 = t0 + h`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trial {
    pub t0: f64,
    pub t1: f64,
    pub h: f64,
    /// Whether it is shorter than the controller wanted, to fit the limit.
    cut: bool,
}

/// Controller of the step size for an error estimate that behaves as h^k.
pub(crate) struct StepSize {
    limits: StepLimits,
    /// Proportional and integral exponents: h_new = h * SAFETY * err^-exponent * err_before^beta.
    exponent: f64,
    beta: f64,
    /// Exponent where nothing is known of the error before: h_new = h * SAFETY * err^-elementary.
    elementary: f64,
    /// Whether a step stays as it is rather than to grow by less than [`LITTLE`].
    keeps: bool,
    pub learnt: Experience,
}

impl StepSize {
    /// `k` is the power of h in the error estimate: its order plus one. `keeps` if a little growth is not worth a change.
    pub fn new(limits: StepLimits, k: f64, keeps: bool) -> Self {
        let beta = 0.2 / k;
        Self {
            limits,
            exponent: 1.0 / k - 0.75 * beta,
            beta,
            elementary: 1.0 / k,
            keeps,
            learnt: Experience { wanted: limits.first, ..Experience::default() },
        }
    }

    /// Whether the first step size is still to be estimated.
    pub fn is_unknown(&self) -> bool {
        self.learnt.wanted.is_none()
    }

    pub fn set(&mut self, h: f64) {
        self.learnt.wanted = Some(h);
    }

    /// Forgets the error of the past but not the size.
    pub fn restart(&mut self) {
        self.learnt.logarithm_before = None;
        self.learnt.rejected = false;
    }

    /// The next attempt from `t` towards `limit > t`.
    pub fn propose(&self, t: f64, limit: f64) -> Trial {
        let StepLimits { min, max, .. } = self.limits;
        let h = self.learnt.wanted.unwrap_or(max).max(smallest(t, min)).min(max);
        let remaining = limit - t;
        let stretch = if h < max { STRETCH } else { STRETCH_AT_MAXIMUM };
        if remaining <= h * stretch {
            Trial { t0: t, t1: limit, h: remaining, cut: remaining < h }
        } else if remaining < 2.0 * h {
            // Two even steps instead of a long one and a sliver.
            Trial { t0: t, t1: t + 0.5 * remaining, h: 0.5 * remaining, cut: true }
        } else {
            Trial { t0: t, t1: t + h, h, cut: false }
        }
    }

    /// Whether no shorter step than the trial is worth trying.
    pub fn is_smallest(&self, trial: Trial) -> bool {
        trial.h <= smallest(trial.t0, self.limits.min)
    }

    /// The trial was kept with the error `err <= 1`.
    pub fn accept(&mut self, trial: Trial, err: f64) {
        // The powers by their logarithms, of which that of the error before is known.
        let logarithm = err.ln();
        let power = match self.learnt.logarithm_before {
            Some(before) => self.beta * before - self.exponent * logarithm,
            None => -self.elementary * logarithm,
        };
        let factor = SAFETY * power.exp();
        let growth = factor.clamp(SHRINK, if self.learnt.rejected { 1.0 } else { GROW });
        let growth = if self.keeps && (1.0..LITTLE).contains(&growth) { 1.0 } else { growth };
        let next = trial.h * growth;
        if trial.cut && factor > growth && !self.learnt.rejected {
            // The error of a step cut short is too small to tell how long a full one may be.
            self.learnt.wanted = self.learnt.wanted.map(|h| h.max(next));
        } else {
            self.learnt.wanted = Some(next);
        }
        if !trial.cut {
            self.learnt.logarithm_before = Some(logarithm.max(SMALLEST_REMEMBERED));
        }
        self.learnt.rejected = false;
    }

    /// The trial was thrown away with the error `err > 1` or not finite. Returns whether there is room to try again.
    pub fn reject(&mut self, trial: Trial, err: f64) -> bool {
        let floor = smallest(trial.t0, self.limits.min);
        let factor = SAFETY * err.powf(-self.exponent);
        let factor = if err.is_finite() { factor.clamp(SHRINK, 1.0) } else { SHRINK };
        self.learnt.wanted = Some((trial.h * factor).max(floor));
        self.learnt.rejected = true;
        !self.is_smallest(trial)
    }
}

/// The smallest step worth trying at `t`: 16 units in the last place.
pub(crate) fn smallest(t: f64, min: f64) -> f64 {
    let unit = t.abs().next_up() - t.abs();
    min.max(16.0 * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn control(h: f64, max: f64) -> StepSize {
        StepSize::new(StepLimits { first: Some(h), max, ..StepLimits::default() }, 5.0, false)
    }

    #[test]
    fn a_step_lands_on_the_limit_with_its_bits() {
        let trial = control(0.1, f64::INFINITY).propose(0.2, 0.3);
        assert_eq!(trial.t1.to_bits(), 0.3f64.to_bits());
        assert_eq!(trial.h, 0.3 - 0.2);
    }

    #[test]
    fn a_little_more_than_a_step_is_halved_and_no_sliver_remains() {
        let mut control = control(0.1, f64::INFINITY);
        let first = control.propose(0.0, 0.15);
        assert_eq!(first.t1, 0.075);
        control.accept(first, 1e-9);
        let second = control.propose(first.t1, 0.15);
        assert_eq!(second.t1, 0.15);
    }

    #[test]
    fn a_step_cut_short_does_not_lose_the_size() {
        let mut control = control(0.1, f64::INFINITY);
        let sliver = control.propose(0.0, 1e-9);
        control.accept(sliver, 1e-30);
        assert_eq!(control.propose(1e-9, 1.0).h, 0.1);
    }

    #[test]
    fn a_step_cut_short_with_a_telling_error_sets_the_size() {
        let mut control = control(0.1, f64::INFINITY);
        let half = control.propose(0.0, 0.05);
        control.accept(half, 0.9);
        assert!(control.propose(0.05, 1.0).h < 0.05);
    }

    #[test]
    fn where_nothing_is_known_of_the_error_before_the_last_one_alone_decides() {
        let mut control = control(0.1, f64::INFINITY);
        control.accept(control.propose(0.0, 9.0), 0.05);
        control.restart();
        let trial = control.propose(0.0, 9.0);
        control.accept(trial, 0.05);
        let grown = control.propose(0.0, 9.0).h / trial.h;
        assert!((grown - SAFETY * 0.05_f64.powf(-1.0 / 5.0)).abs() < 1e-14, "{grown}");
    }

    #[test]
    fn the_maximum_holds_and_forgives_rounding_of_the_limit() {
        let control = control(1.0, 0.1);
        assert_eq!(control.propose(0.0, 1.0).h, 0.1);
        assert_eq!(control.propose(0.2, 0.3).t1, 0.3);
        let (t, limit) = (0.1 + 0.2, 0.4);
        assert_eq!(control.propose(t, limit).t1, limit);
        assert!(control.propose(0.0, 0.1005).h < 0.1);
    }

    #[test]
    fn a_rejection_without_a_finite_error_shrinks_by_five_and_ends_at_the_floor() {
        let mut control = control(1e-3, f64::INFINITY);
        let trial = control.propose(1.0, 2.0);
        assert!(control.reject(trial, f64::INFINITY));
        assert!((control.propose(1.0, 2.0).h - 2e-4).abs() < 1e-18);
        let mut tries = 0;
        while control.reject(control.propose(1.0, 2.0), f64::INFINITY) {
            tries += 1;
        }
        assert!(tries < 30);
        assert_eq!(control.propose(1.0, 2.0).h, 16.0 * f64::EPSILON);
    }
}
