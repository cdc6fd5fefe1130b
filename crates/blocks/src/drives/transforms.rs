//! Transforms of three phases into two axes and back, as functions: amplitudes stay what they are.
//!
//! Sources: E. Clarke, *Circuit Analysis of A-C Power Systems*, 1943; R. H. Park, *Two-Reaction Theory of Synchronous
//! Machines*, 1929, with the amplitudes kept and the q axis 90 degrees ahead of the d axis.

use std::ops::{Add, Div, Mul, Sub};

/// Half of the square root of three.
const SIN_120: f64 = 0.866_025_403_784_438_6;

/// What transforms calculate with: numbers, and the numbers of a law.
pub(super) trait Axis:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Self, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
}

impl<T> Axis for T where
    T: Copy
        + Add<Output = T>
        + Sub<Output = T>
        + Mul<T, Output = T>
        + Mul<f64, Output = T>
        + Div<f64, Output = T>
{
}

/// From phases a, b, c to the axes alpha and beta and the zero component.
pub(super) fn clarke<N: Axis>([a, b, c]: [N; 3]) -> ([N; 2], N) {
    let zero = (a + b + c) / 3.0;
    ([(a * 2.0 - b - c) / 3.0, (b - c) / (2.0 * SIN_120)], zero)
}

/// From the axes alpha and beta and the zero component to the phases a, b, c.
pub(super) fn inverse_clarke<N: Axis>([alpha, beta]: [N; 2], zero: N) -> [N; 3] {
    let (even, odd) = (zero - alpha * 0.5, beta * SIN_120);
    [zero + alpha, even + odd, even - odd]
}

/// From axes at rest to axes that are turned by the angle of this sine and cosine. The inverse is the same with the opposite sine.
pub(super) fn park<N: Axis>([alpha, beta]: [N; 2], (sin, cos): (N, N)) -> [N; 2] {
    [cos * alpha + sin * beta, cos * beta - sin * alpha]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn a_balanced_system_keeps_its_amplitude_and_turns_once_a_period() {
        for k in 0..100 {
            let angle = TAU * f64::from(k) / 100.0;
            let phases = [0.0, 1.0, 2.0].map(|k| 325.0 * (angle - k * TAU / 3.0).cos());
            let ([alpha, beta], zero) = clarke(phases);
            assert!((alpha - 325.0 * angle.cos()).abs() < 1e-12 * 325.0, "{k}");
            assert!((beta - 325.0 * angle.sin()).abs() < 1e-12 * 325.0, "{k}");
            assert!(zero.abs() < 1e-12 * 325.0, "{k}");
            // Seen from a frame that turns along, 30 degrees behind, it stands still.
            let [d, q] = park([alpha, beta], (angle - TAU / 12.0).sin_cos());
            assert!((d - 325.0 * 0.75_f64.sqrt()).abs() < 1e-12 * 325.0 && (q - 162.5).abs() < 1e-12 * 325.0);
        }
    }

    #[test]
    fn there_and_back_is_where_one_was() {
        for phases in [[1.0, 2.0, 3.0], [-7.5, 0.0, 0.25], [4.0, 4.0, 4.0]] {
            let (axes, zero) = clarke(phases);
            let turned = park(axes, 0.7_f64.sin_cos());
            let back = inverse_clarke(park(turned, (-0.7_f64).sin_cos()), zero);
            assert!(back.iter().zip(phases).all(|(x, y)| (x - y).abs() < 1e-14), "{back:?}");
        }
    }

    #[test]
    fn power_is_three_halves_of_the_product_of_the_vectors_and_three_times_that_of_the_zeros() {
        let (v, i) = ([10.0, -20.0, 40.0], [1.0, 3.0, -2.0]);
        let ((v2, v0), (i2, i0)) = (clarke(v), clarke(i));
        let phases: f64 = v.iter().zip(i).map(|(v, i)| v * i).sum();
        let axes = 1.5 * (v2[0] * i2[0] + v2[1] * i2[1]) + 3.0 * v0 * i0;
        assert!((phases - axes).abs() < 1e-12, "{phases} != {axes}");
    }
}
