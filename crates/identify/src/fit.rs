//! Unknowns of a model that is not linear in them, by least squares: of one that costs a run for each look at it, or of a formula.

use std::convert::Infallible;

use nalgebra::DMatrix;

use crate::error::IdentifyError;
use crate::least_squares::{Fit, finite, least_squares};

/// A model whose values may not exist everywhere.
pub trait Model {
    /// What stops a fit.
    type Error;

    /// The values for these unknowns; nothing where there are none, so that no better ones are looked for beyond.
    ///
    /// # Errors
    /// What stops the fit.
    fn values(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, Self::Error>;

    /// The derivatives of the values by the unknowns, a row for each value.
    ///
    /// # Errors
    /// What stops the fit.
    fn slopes(&mut self, x: &[f64]) -> Result<DMatrix<f64>, Self::Error>;
}

/// Why a fit was stopped.
#[derive(Debug, Clone, PartialEq)]
pub enum Stopped<E> {
    /// By the model.
    Model(E),
    /// By the numbers.
    Numbers(IdentifyError),
    /// There are no values for the unknowns at the start.
    NoStart,
}

/// What a fit of a model found.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The unknowns with their accuracy.
    pub fit: Fit,
    /// The values of the model for them.
    pub values: Vec<f64>,
    /// The values for the unknowns at the start.
    pub before: Vec<f64>,
    /// Steps to better unknowns.
    pub steps: usize,
    /// Whether the search ended where there are no values beyond, so that these unknowns need not be the best.
    pub at_edge: bool,
    /// Whether the slopes promise a better fit than was found, as where the model jumps.
    pub stalled: bool,
    /// Correlation of the estimates of two unknowns, for each pair.
    pub correlations: DMatrix<f64>,
}

/// Relative change of the unknowns at which a fit has settled, and the part of the sum of squares that is still to be had then.
const SETTLED: f64 = 1e-9;
const NOTHING_TO_GAIN: f64 = 1e-14;
/// The part of the sum of squares that slopes may promise at the end, and that of the squares of all values which is rounding.
const PROMISED: f64 = 1e-3;
const ROUNDING: f64 = 1e-12;
/// Damping behind which no better unknowns are looked for.
const MOST_DAMPING: f64 = 1e12;

/// The unknowns for which the sum of squares of `weights * (values - model)` is least, from a start, by the method of Levenberg and
/// Marquardt. A step to where the model has no values is taken back, as one to worse values.
///
/// Source: D. W. Marquardt, *An Algorithm for Least-Squares Estimation of Nonlinear Parameters*, SIAM Journal 11 (1963);
/// the damping is that of K. Madsen, H. B. Nielsen, O. Tingleff, *Methods for Non-Linear Least Squares Problems* (2004).
///
/// # Errors
/// See [`Stopped`]; [`IdentifyError::NotSettled`] after `most` steps, [`IdentifyError::Dependent`] where unknowns cannot be told apart.
pub fn fit<M: Model>(
    values: &[f64],
    weights: &[f64],
    start: &[f64],
    most: usize,
    model: &mut M,
) -> Result<Fitted, Stopped<M::Error>> {
    let mut search = Search::begin(values, start, model)?;
    search.go_on(values, weights, most, model)?;
    search.found(values, weights).map_err(Stopped::Numbers)
}

/// How far a search has come.
pub(crate) struct Search {
    x: Vec<f64>,
    /// Values of the model there.
    pub y: Vec<f64>,
    /// Slopes there, as far as they are known.
    pub slopes: DMatrix<f64>,
    has_slopes: bool,
    before: Vec<f64>,
    steps: usize,
    at_edge: bool,
}

/// Values less those of the model, with their weights.
fn rest(values: &[f64], y: &[f64], weights: &[f64]) -> Vec<f64> {
    values.iter().zip(y).zip(weights).map(|((value, y), weight)| weight * (value - y)).collect()
}

fn squares(rest: &[f64]) -> f64 {
    rest.iter().map(|x| x * x).sum()
}

impl Search {
    /// Looks at the model at the start.
    pub fn begin<M: Model>(
        values: &[f64],
        start: &[f64],
        model: &mut M,
    ) -> Result<Search, Stopped<M::Error>> {
        let (rows, unknowns) = (values.len(), start.len());
        if rows < unknowns || unknowns == 0 {
            return Err(Stopped::Numbers(IdentifyError::TooFew { values: rows, unknowns }));
        }
        finite("value", values).map_err(Stopped::Numbers)?;
        let before = model.values(start).map_err(Stopped::Model)?.ok_or(Stopped::NoStart)?;
        finite("value", &before).map_err(Stopped::Numbers)?;
        Ok(Search {
            x: start.to_vec(),
            y: before.clone(),
            slopes: DMatrix::zeros(0, 0),
            has_slopes: false,
            before,
            steps: 0,
            at_edge: false,
        })
    }

    /// Searches from where it is to the least sum of squares with these weights; `most` counts the steps of all searches.
    pub fn go_on<M: Model>(
        &mut self,
        values: &[f64],
        weights: &[f64],
        most: usize,
        model: &mut M,
    ) -> Result<(), Stopped<M::Error>> {
        let unknowns = self.x.len();
        let (mut damping, mut growth) = (1e-3, 2.0);
        loop {
            if !self.has_slopes {
                self.slopes = model.slopes(&self.x).map_err(Stopped::Model)?;
                self.has_slopes = true;
            }
            let misfit = rest(values, &self.y, weights);
            let mut weighted = self.slopes.clone();
            weighted.row_iter_mut().zip(weights).for_each(|(mut row, weight)| row *= *weight);
            let gradient = weighted.tr_mul(&nalgebra::DVector::from_column_slice(&misfit));
            let normal = weighted.tr_mul(&weighted);
            let (mut is_better, mut is_settled) = (false, false);
            self.at_edge = false;
            while !is_better && !is_settled {
                let mut damped = normal.clone();
                for j in 0..unknowns {
                    damped[(j, j)] += damping * normal[(j, j)].max(f64::MIN_POSITIVE);
                }
                let change = damped.cholesky().map(|factor| factor.solve(&gradient));
                let tried = match &change {
                    Some(change) => {
                        let next: Vec<f64> =
                            self.x.iter().zip(change.iter()).map(|(x, change)| x + change).collect();
                        let next_y = model.values(&next).map_err(Stopped::Model)?;
                        self.at_edge |= next_y.is_none();
                        next_y.filter(|y| y.iter().all(|y| y.is_finite())).map(|y| (next, y, change))
                    }
                    None => None,
                };
                let now = squares(&misfit);
                match tried.map(|(next, next_y, change)| {
                    (squares(&rest(values, &next_y, weights)), next, next_y, change)
                }) {
                    Some((after, next, next_y, change)) if after < now => {
                        let expected: f64 = (0..unknowns)
                            .map(|j| change[j] * (damping * normal[(j, j)] * change[j] + gradient[j]))
                            .sum();
                        is_settled = self.is_small(change) || now - after <= NOTHING_TO_GAIN * now;
                        let gain = (now - after) / expected.max(f64::MIN_POSITIVE);
                        damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
                        (self.x, self.y, self.has_slopes) = (next, next_y, false);
                        (growth, is_better) = (2.0, true);
                        self.steps += 1;
                    }
                    _ => {
                        is_settled =
                            change.is_some_and(|change| self.is_small(&change)) || damping > MOST_DAMPING;
                        (damping, growth) = (damping * growth, 2.0 * growth);
                    }
                }
            }
            if is_settled {
                break;
            }
            if self.steps >= most {
                return Err(Stopped::Numbers(IdentifyError::NotSettled { steps: most }));
            }
        }
        if !self.has_slopes {
            self.slopes = model.slopes(&self.x).map_err(Stopped::Model)?;
            self.has_slopes = true;
        }
        Ok(())
    }

    fn is_small(&self, change: &nalgebra::DVector<f64>) -> bool {
        self.x.iter().zip(change.iter()).all(|(x, change)| change.abs() <= SETTLED * x.abs())
    }

    /// What was found with the weights of the last search.
    pub fn found(self, values: &[f64], weights: &[f64]) -> Result<Fitted, IdentifyError> {
        let left: Vec<f64> = values.iter().zip(&self.y).map(|(value, y)| value - y).collect();
        // The linear fit of what is left gives the accuracy; its values are the change of one more step.
        let mut fit = least_squares(&self.slopes, &left, weights)?;
        fit.estimates.iter_mut().zip(&self.x).for_each(|(estimate, x)| estimate.value = *x);
        let now = squares(&rest(values, &self.y, weights));
        let promised = fit.residual.powi(2) * fit.freedom as f64;
        // What is left of an exact fit is rounding, of which slopes may promise anything.
        let is_rounding = now <= ROUNDING * squares(&rest(values, &vec![0.0; values.len()], weights));
        let stalled = !self.at_edge && !is_rounding && fit.freedom > 0 && now - promised > PROMISED * now;
        let correlations = correlations(&self.slopes, weights);
        let Search { y, before, steps, at_edge, .. } = self;
        Ok(Fitted { fit, values: y, before, steps, at_edge, stalled, correlations })
    }
}

/// A formula for values and slopes.
struct Formula<F> {
    rows: usize,
    model: F,
}

impl<F: Fn(&[f64], &mut [f64], &mut [f64])> Formula<F> {
    /// Values, and derivatives row by row.
    fn at(&self, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (mut y, mut slopes) = (vec![0.0; self.rows], vec![0.0; self.rows * x.len()]);
        (self.model)(x, &mut y, &mut slopes);
        (y, slopes)
    }
}

impl<F: Fn(&[f64], &mut [f64], &mut [f64])> Model for Formula<F> {
    type Error = Infallible;

    fn values(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, Infallible> {
        Ok(Some(self.at(x).0))
    }

    fn slopes(&mut self, x: &[f64]) -> Result<DMatrix<f64>, Infallible> {
        Ok(DMatrix::from_row_slice(self.rows, x.len(), &self.at(x).1))
    }
}

/// Finds the `x` for which the sum of squares of `values - model(x)` is least, from a start, as [`fit()`] does. `model` writes its
/// values and its derivatives, row-major: one row for each value.
///
/// # Errors
/// As [`least_squares`], or [`IdentifyError::NotSettled`].
pub fn nonlinear_least_squares(
    values: &[f64],
    start: &[f64],
    model: impl Fn(&[f64], &mut [f64], &mut [f64]),
) -> Result<Fit, IdentifyError> {
    /// Far more than a sound fit needs.
    const STEPS: usize = 500;
    let rows = values.len();
    match fit(values, &vec![1.0; rows], start, STEPS, &mut Formula { rows, model }) {
        Ok(fitted) => Ok(fitted.fit),
        Err(Stopped::Numbers(error)) => Err(error),
        Err(Stopped::Model(never)) => match never {},
        // A formula has values everywhere.
        Err(Stopped::NoStart) => Err(IdentifyError::NotSettled { steps: 0 }),
    }
}

/// Correlation of the estimates of each pair of unknowns, from the slopes of the values by them; NaN where they cannot be told apart.
pub fn correlations(slopes: &DMatrix<f64>, weights: &[f64]) -> DMatrix<f64> {
    let mut weighted = slopes.clone();
    weighted.row_iter_mut().zip(weights).for_each(|(mut row, weight)| row *= *weight);
    for mut column in weighted.column_iter_mut() {
        let length = column.norm();
        column /= length;
    }
    let unknowns = slopes.ncols();
    match weighted.tr_mul(&weighted).try_inverse() {
        Some(inverse) => DMatrix::from_fn(unknowns, unknowns, |i, j| {
            inverse[(i, j)] / (inverse[(i, i)] * inverse[(j, j)]).sqrt()
        }),
        None => DMatrix::from_element(unknowns, unknowns, f64::NAN),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `a exp(-b t)` at 20 times; there are no values for negative `b`.
    #[derive(Default)]
    struct Decay {
        looks: usize,
        refusals: usize,
    }

    const TIMES: usize = 20;

    fn time(k: usize) -> f64 {
        0.1 * k as f64
    }

    impl Model for Decay {
        type Error = ();

        fn values(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, ()> {
            self.looks += 1;
            self.refusals += usize::from(x[1] < 0.0);
            Ok((x[1] >= 0.0).then(|| (0..TIMES).map(|k| x[0] * (-x[1] * time(k)).exp()).collect()))
        }

        fn slopes(&mut self, x: &[f64]) -> Result<DMatrix<f64>, ()> {
            Ok(DMatrix::from_fn(TIMES, 2, |k, j| {
                let e = (-x[1] * time(k)).exp();
                if j == 0 { e } else { -x[0] * time(k) * e }
            }))
        }
    }

    fn wanted(noise: f64) -> Vec<f64> {
        (0..TIMES).map(|k| 3.0 * (-0.7 * time(k)).exp() + noise * (7.0 * k as f64).sin()).collect()
    }

    #[test]
    fn a_decay_is_found_again_from_far_away() {
        let mut model = Decay::default();
        let found = fit(&wanted(0.0), &[1.0; TIMES], &[1.0, 3.0], 50, &mut model).expect("a fit");
        for (estimate, x) in found.fit.estimates.iter().zip([3.0, 0.7]) {
            assert!((estimate.value - x).abs() < 1e-9, "{estimate:?}");
        }
        assert!(found.fit.residual < 1e-9 && model.looks < 60, "{} looks", model.looks);
        assert!(!found.at_edge);
    }

    #[test]
    fn what_is_not_explained_gives_the_intervals() {
        let found = fit(&wanted(0.05), &[1.0; TIMES], &[1.0, 1.0], 50, &mut Decay::default()).expect("a fit");
        for (estimate, x) in found.fit.estimates.iter().zip([3.0, 0.7]) {
            assert!(
                estimate.holds(x) && estimate.interval < 0.1 * x && estimate.interval > 0.0,
                "{estimate:?}"
            );
        }
        let correlation = found.correlations[(0, 1)];
        assert!(correlation > 0.3 && correlation < 0.99, "{correlation}");
    }

    #[test]
    fn steps_to_where_there_are_no_values_are_taken_back() {
        // The best decay rate of what grows would be negative.
        let growing: Vec<f64> = (0..TIMES).map(|k| time(k).exp()).collect();
        let mut model = Decay::default();
        let found = fit(&growing, &[1.0; TIMES], &[1.0, 1.0], 200, &mut model).expect("a fit");
        assert!(model.refusals > 0 && found.at_edge);
        assert!(
            found.fit.estimates[1].value >= 0.0 && found.fit.estimates[1].value < 1e-3,
            "{:?}",
            found.fit
        );
        assert_eq!(fit(&growing, &[1.0; TIMES], &[1.0, -1.0], 9, &mut model), Err(Stopped::NoStart));
    }

    /// A line with wrong slopes, by which no step gets better.
    struct Misled;

    impl Model for Misled {
        type Error = ();

        fn values(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, ()> {
            Ok(Some((0..5).map(|k| x[0] * k as f64).collect()))
        }

        fn slopes(&mut self, _: &[f64]) -> Result<DMatrix<f64>, ()> {
            Ok(DMatrix::from_fn(5, 1, |k, _| -(k as f64)))
        }
    }

    #[test]
    fn slopes_that_promise_what_no_step_keeps_are_seen() {
        let values: Vec<f64> = (0..5).map(|k| 2.0 * k as f64 + 0.1 * (k % 2) as f64).collect();
        let found = fit(&values, &[1.0; 5], &[1.0], 50, &mut Misled).expect("an end");
        assert!(found.stalled && found.steps == 0, "{found:?}");
        let found = fit(&wanted(0.05), &[1.0; TIMES], &[1.0, 1.0], 50, &mut Decay::default()).expect("a fit");
        assert!(!found.stalled, "{found:?}");
    }

    /// Two unknowns of which only the product is seen.
    struct Product;

    impl Model for Product {
        type Error = ();

        fn values(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, ()> {
            Ok(Some((0..5).map(|k| x[0] * x[1] * k as f64).collect()))
        }

        fn slopes(&mut self, x: &[f64]) -> Result<DMatrix<f64>, ()> {
            Ok(DMatrix::from_fn(5, 2, |k, j| x[1 - j] * k as f64))
        }
    }

    #[test]
    fn unknowns_that_cannot_be_told_apart_are_refused() {
        let values: Vec<f64> = (0..5).map(|k| 6.0 * k as f64).collect();
        let found = fit(&values, &[1.0; 5], &[1.0, 1.0], 50, &mut Product);
        assert!(matches!(found, Err(Stopped::Numbers(IdentifyError::Dependent { .. }))), "{found:?}");
    }

    #[test]
    fn a_nonlinear_fit_finds_the_decay_that_made_the_data() {
        let t: Vec<f64> = (0..30).map(|i| 0.1 * f64::from(i)).collect();
        let values: Vec<f64> = t.iter().map(|t| 2.0 * (-1.5 * t).exp() + 0.3).collect();
        let model = |x: &[f64], y: &mut [f64], slopes: &mut [f64]| {
            for (i, t) in t.iter().enumerate() {
                let decay = (-x[1] * t).exp();
                y[i] = x[0] * decay + x[2];
                slopes[3 * i..3 * i + 3].copy_from_slice(&[decay, -x[0] * t * decay, 1.0]);
            }
        };
        let fit = nonlinear_least_squares(&values, &[1.0, 0.5, 0.0], model).unwrap();
        for (found, expected) in fit.estimates.iter().zip([2.0, 1.5, 0.3]) {
            assert!((found.value - expected).abs() < 1e-9, "{found:?} is not {expected}");
        }
        assert!(fit.residual < 1e-10);
    }
}
