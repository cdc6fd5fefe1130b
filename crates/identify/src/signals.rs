//! A fit to several signals, of which each has its own noise.

use nalgebra::DMatrix;

use crate::fit::{Fitted, Model, Search, Stopped};
use crate::student::interval_95;

/// A signal among the values of a fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// Number of its values, which follow those of the signal before.
    pub values: usize,
    /// Size of its changes, positive. One over it is the weight of the first fit.
    pub size: f64,
}

/// Values above the number of unknowns that tell the noise of a signal.
const TELLING: usize = 10;
/// Least noise that a signal is given, as a part of its size: one that fits exactly must not drown the others.
const LEAST: f64 = 1e-6;
/// Change of the noise of a signal against that of the others with which the weights have settled.
const SETTLED: f64 = 1e-2;
/// The part of an unknown that rounding seems to give to a signal that none changes.
const NOTHING: f64 = 1e-9;
/// Fits with other weights, at most.
const FITS: usize = 30;

/// The most likely unknowns where each signal has normally distributed noise of its own, unknown size: fits as of [`fit`](crate::fit()), each
/// with one over the noise that the fit before has left as weight, until the weights stay. The noise of a signal is that of its
/// differences, less the freedom that the unknowns have taken from them; the intervals follow from the noise of each signal.
///
/// A signal with too few values to tell its noise has that of all signals, relative to their sizes. Where nothing is left but
/// rounding, or no signal has enough values, the fit is one with the weights of the sizes.
///
/// Source: W. Förstner, *Ein Verfahren zur Schätzung von Varianz- und Kovarianzkomponenten*, Allgemeine Vermessungs-Nachrichten 86 (1979):
/// the noise of groups of values; F. E. Satterthwaite, *An Approximate Distribution of Estimates of Variance Components*, Biometrics
/// Bulletin 2 (1946): the degrees of freedom of the intervals.
///
/// # Errors
/// As [`fit`](crate::fit()).
pub fn fit_signals<M: Model>(
    values: &[f64],
    signals: &[Signal],
    start: &[f64],
    most: usize,
    model: &mut M,
) -> Result<Fitted, Stopped<M::Error>> {
    let by_size: Vec<f64> = signals.iter().map(|signal| 1.0 / signal.size).collect();
    let mut weights = spread(signals, &by_size);
    let mut search = Search::begin(values, start, model)?;
    search.go_on(values, &weights, most, model)?;
    let is_telling = |signal: &Signal| signal.values >= start.len() + TELLING;
    if signals.len() < 2 || !signals.iter().any(is_telling) {
        return search.found(values, &weights).map_err(Stopped::Numbers);
    }
    let mut deviations: Vec<f64> = signals.iter().map(|signal| signal.size).collect();
    let mut shares = Shares::of(&search.slopes, &weights, signals);
    for _ in 0..FITS {
        let next = noise(values, &search.y, signals, &shares, start.len());
        if signals.iter().zip(&next).all(|(signal, noise)| *noise <= LEAST * signal.size) {
            break;
        }
        // Common factors change no weights, and signals that no unknown changes have no say.
        let changes = next.iter().zip(&deviations).zip(&shares.taken).filter(|(_, taken)| **taken > NOTHING);
        let changes: Vec<f64> = changes.map(|((next, now), _)| next / now).collect();
        let (least, largest) =
            changes.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
        deviations = next;
        weights = spread(signals, &deviations.iter().map(|noise| 1.0 / noise).collect::<Vec<_>>());
        if largest <= (1.0 + SETTLED) * least {
            break;
        }
        search.go_on(values, &weights, most, model)?;
        shares = Shares::of(&search.slopes, &weights, signals);
    }
    let is_exact = signals.iter().zip(&deviations).all(|(signal, noise)| *noise == signal.size);
    let shares = if is_exact { None } else { Some(Shares::of(&search.slopes, &weights, signals)) };
    let mut fitted = search.found(values, &weights).map_err(Stopped::Numbers)?;
    // The weights are one over the noise, so what is left has a variance of one, but for signals that fit better than the least noise.
    for (number, estimate) in fitted.fit.estimates.iter_mut().enumerate() {
        let Some(shares) = &shares else { continue };
        let parts = &shares.variances[number];
        let variance: f64 = parts.iter().sum();
        let freedoms = parts.iter().zip(signals).zip(&shares.taken).map(|((part, signal), taken)| {
            let own =
                if is_telling(signal) { signal.values as f64 - taken } else { fitted.fit.freedom as f64 };
            part * part / own
        });
        let freedom = variance * variance / freedoms.sum::<f64>();
        estimate.error = variance.sqrt();
        estimate.interval = interval_95(freedom.max(1.0) as usize) * estimate.error;
    }
    Ok(fitted)
}

/// The number of each signal for each of its values.
fn spread(signals: &[Signal], numbers: &[f64]) -> Vec<f64> {
    let of = |(signal, number): (&Signal, &f64)| vec![*number; signal.values];
    signals.iter().zip(numbers).flat_map(of).collect()
}

/// The noise of each signal.
fn noise(values: &[f64], y: &[f64], signals: &[Signal], shares: &Shares, unknowns: usize) -> Vec<f64> {
    let mut at = 0;
    let squares: Vec<f64> = signals
        .iter()
        .map(|signal| {
            let rows = at..at + signal.values;
            at = rows.end;
            values[rows.clone()].iter().zip(&y[rows]).map(|(value, y)| (value - y).powi(2)).sum()
        })
        .collect();
    let freedom = (values.len() - unknowns).max(1) as f64;
    let relative =
        signals.iter().zip(&squares).map(|(signal, squares)| squares / signal.size.powi(2)).sum::<f64>();
    let of_all = (relative / freedom).sqrt();
    let of = |((signal, squares), taken): ((&Signal, &f64), &f64)| {
        let own = if signal.values >= unknowns + TELLING {
            (squares / (signal.values as f64 - taken)).sqrt()
        } else {
            of_all * signal.size
        };
        own.max(LEAST * signal.size)
    };
    signals.iter().zip(&squares).zip(&shares.taken).map(of).collect()
}

/// What each signal has to do with the unknowns of a fit in which all values have the same noise.
struct Shares {
    /// How many of the unknowns a signal determines; together all of them.
    taken: Vec<f64>,
    /// The part of the variance of each unknown that comes from each signal.
    variances: Vec<Vec<f64>>,
}

impl Shares {
    /// From the slopes of all values by the unknowns.
    fn of(slopes: &DMatrix<f64>, weights: &[f64], signals: &[Signal]) -> Shares {
        let mut scaled = slopes.clone();
        scaled.row_iter_mut().zip(weights).for_each(|(mut row, weight)| row *= *weight);
        let lengths: Vec<f64> = scaled.column_iter().map(|column| column.norm()).collect();
        scaled.column_iter_mut().zip(&lengths).for_each(|(mut column, length)| column /= *length);
        let qr = scaled.qr();
        let (q, unknowns) = (qr.q(), slopes.ncols());
        let one = DMatrix::identity(unknowns, unknowns);
        // Where unknowns cannot be told apart the fit is refused in the end.
        let inverse = qr.r().solve_upper_triangular(&one).unwrap_or(one);
        let effects = inverse * q.transpose();
        let (mut taken, mut variances) = (Vec::new(), vec![Vec::new(); unknowns]);
        let mut at = 0;
        for signal in signals {
            taken.push(q.rows(at, signal.values).norm_squared());
            let own = effects.columns(at, signal.values);
            for (number, parts) in variances.iter_mut().enumerate() {
                parts.push(own.row(number).norm_squared() / lengths[number].powi(2));
            }
            at += signal.values;
        }
        Shares { taken, variances }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::{Estimate, fit};
    use std::convert::Infallible;

    /// Values that are linear in the unknowns.
    struct Linear {
        slopes: DMatrix<f64>,
        looks: usize,
    }

    impl Model for Linear {
        type Error = Infallible;

        fn values(&mut self, x: &[f64]) -> Result<Option<Vec<f64>>, Infallible> {
            self.looks += 1;
            Ok(Some((&self.slopes * nalgebra::DVector::from_column_slice(x)).iter().copied().collect()))
        }

        fn slopes(&mut self, _: &[f64]) -> Result<DMatrix<f64>, Infallible> {
            Ok(self.slopes.clone())
        }
    }

    const TRUTH: [f64; 3] = [2.0, -0.7, 1.2];
    const ROWS: [usize; 3] = [60, 40, 50];
    const SIGNALS: [Signal; 3] = [
        Signal { values: ROWS[0], size: 1.0 },
        Signal { values: ROWS[1], size: 0.5 },
        Signal { values: ROWS[2], size: 1.2 },
    ];

    /// `a + b t`, `a t`, and `b + c` on its own: the last unknown is in the last signal alone.
    fn three() -> Linear {
        let row = |signal: usize, k: usize| {
            let t = k as f64 / ROWS[signal] as f64;
            [[1.0, t, 0.0], [t, 0.0, 0.0], [0.0, 1.0, 1.0]][signal]
        };
        let rows: Vec<[f64; 3]> =
            (0..3).flat_map(|signal| (0..ROWS[signal]).map(move |k| row(signal, k))).collect();
        Linear { slopes: DMatrix::from_fn(rows.len(), 3, |i, j| rows[i][j]), looks: 0 }
    }

    fn measured(model: &mut Linear, noise: [f64; 3], random: &mut Random) -> Vec<f64> {
        let sizes = spread(&SIGNALS, &noise);
        let exact = model.values(&TRUTH).ok().flatten().expect("values");
        exact.iter().zip(sizes).map(|(y, noise)| y + noise * random.normal()).collect()
    }

    /// Standard errors where the noise is known: the roots of the diagonal of `(J' V^-1 J)^-1`, from the normal equations.
    fn known(slopes: &DMatrix<f64>, noise: [f64; 3]) -> Vec<f64> {
        let sizes = spread(&SIGNALS, &noise);
        let normal = DMatrix::from_fn(3, 3, |i, j| {
            (0..slopes.nrows()).map(|k| slopes[(k, i)] * slopes[(k, j)] / sizes[k].powi(2)).sum::<f64>()
        });
        let inverse = normal.try_inverse().expect("independent unknowns");
        (0..3).map(|j| inverse[(j, j)].sqrt()).collect()
    }

    #[test]
    fn intervals_hold_the_truth_in_nineteen_of_twenty_cases_whatever_the_noise_of_each_signal() {
        for (seed, noise) in [(1, [0.002, 0.02, 0.3]), (2, [0.3, 0.002, 0.02]), (3, [0.1, 0.1, 0.1])] {
            let mut random = Random::new(seed);
            let mut model = three();
            let expected = known(&model.slopes, noise);
            const CASES: u32 = 1000;
            let (mut held, mut squares, mut widths) = ([0; 3], [0.0; 3], [0.0; 3]);
            for _ in 0..CASES {
                let values = measured(&mut model, noise, &mut random);
                let found = fit_signals(&values, &SIGNALS, &[1.0, 1.0, 1.0], 50, &mut model).expect("a fit");
                for j in 0..3 {
                    let Estimate { value, interval, .. } = found.fit.estimates[j];
                    held[j] += u32::from((value - TRUTH[j]).abs() <= interval);
                    squares[j] += ((value - TRUTH[j]) / expected[j]).powi(2) / f64::from(CASES);
                    widths[j] += interval / (1.96 * expected[j]) / f64::from(CASES);
                }
            }
            for j in 0..3 {
                // 950 with a standard deviation of 6.9; the variance is known to 4.5 %.
                assert!((925..=972).contains(&held[j]), "{noise:?}: {held:?} of {CASES}");
                assert!((0.8..1.2).contains(&squares[j]), "{noise:?}: not the best estimates: {squares:?}");
                assert!(
                    (0.95..1.1).contains(&widths[j]),
                    "{noise:?}: intervals are {widths:?} of the known ones"
                );
            }
        }
    }

    #[test]
    fn one_signal_is_an_ordinary_fit() {
        let mut model = three();
        let values = measured(&mut model, [0.1; 3], &mut Random::new(4));
        let all = [Signal { values: values.len(), size: 2.0 }];
        let one = fit_signals(&values, &all, &[1.0; 3], 50, &mut model).expect("a fit");
        assert_eq!(one, fit(&values, &vec![0.5; values.len()], &[1.0; 3], 50, &mut model).expect("a fit"));
    }

    #[test]
    fn a_signal_that_fits_exactly_does_not_drown_the_others() {
        let mut model = three();
        // `a` is known from the second signal as well as it may be, `b` from the first, `c` from the last.
        let values = measured(&mut model, [0.1, 0.0, 0.1], &mut Random::new(5));
        let found = fit_signals(&values, &SIGNALS, &[1.0; 3], 50, &mut model).expect("a fit");
        let a = found.fit.estimates[0];
        assert!((a.value - TRUTH[0]).abs() < 1e-9 && a.interval > 0.0 && a.interval < 1e-6, "{a:?}");
        let expected = known(&model.slopes, [0.1, 1e-7, 0.1]);
        for j in 1..3 {
            let Estimate { value, error, .. } = found.fit.estimates[j];
            assert!((value - TRUTH[j]).abs() < 4.0 * error, "{found:?}");
            // Sixty and fifty values tell the noise to a tenth.
            assert!((error / expected[j] - 1.0).abs() < 0.3, "{found:?}");
        }
    }

    #[test]
    fn where_all_is_exact_nothing_is_wide_and_no_fit_is_made_again() {
        let mut model = three();
        let values = measured(&mut model, [0.0; 3], &mut Random::new(6));
        let mut plain = three();
        let weights = spread(&SIGNALS, &SIGNALS.map(|signal| 1.0 / signal.size));
        let once = fit(&values, &weights, &[1.0; 3], 50, &mut plain).expect("a fit");
        model.looks = 0;
        let found = fit_signals(&values, &SIGNALS, &[1.0; 3], 50, &mut model).expect("a fit");
        assert_eq!((&found, model.looks), (&once, plain.looks));
        assert!(found.fit.estimates.iter().all(|estimate| estimate.interval < 1e-12), "{found:?}");
    }

    #[test]
    fn a_signal_of_few_values_has_the_noise_of_all() {
        // The last two values are a signal that one unknown alone fits exactly: its noise would be nothing.
        let mut model = three();
        let values = measured(&mut model, [0.1, 0.05, 0.12], &mut Random::new(7));
        let kept = ROWS[0] + ROWS[1] + 2;
        model.slopes = model.slopes.rows(0, kept).into_owned();
        let signals = [SIGNALS[0], SIGNALS[1], Signal { values: 2, ..SIGNALS[2] }];
        let found = fit_signals(&values[..kept], &signals, &[1.0; 3], 50, &mut model).expect("a fit");
        let c = found.fit.estimates[2];
        // Of two values with a noise of 0.12 each, and `b`, which has a standard error of about 0.02.
        assert!((c.error / (0.12 / 2.0_f64.sqrt()) - 1.0).abs() < 0.3, "{c:?}");
        assert!((c.value - TRUTH[2]).abs() < 4.0 * c.error, "{c:?}");
    }
}
