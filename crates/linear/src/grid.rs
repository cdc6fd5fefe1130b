//! Frequencies worth looking at.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::modes;

/// Points in a decade.
const DENSE: f64 = 60.0;
/// Decades beyond the slowest and the fastest pole or zero.
const BEYOND: f64 = 1.0;
/// Most decades.
const WIDE: f64 = 14.0;
/// Poles and zeros with less damping than this have points of their own around them.
const SHARP: f64 = 0.3;

/// Frequencies, rad/s, that show everything that these poles and zeros do, rising: over the decades around them, closer where
/// they are little damped, for a sampled system up to half of its rate. Those at zero count as nothing.
pub fn frequencies(poles: &[Complex<f64>], zeros: &[Complex<f64>], period: Option<f64>) -> Vec<f64> {
    let all = || modes(poles, period).into_iter().chain(modes(zeros, period));
    let sizes: Vec<f64> = all().map(|mode| mode.frequency).filter(|f| f.is_finite() && *f > 0.0).collect();
    let highest = sizes.iter().copied().fold(f64::NAN, f64::max);
    let top = period.map(|period| PI / period);
    let highest = if highest.is_nan() { top.unwrap_or(TAU) } else { highest };
    // What is far below the fastest is an integrator but for rounding.
    let lowest = sizes.iter().copied().filter(|f| *f > 1e-12 * highest).fold(highest, f64::min);
    let to = top.map_or(highest.log10() + BEYOND, f64::log10);
    let from = (lowest.log10() - BEYOND).max(to - WIDE).min(to - BEYOND);
    let count = ((to - from) * DENSE).ceil() as usize;
    let mut grid: Vec<f64> =
        (0..count).map(|k| 10_f64.powf(from + (to - from) * k as f64 / count as f64)).collect();
    for mode in all().filter(|mode| mode.damping.abs() < SHARP) {
        let half = mode.damping.abs().max(1e-6);
        // At the peak and where the phase turns, out to where the even points are dense enough.
        for k in 0..40 {
            let away = half * 1.25_f64.powi(k - 10);
            if away < 0.2 {
                grid.extend([mode.frequency * (1.0 - away), mode.frequency * (1.0 + away)]);
            }
        }
        grid.push(mode.frequency);
    }
    let (low, high) = (10_f64.powf(from), top.unwrap_or(10_f64.powf(to)));
    grid.retain(|f| *f >= low && *f < high * (1.0 - 1e-9));
    grid.push(high);
    grid.sort_by(f64::total_cmp);
    grid.dedup();
    grid
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_surround_poles_and_lie_close_at_sharp_ones() {
        let poles = [Complex::new(-1.0, 0.0), Complex::new(-0.05, 50.0), Complex::new(0.0, 0.0)];
        let grid = frequencies(&poles, &[], None);
        assert!((grid[0] / 0.1 - 1.0).abs() < 1e-9 && (grid[grid.len() - 1] / 500.0 - 1.0).abs() < 0.01);
        assert!(grid.windows(2).all(|pair| pair[0] < pair[1] && pair[1] / pair[0] < 1.05));
        let near = grid.iter().filter(|f| (**f - 50.0).abs() < 0.05).count();
        assert!(near >= 10, "{near} points within the width of the peak");
    }

    #[test]
    fn sampled_systems_end_at_half_of_their_rate() {
        let grid = frequencies(&[Complex::new(0.9, 0.0)], &[], Some(0.01));
        assert_eq!(grid.last(), Some(&(PI / 0.01)));
        assert!(!frequencies(&[], &[], None).is_empty() && !frequencies(&[], &[], Some(1.0)).is_empty());
    }
}
