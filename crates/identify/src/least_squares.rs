//! Linear and nonlinear least squares with the accuracy of what they find.

use nalgebra::{DMatrix, DVector};

use crate::error::IdentifyError;
use crate::student::interval_95;

/// Largest condition number of the scaled regression at which estimates still have digits.
const WORST_CONDITION: f64 = 1e12;

/// A number with its accuracy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Standard error.
    pub error: f64,
    /// Half width of the interval that holds the true value with probability 0.95, if the residuals are independent.
    pub interval: f64,
}

impl Estimate {
    /// Whether a value lies in the interval.
    pub fn holds(&self, value: f64) -> bool {
        (value - self.value).abs() <= self.interval
    }

    /// The estimate of `factor` times this.
    pub fn times(&self, factor: f64) -> Estimate {
        Estimate {
            value: factor * self.value,
            error: factor.abs() * self.error,
            interval: factor.abs() * self.interval,
        }
    }
}

/// What a fit found.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The unknowns.
    pub estimates: Vec<Estimate>,
    /// Standard deviation of the residuals, in the unit of the values.
    pub residual: f64,
    /// Condition number of the regression with columns scaled to length one.
    pub condition: f64,
    /// Values less unknowns.
    pub freedom: usize,
}

/// Solves `a x = b` for the least sum of squares of `w (a x - b)`; all weights are one where `weights` is empty.
///
/// Source: G. H. Golub, C. F. Van Loan, *Matrix Computations* (2013), chapter 5; the standard errors are the square roots
/// of the diagonal of `s² (aᵀ w² a)⁻¹`.
///
/// # Errors
/// [`IdentifyError::TooFew`], [`IdentifyError::NotFinite`], [`IdentifyError::Lengths`] or [`IdentifyError::Dependent`].
pub fn least_squares(a: &DMatrix<f64>, b: &[f64], weights: &[f64]) -> Result<Fit, IdentifyError> {
    let (rows, unknowns) = a.shape();
    if b.len() != rows {
        return Err(IdentifyError::Lengths { what: "the right side", found: b.len(), expected: rows });
    }
    if !weights.is_empty() && weights.len() != rows {
        return Err(IdentifyError::Lengths { what: "the weights", found: weights.len(), expected: rows });
    }
    if rows < unknowns || unknowns == 0 {
        return Err(IdentifyError::TooFew { values: rows, unknowns });
    }
    finite("value", b)?;
    finite("weight", weights)?;
    if let Some(index) = a.iter().position(|x| !x.is_finite()) {
        return Err(IdentifyError::NotFinite { what: "row", index: index % rows });
    }
    let weight = |row: usize| weights.get(row).copied().unwrap_or(1.0);
    let mut scaled = DMatrix::from_fn(rows, unknowns, |i, j| weight(i) * a[(i, j)]);
    let b = DVector::from_fn(rows, |i, _| weight(i) * b[i]);
    let lengths: Vec<f64> = scaled.column_iter().map(|column| column.norm()).collect();
    if lengths.contains(&0.0) {
        return Err(IdentifyError::Dependent { condition: f64::INFINITY });
    }
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
        column /= *length;
    }
    // The triangle of the QR factorisation has the singular values of the whole.
    let qr = scaled.clone().qr();
    let triangle = qr.r();
    let singular = triangle.clone().svd(false, false).singular_values;
    let condition = singular.max() / singular.min();
    // Written so that no number at all is refused, too.
    let is_sound = condition < WORST_CONDITION;
    if !is_sound {
        return Err(IdentifyError::Dependent { condition });
    }
    let right = qr.q().tr_mul(&b);
    let dependent = || IdentifyError::Dependent { condition };
    let x = triangle.solve_upper_triangular(&right).ok_or_else(dependent)?;
    let one = DMatrix::identity(unknowns, unknowns);
    let inverse = triangle.solve_upper_triangular(&one).ok_or_else(dependent)?;
    let squares = (&scaled * &x - &b).norm_squared();
    let freedom = rows - unknowns;
    let residual = if freedom == 0 { f64::NAN } else { (squares / freedom as f64).sqrt() };
    let estimates = (0..unknowns)
        .map(|j| estimate(x[j], residual * inverse.row(j).norm(), freedom).times(1.0 / lengths[j]))
        .collect();
    Ok(Fit { estimates, residual, condition, freedom })
}

fn estimate(value: f64, error: f64, freedom: usize) -> Estimate {
    // Without a value too many nothing tells the accuracy.
    let error = if freedom == 0 { f64::INFINITY } else { error };
    let interval = if error == 0.0 { 0.0 } else { interval_95(freedom) * error };
    Estimate { value, error, interval }
}

pub(crate) fn finite(what: &'static str, values: &[f64]) -> Result<(), IdentifyError> {
    match values.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(IdentifyError::NotFinite { what, index }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn line(points: usize) -> DMatrix<f64> {
        DMatrix::from_fn(points, 2, |i, j| if j == 0 { 1.0 } else { i as f64 })
    }

    #[test]
    fn a_straight_line_has_the_closed_form_of_regression() {
        // y = 1, 2, 2, 4 over 0..3: slope 0.9, intercept 0.9, sum of squares 0.7
        let fit = least_squares(&line(4), &[1.0, 2.0, 2.0, 4.0], &[]).unwrap();
        let s = (0.7_f64 / 2.0).sqrt();
        for (found, value, error) in [
            (fit.estimates[0], 0.9, s * (14.0_f64 / 20.0).sqrt()),
            (fit.estimates[1], 0.9, s / 5.0_f64.sqrt()),
        ] {
            assert!((found.value - value).abs() < 1e-14 && (found.error - error).abs() < 1e-14, "{found:?}");
            assert!((found.interval / found.error - 4.302_65).abs() < 1e-4);
        }
        assert!((fit.residual - s).abs() < 1e-14);
    }

    #[test]
    fn a_weight_of_two_counts_like_four_equal_values() {
        let b = [1.0, 2.5, 2.0, 4.0];
        let weighted = least_squares(&line(4), &b, &[1.0, 2.0, 1.0, 1.0]).unwrap();
        let rows = [0, 1, 1, 1, 1, 2, 3];
        let a = DMatrix::from_fn(7, 2, |i, j| line(4)[(rows[i], j)]);
        let repeated = least_squares(&a, &rows.map(|row| b[row]), &[]).unwrap();
        for (a, b) in weighted.estimates.iter().zip(&repeated.estimates) {
            assert!((a.value - b.value).abs() < 1e-14);
        }
    }

    #[test]
    fn the_interval_holds_the_truth_in_nineteen_of_twenty_cases() {
        let mut random = Random::new(5);
        let mut held = 0;
        for _ in 0..2000 {
            let b: Vec<f64> = (0..12).map(|i| 3.0 - 0.5 * f64::from(i) + 0.2 * random.normal()).collect();
            let fit = least_squares(&line(12), &b, &[]).unwrap();
            held += u32::from(fit.estimates[1].holds(-0.5));
        }
        // 1900 with a standard deviation of 9.7.
        assert!((1860..=1940).contains(&held), "{held} of 2000");
    }

    #[test]
    fn data_that_tell_nothing_are_refused() {
        let a = line(4);
        let b = [1.0, 2.0, 2.0, 4.0];
        assert!(matches!(least_squares(&line(1), &b[..1], &[]), Err(IdentifyError::TooFew { .. })));
        assert!(matches!(least_squares(&a, &b[..3], &[]), Err(IdentifyError::Lengths { .. })));
        assert!(matches!(least_squares(&a, &b, &[1.0]), Err(IdentifyError::Lengths { .. })));
        assert!(matches!(
            least_squares(&a, &[1.0, f64::NAN, 0.0, 0.0], &[]),
            Err(IdentifyError::NotFinite { index: 1, .. })
        ));
        let same = DMatrix::from_fn(4, 2, |i, _| i as f64);
        assert!(matches!(least_squares(&same, &b, &[]), Err(IdentifyError::Dependent { .. })));
        let empty = DMatrix::zeros(4, 2);
        assert!(matches!(least_squares(&empty, &b, &[]), Err(IdentifyError::Dependent { .. })));
    }

    #[test]
    fn as_many_values_as_unknowns_give_values_without_accuracy() {
        let fit = least_squares(&line(2), &[1.0, 3.0], &[]).unwrap();
        assert!((fit.estimates[1].value - 2.0).abs() < 1e-14);
        assert_eq!(fit.estimates[1].interval, f64::INFINITY);
    }
}
