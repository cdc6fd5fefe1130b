//! Derivatives of what was measured: a low pass without delay, and central differences.

use std::f64::consts::{PI, SQRT_2};

/// Passes of the filter: there and back.
const PASSES: f64 = 2.0;

/// Values at equally distant instants behind a low pass of second order (Butterworth) that runs forwards and backwards: of
/// order four in all, without delay, with -3 dB at `cutoff` (Hz). The ends are continued point-symmetrically.
///
/// `step` is the time between two values, s; the cutoff must be below 0.4 / `step`.
///
/// Source: F. Gustafsson, *Determining the Initial States in Forward-Backward Filtering*, IEEE Transactions on Signal
/// Processing 44 (1996), for the idea; the start is taken from rest at the first value of the continuation.
pub fn low_pass(values: &[f64], step: f64, cutoff: f64) -> Vec<f64> {
    let n = values.len();
    if n < 3 {
        return values.to_vec();
    }
    // Each pass has its -3 dB further out.
    let single = cutoff / (2f64.powf(1.0 / PASSES) - 1.0).powf(0.25);
    // The start from rest has died away by e^-27 where the values begin.
    let ahead = ((5.0 / (cutoff * step)).ceil() as usize).clamp(1, n - 1);
    let mirrored = |end: f64, at: f64| 2.0 * end - at;
    let before = (1..=ahead).rev().map(|k| mirrored(values[0], values[k]));
    let behind = (1..=ahead).map(|k| mirrored(values[n - 1], values[n - 1 - k]));
    let mut all: Vec<f64> = before.chain(values.iter().copied()).chain(behind).collect();
    for _ in 0..2 {
        pass(&mut all, step, single);
        all.reverse();
    }
    all[ahead..ahead + n].to_vec()
}

/// One pass of a Butterworth filter of second order, by the bilinear transform.
fn pass(values: &mut [f64], step: f64, cutoff: f64) {
    let k = (PI * (cutoff * step).min(0.49)).tan();
    let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let (b, a1, a2) = (k * k * scale, 2.0 * (k * k - 1.0) * scale, (1.0 - SQRT_2 * k + k * k) * scale);
    let rest = values.first().copied().unwrap_or(0.0);
    let (mut u1, mut u2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
    for value in values {
        let u = *value - rest;
        let y = b * (u + 2.0 * u1 + u2) - a1 * y1 - a2 * y2;
        (u2, u1, y2, y1) = (u1, u, y1, y);
        *value = y + rest;
    }
}

/// Derivative by central differences; at both ends the one beside.
pub fn derivative(values: &[f64], step: f64) -> Vec<f64> {
    let n = values.len();
    if n < 3 {
        return vec![0.0; n];
    }
    let inner = (1..n - 1).map(|k| (values[k + 1] - values[k - 1]) / (2.0 * step));
    let mut slopes: Vec<f64> = std::iter::once(0.0).chain(inner).chain([0.0]).collect();
    (slopes[0], slopes[n - 1]) = (slopes[1], slopes[n - 2]);
    slopes
}

/// Values at `count` instants from `from` on, `step` apart, by linear interpolation. Of two values at one time the later
/// counts, also where rounding puts an instant just before it.
pub fn on_grid(time: &[f64], values: &[f64], from: f64, step: f64, count: usize) -> Vec<f64> {
    let mut right = 0;
    (0..count)
        .map(|k| {
            let t = from + step * k as f64;
            while right < time.len() && time[right] <= t + 1e-6 * step {
                right += 1;
            }
            match (right.checked_sub(1), time.get(right)) {
                (Some(left), Some(end)) => {
                    let share = ((t - time[left]) / (end - time[left])).max(0.0);
                    values[left] + share * (values[right] - values[left])
                }
                (Some(left), None) => values[left],
                (None, _) => values.first().copied().unwrap_or(f64::NAN),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(frequency: f64, step: f64, count: usize) -> Vec<f64> {
        (0..count).map(|k| (2.0 * PI * frequency * step * k as f64).sin()).collect()
    }

    /// Amplitude in the middle third.
    fn amplitude(values: &[f64]) -> f64 {
        let n = values.len();
        values[n / 3..2 * n / 3].iter().fold(0.0, |m, x| m.max(x.abs()))
    }

    #[test]
    fn the_filter_halves_the_power_at_its_cutoff_and_delays_nothing() {
        let (step, n) = (1e-3, 6000);
        for (frequency, gain) in [(1.0, 1.0), (20.0, 0.5f64.sqrt()), (200.0, 0.0)] {
            let found = amplitude(&low_pass(&sine(frequency, step, n), step, 20.0));
            assert!((found - gain).abs() < 3e-3, "{frequency} Hz: {found}");
        }
        let slow = sine(1.0, step, n);
        let filtered = low_pass(&slow, step, 20.0);
        let worst = slow.iter().zip(&filtered).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-3, "{worst}");
    }

    #[test]
    fn a_ramp_stays_a_ramp_and_has_its_slope() {
        let ramp: Vec<f64> = (0..500).map(|k| 3.0 + 2.0 * 0.01 * f64::from(k)).collect();
        let filtered = low_pass(&ramp, 0.01, 5.0);
        assert!(ramp.iter().zip(&filtered).all(|(a, b)| (a - b).abs() < 1e-9));
        assert!(derivative(&filtered, 0.01).iter().all(|slope| (slope - 2.0).abs() < 1e-6));
    }

    #[test]
    fn what_lies_between_is_interpolated_and_of_two_values_the_later_counts() {
        let (time, values) = ([0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 5.0, 7.0]);
        assert_eq!(on_grid(&time, &values, 0.0, 0.5, 5), [0.0, 0.5, 5.0, 6.0, 7.0]);
    }
}
