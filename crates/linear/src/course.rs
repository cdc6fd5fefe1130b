//! The answer to a step over time.

use crate::Channel;
use crate::system::held;

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
    fn a_sampled_channel_has_its_samples() {
        let sum = Channel { period: Some(0.5), ..transfer(&[1.0], &[1.0, -1.0]) };
        assert_eq!(step_response(&sum, 1.6, 100), [(0.0, 0.0), (0.5, 1.0), (1.0, 2.0), (1.5, 3.0)]);
    }
}
