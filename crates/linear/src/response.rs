//! The answer to sines, and to what stays.

use nalgebra::linalg::Hessenberg;
use nalgebra::{Complex, DMatrix, DVector, RowDVector};

use crate::Channel;
use crate::poles::{INTEGRATES, balanced};

/// A channel prepared for answers at many frequencies: with A as a Hessenberg matrix each takes n^2 operations
/// (A. Laub, Efficient multivariable frequency response computations, IEEE Trans. Automatic Control 26 (1981) 407).
#[derive(Debug, Clone)]
pub struct Response {
    h: DMatrix<f64>,
    b: DVector<f64>,
    c: RowDVector<f64>,
    d: f64,
    period: Option<f64>,
}

/// What a constant input leads to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gain {
    /// The output over the input at rest.
    Finite(f64),
    /// The output never comes to rest: something integrates.
    Infinite,
}

impl Response {
    /// Transforms the channel once.
    pub fn new(channel: &Channel) -> Response {
        let (a, scale) = balanced(channel.a.clone());
        let b = channel.b.component_div(&scale);
        let c = channel.c.component_mul(&scale.transpose());
        let (d, period) = (channel.d, channel.period);
        if a.nrows() < 3 {
            return Response { h: a, b, c, d, period };
        }
        let (q, h) = Hessenberg::new(a).unpack();
        Response { h, b: q.transpose() * b, c: c * q, d, period }
    }

    /// Output over input at a frequency, rad/s. Infinite at a pole.
    pub fn at(&self, frequency: f64) -> Complex<f64> {
        match self.period {
            None => self.of(Complex::new(0.0, frequency)),
            Some(period) => self.of(Complex::from_polar(1.0, frequency * period)),
        }
    }

    /// `C (s I - A)^-1 B + D`.
    fn of(&self, s: Complex<f64>) -> Complex<f64> {
        let n = self.b.len();
        let mut m = self.h.map(|x| Complex::new(-x, 0.0));
        for i in 0..n {
            m[(i, i)] += s;
        }
        let mut x: Vec<Complex<f64>> = self.b.iter().map(|&b| Complex::new(b, 0.0)).collect();
        // Gauss with one entry below the diagonal, the larger of two rows first.
        for k in 0..n.saturating_sub(1) {
            if m[(k + 1, k)].norm_sqr() > m[(k, k)].norm_sqr() {
                m.swap_rows(k, k + 1);
                x.swap(k, k + 1);
            }
            if m[(k + 1, k)].norm_sqr() == 0.0 {
                continue;
            }
            let factor = m[(k + 1, k)] / m[(k, k)];
            for j in k + 1..n {
                let above = m[(k, j)];
                m[(k + 1, j)] -= factor * above;
            }
            let above = x[k];
            x[k + 1] -= factor * above;
        }
        let mut sum = Complex::new(self.d, 0.0);
        for k in (0..n).rev() {
            let mut rest = x[k];
            for j in k + 1..n {
                rest -= m[(k, j)] * x[j];
            }
            if m[(k, k)].norm_sqr() == 0.0 {
                if rest.norm_sqr() == 0.0 {
                    x[k] = rest;
                    continue;
                }
                return Complex::new(f64::INFINITY, 0.0);
            }
            x[k] = rest / m[(k, k)];
        }
        sum += x.iter().zip(self.c.iter()).map(|(x, &c)| x * c).sum::<Complex<f64>>();
        sum
    }
}

/// What a constant input leads to, of a [`minimal`](crate::minimal) channel with these poles.
pub fn static_gain(channel: &Channel, poles: &[Complex<f64>]) -> Gain {
    let rest = Complex::new(if channel.period.is_some() { 1.0 } else { 0.0 }, 0.0);
    // Integrators are at zero exactly; that of a sampled system is as near to 1 as slopes let it be.
    let near = if channel.period.is_some() { INTEGRATES } else { 0.0 };
    if poles.iter().any(|pole| (pole - rest).norm() <= near) {
        return Gain::Infinite;
    }
    let response = Response::new(channel);
    let gain = response.at(0.0).re;
    // Against what comes through elsewhere rounding is nothing; at a pole without damping that is no size of anything.
    let elsewhere =
        poles.iter().flat_map(|pole| [0.7, 1.3].map(|part| response.at(part * pole.norm()).norm()));
    let elsewhere = elsewhere.filter(|size| size.is_finite());
    match gain {
        gain if !gain.is_finite() => Gain::Infinite,
        gain if gain.abs() <= 1e-13 * elsewhere.fold(0.0, f64::max) => Gain::Finite(0.0),
        gain => Gain::Finite(gain),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::poles;
    use crate::system::tests::{transfer, transformed};

    /// The transfer function itself.
    fn polynomial(coefficients: &[f64], s: Complex<f64>) -> Complex<f64> {
        coefficients.iter().fold(Complex::new(0.0, 0.0), |sum, c| sum * s + c)
    }

    #[test]
    fn the_response_is_that_of_the_transfer_function_in_any_coordinates() {
        let (numerator, denominator) = ([3.0, -2.0, 5.0], [1.0, 7.0, 120.0, 90.0, 11.0]);
        let system = transfer(&numerator, &denominator);
        for channel in [system.clone(), transformed(&system, 1.0), transformed(&system, 100.0)] {
            let response = Response::new(&channel);
            for w in [0.0, 0.01, 1.0, 10.0, 11.0, 1e4] {
                let s = Complex::new(0.0, w);
                let exact = polynomial(&numerator, s) / polynomial(&denominator, s);
                assert!((response.at(w) - exact).norm() < 1e-9 * exact.norm(), "at {w}");
            }
        }
    }

    #[test]
    fn what_swings_without_damping_has_a_static_gain() {
        // 1 / (s^2 + 4), and with (s^2 + 9) behind it.
        for (denominator, gain) in
            [(vec![1.0, 0.0, 4.0], 0.25), (vec![1.0, 0.0, 13.0, 0.0, 36.0], 1.0 / 36.0)]
        {
            let system = transfer(&[1.0], &denominator);
            let found = static_gain(&system, &poles(&system.a).unwrap());
            assert!(matches!(found, Gain::Finite(found) if (found - gain).abs() < 1e-12), "{found:?}");
        }
    }

    #[test]
    fn constant_inputs_lead_to_the_gain_or_without_end() {
        let lag = transfer(&[6.0], &[1.0, 3.0]);
        assert_eq!(static_gain(&lag, &poles(&lag.a).unwrap()), Gain::Finite(2.0));
        let integrator = transfer(&[6.0], &[1.0, 3.0, 0.0]);
        assert_eq!(static_gain(&integrator, &poles(&integrator.a).unwrap()), Gain::Infinite);
        assert_eq!(Response::new(&integrator).at(0.0).re, f64::INFINITY);
        let gain = transfer(&[4.0], &[2.0]);
        assert_eq!(static_gain(&gain, &[]), Gain::Finite(2.0));
        // y[k+1] = 0.5 y[k] + u[k].
        let sampled = Channel { period: Some(0.1), ..transfer(&[1.0], &[1.0, -0.5]) };
        assert_eq!(static_gain(&sampled, &poles(&sampled.a).unwrap()), Gain::Finite(2.0));
    }
}
