//! The answer to a step over time.

use crate::system::held;
use crate::{Channel, Gain, LinearError, is_stable, modes, poles, static_gain};

/// Times in s and the output after a step of 1 at the input, from rest, at `count` instants evenly up to `end`, s. Exact at
/// these, by the exponential of the matrix. Of a sampled channel all samples up to `end`, at most `count`.
pub fn step_response(channel: &Channel, end: f64, count: usize) -> Vec<(f64, f64)> {
    let count = count.max(2);
    let (dt, phi, gamma, count) = match channel.period {
        None => {
            let dt = end / (count - 1) as f64;
            let b = nalgebra::DMatrix::from_column_slice(channel.order(), 1, channel.b.as_slice());
            let (phi, gamma) = held(&channel.a, &b, dt);
            (dt, phi, gamma.column(0).into_owned(), count)
        }
        Some(period) => {
            let samples = (end / period).floor().min(count as f64 - 1.0) as usize + 1;
            (period, channel.a.clone(), channel.b.clone(), samples)
        }
    };
    let mut x = nalgebra::DVector::zeros(channel.order());
    let mut points = Vec::with_capacity(count);
    for k in 0..count {
        points.push((k as f64 * dt, (&channel.c * &x)[0] + channel.d));
        x = &phi * &x + &gamma;
    }
    points
}

/// How a step response comes to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepInfo {
    /// From 10 to 90 % of the end, s.
    pub rise: f64,
    /// By how much it goes beyond the end, relative to it.
    pub overshoot: f64,
    /// From when on it stays within 2 % of the end, s.
    pub settling: f64,
}

/// How the step response of a [`minimal`](crate::minimal) and stable channel comes to its end, with a resolution of
/// 1/20000 of nine times its slowest time constant. `None` if it comes to none, or the end is zero.
///
/// # Errors
/// [`LinearError`] of the eigenvalues.
pub fn step_info(channel: &Channel) -> Result<Option<StepInfo>, LinearError> {
    let poles = poles(&channel.a)?;
    let Gain::Finite(end) = static_gain(channel, &poles) else { return Ok(None) };
    if end == 0.0 || poles.is_empty() || !is_stable(&poles, channel.period) {
        return Ok(None);
    }
    let slowest = modes(&poles, channel.period).iter().map(|mode| mode.time_constant).fold(0.0, f64::max);
    let points = step_response(channel, 9.0 * slowest, 20_001);
    let shares: Vec<(f64, f64)> = points.into_iter().map(|(t, y)| (t, y / end)).collect();
    let first = |share: f64| shares.iter().find(|(_, y)| *y >= share).map(|(t, _)| *t);
    let (Some(tenth), Some(nine)) = (first(0.1), first(0.9)) else { return Ok(None) };
    let highest = shares.iter().map(|(_, y)| *y).fold(1.0, f64::max);
    let last_outside = shares.iter().rposition(|(_, y)| (y - 1.0).abs() > 0.02);
    let settling = last_outside.map_or(0.0, |n| shares[(n + 1).min(shares.len() - 1)].0);
    Ok(Some(StepInfo { rise: nine - tenth, overshoot: highest - 1.0, settling }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::tests::{transfer, transformed};

    #[test]
    fn steps_of_lags_and_of_oscillations_are_those_of_the_formulas() {
        let lag = transfer(&[2.0], &[0.5, 1.0]);
        for (t, y) in step_response(&lag, 3.0, 31) {
            assert!((y - 2.0 * (1.0 - (-t / 0.5).exp())).abs() < 1e-13, "{y} at {t}");
        }
        let (w, z) = (8.0_f64, 0.25_f64);
        let fast = w * (1.0 - z * z).sqrt();
        let system = transfer(&[w * w], &[1.0, 2.0 * z * w, w * w]);
        for (t, y) in step_response(&transformed(&system, 10.0), 2.0, 201) {
            let exact = 1.0 - (-z * w * t).exp() * ((fast * t).cos() + z * w / fast * (fast * t).sin());
            assert!((y - exact).abs() < 1e-10, "{y} is not {exact} at {t}");
        }
    }

    #[test]
    fn overshoot_and_settling_are_those_of_the_formulas() {
        let (w, z) = (8.0_f64, 0.25_f64);
        let info = step_info(&transfer(&[3.0 * w * w], &[1.0, 2.0 * z * w, w * w])).unwrap().unwrap();
        let overshoot = (-std::f64::consts::PI * z / (1.0 - z * z).sqrt()).exp();
        assert!((info.overshoot - overshoot).abs() < 1e-6, "{info:?}");
        let lag = step_info(&transfer(&[-2.0], &[0.5, 1.0])).unwrap().unwrap();
        assert!((lag.rise - 0.5 * 9.0_f64.ln()).abs() < 1e-3 && lag.overshoot == 0.0);
        assert!((lag.settling - 0.5 * 50.0_f64.ln()).abs() < 1e-3);
        assert_eq!(step_info(&transfer(&[1.0], &[1.0, 0.0])), Ok(None));
        assert_eq!(step_info(&transfer(&[1.0], &[1.0, -1.0])), Ok(None));
    }

    #[test]
    fn a_sampled_channel_has_its_samples() {
        let sum = Channel { period: Some(0.5), ..transfer(&[1.0], &[1.0, -1.0]) };
        assert_eq!(step_response(&sum, 1.6, 100), [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (1.5, 3.0)]);
    }
}
