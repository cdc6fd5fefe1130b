//! What a signal is over its time: bounds, mean, root mean square.

use crate::smooth::refine;

/// Numbers of one signal, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistics {
    /// Least value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Mean over time.
    pub mean: f64,
    /// Root of the mean square over time.
    pub rms: f64,
    /// Last value.
    pub last: f64,
}

impl Statistics {
    /// Largest absolute value.
    pub fn peak(&self) -> f64 {
        self.min.abs().max(self.max.abs())
    }
}

/// Numbers of a signal that follows a cubic between its values where it is smooth and is straight elsewhere. What is not
/// finite is left out; `None` where nothing is left. Mean and root mean square of a single instant are those of its last value.
pub fn statistics(time: &[f64], values: &[f64]) -> Option<Statistics> {
    let rows = time.iter().copied().zip(values.iter().copied());
    let rows: Vec<(f64, [f64; 1])> =
        rows.filter(|(t, x)| t.is_finite() && x.is_finite()).map(|(t, x)| (t, [x])).collect();
    let rows: Vec<(f64, f64)> = refine(&rows).into_iter().map(|(t, [x])| (t, x)).collect();
    let (&(from, _), &(to, last)) = (rows.first()?, rows.last()?);
    let integral = |of: fn(f64, f64) -> f64| -> f64 {
        rows.windows(2).map(|ends| (ends[1].0 - ends[0].0) * of(ends[0].1, ends[1].1)).sum()
    };
    let (mean, square) = match to > from {
        true => (
            integral(|a, b| (a + b) / 2.0) / (to - from),
            integral(|a, b| (a * a + a * b + b * b) / 3.0) / (to - from),
        ),
        false => (last, last * last),
    };
    let bounds = |pick: fn(f64, f64) -> f64| rows.iter().map(|row| row.1).fold(last, pick);
    Some(Statistics { min: bounds(f64::min), max: bounds(f64::max), mean, rms: square.max(0.0).sqrt(), last })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_SQRT_2, TAU};

    #[test]
    fn a_sine_has_no_mean_and_the_root_mean_square_of_the_textbook() {
        let time: Vec<f64> = (0..=10_000).map(|n| f64::from(n) / 10_000.0).collect();
        let values: Vec<f64> = time.iter().map(|t| 3.0 * (TAU * t).sin()).collect();
        let found = statistics(&time, &values).unwrap();
        assert!(found.mean.abs() < 1e-12);
        // Straight lines lie below the arcs by (h w)^2 / 12 of their height at most.
        assert!((found.rms - 3.0 * FRAC_1_SQRT_2).abs() < 1e-7, "{}", found.rms);
        assert!((found.max - 3.0).abs() < 1e-12 && (found.peak() - 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_ramp_is_exact_and_steps_take_no_time() {
        let found = statistics(&[0.0, 2.0, 2.0, 4.0], &[0.0, 2.0, -6.0, -6.0]).unwrap();
        assert_eq!((found.min, found.max, found.peak(), found.last), (-6.0, 2.0, 6.0, -6.0));
        assert_eq!(found.mean, (2.0 - 12.0) / 4.0);
        assert!((found.rms - ((8.0 / 3.0 + 72.0) / 4.0_f64).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        assert_eq!(statistics(&[0.0, 1.0], &[f64::NAN, f64::INFINITY]), None);
        let found = statistics(&[0.0, 1.0, 2.0], &[f64::NAN, 5.0, f64::NAN]).unwrap();
        assert_eq!((found.mean, found.rms, found.last), (5.0, 5.0, 5.0));
    }
}
