//! Invariant zeros of a channel.

use nalgebra::{Complex, DMatrix, DVector, RowDVector};

use crate::poles::poles;
use crate::{Channel, LinearError};

/// Entries below this part of the norm of what they stem from are taken for zero.
const SMALL: f64 = 1e-11;

/// The numbers `s` for which some input `exp(s t)` with fitting states leaves the output at zero: the zeros of the
/// transfer function, if the channel is [`minimal`](crate::minimal). `None` if the output stays zero for every input.
///
/// As long as nothing passes at once, the output `c x = 0` binds one state to zero, and its derivative, which must be zero as
/// well, is the output of a system with a state less. When something passes, the zeros are the poles of the inverse
/// (A. Emami-Naeini and P. Van Dooren, Computation of zeros of linear multivariable systems, Automatica 18 (1982) 415, for
/// one input and output).
///
/// # Errors
/// [`LinearError`] of the eigenvalues.
pub fn zeros(channel: &Channel) -> Result<Option<Vec<Complex<f64>>>, LinearError> {
    let Channel { mut a, mut b, mut c, mut d, .. } = channel.clone();
    loop {
        let n = a.nrows();
        let size = c.norm() * b.norm();
        if d.abs() > SMALL * size && d != 0.0 {
            return poles(&(&a - &b * &c / d)).map(Some);
        }
        if n == 0 || c.norm() == 0.0 {
            return Ok(None);
        }
        // Householder's reflection that makes c a multiple of the last axis.
        let mut v: DVector<f64> = c.transpose();
        let length = v.norm();
        v[n - 1] += if v[n - 1] < 0.0 { -length } else { length };
        let reflection = DMatrix::identity(n, n) - &v * v.transpose() * (2.0 / v.norm_squared());
        let turned = &reflection * &a * &reflection;
        let pushed = &reflection * &b;
        // In units of the norm of A, so that a chain of integrators does not fade away.
        let unit = turned.norm().max(f64::MIN_POSITIVE);
        a = turned.view((0, 0), (n - 1, n - 1)).into_owned();
        c = RowDVector::from_fn(n - 1, |_, j| turned[(n - 1, j)]) / unit;
        d = pushed[n - 1] / unit;
        b = pushed.rows(0, n - 1).into_owned();
        if d.abs() <= SMALL * pushed.norm() / unit {
            d = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::tests::{transfer, transformed};

    fn near(channel: &Channel, expected: &[(f64, f64)]) {
        let found = zeros(channel).unwrap().expect("not zero for all inputs");
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (zero, (re, im)) in found.iter().zip(expected) {
            assert!((zero - Complex::new(*re, *im)).norm() < 1e-7 * re.hypot(*im).max(1.0), "{found:?}");
        }
    }

    #[test]
    fn zeros_of_transfer_functions_are_found_in_any_coordinates() {
        type Case<'a> = (&'a [f64], &'a [f64], &'a [(f64, f64)]);
        let cases: [Case; 5] = [
            // Non-minimum phase.
            (&[-1.0, 2.0], &[1.0, 3.0, 2.0], &[(2.0, 0.0)]),
            (&[1.0], &[1.0, 1.0, 1.0, 1.0], &[]),
            (&[1.0, 2.0, 26.0], &[1.0, 4.0, 6.0, 4.0], &[(-1.0, 5.0), (-1.0, -5.0)]),
            (&[2.0, 0.0, 8.0], &[1.0, 1.0, 7.0], &[(0.0, 2.0), (0.0, -2.0)]),
            (&[5.0, 0.0], &[1.0, 20003.0, 60000.0, 7.0], &[(0.0, 0.0)]),
        ];
        for (numerator, denominator, expected) in cases {
            let system = transfer(numerator, denominator);
            near(&system, expected);
            near(&transformed(&system, 1.0), expected);
            near(&transformed(&system, 10.0), expected);
        }
    }

    #[test]
    fn an_output_that_never_moves_has_no_zeros_to_tell() {
        let mut blind = transfer(&[1.0], &[1.0, 1.0, 1.0]);
        blind.c.fill(0.0);
        assert_eq!(zeros(&blind), Ok(None));
        assert_eq!(zeros(&transfer(&[3.0], &[1.0])), Ok(Some(Vec::new())));
    }
}
