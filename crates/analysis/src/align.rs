//! By how much one recording is late.

use crate::series::{Interpolation, Series};

/// Instants at which signals are looked at.
const POINTS: usize = 800;
/// Least common share of the shorter recording.
const OVERLAP: f64 = 0.5;
/// Halvings of the place of the best fit.
const HALVINGS: usize = 40;

/// The time to add to the times of the second signals so that they agree best with the first ones: the maximum of
/// their cross-correlation, normalised over what both cover and averaged over all pairs. At least half of the shorter
/// recording is covered. `None` where nothing varies or there are no values.
pub fn lag(pairs: &[(Series, Series)]) -> Option<f64> {
    let mut reach: Option<(f64, f64, f64)> = None;
    for (a, b) in pairs {
        let (Some(a), Some(b)) = (a.span(), b.span()) else { continue };
        let common = OVERLAP * (a.1 - a.0).min(b.1 - b.0);
        // Shifted by these the second one covers `common` of the first at its beginning and at its end.
        let (from, to) = (a.0 + common - b.1, a.1 - common - b.0);
        let width = (a.1 - a.0).min(b.1 - b.0);
        reach = Some(reach.map_or((from, to, width), |r| (r.0.max(from), r.1.min(to), r.2.min(width))));
    }
    let (from, to, width) = reach?;
    let usable = width > 0.0 && from <= to && (to - from).is_finite();
    if !usable {
        return None;
    }
    let step = width / POINTS as f64;
    let shifts = ((to - from) / step).ceil().min(8.0 * POINTS as f64) as usize;
    let step = if shifts > 0 { (to - from) / shifts as f64 } else { step };
    let score = |shift: f64| correlation(pairs, shift);
    let best = (0..=shifts)
        .map(|n| from + n as f64 * step)
        .filter_map(|shift| Some((shift, score(shift)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    // Between its neighbours the maximum is the only one: thirds.
    let (mut low, mut high) = (best.0 - step, best.0 + step);
    for _ in 0..HALVINGS {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if score(a).unwrap_or(-1.0) < score(b).unwrap_or(-1.0) { low = a } else { high = b }
    }
    Some((low + high) / 2.0)
}

/// Mean over the pairs of the correlation of the first signal with the second one shifted; `None` where none varies.
fn correlation(pairs: &[(Series, Series)], shift: f64) -> Option<f64> {
    let of = |(a, b): &(Series, Series)| {
        let (span_a, span_b) = (a.span()?, b.span()?);
        let (from, to) = (span_a.0.max(span_b.0 + shift), span_a.1.min(span_b.1 + shift));
        if from >= to {
            return None;
        }
        let value =
            |s: &Series, t: f64| s.at(t, Interpolation::Linear, 0.0).map(|v| v.1).filter(|x| x.is_finite());
        let samples = (0..=POINTS).filter_map(|n| {
            let t = from + (to - from) * n as f64 / POINTS as f64;
            Some((value(a, t)?, value(b, t - shift)?))
        });
        let samples: Vec<(f64, f64)> = samples.collect();
        let n = samples.len().max(1) as f64;
        let (ma, mb) = samples.iter().fold((0.0, 0.0), |m, s| (m.0 + s.0 / n, m.1 + s.1 / n));
        let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
        for (x, y) in samples {
            let (x, y) = (x - ma, y - mb);
            (ab, aa, bb) = (ab + x * y, aa + x * x, bb + y * y);
        }
        // What varies by no more than rounding does not vary.
        let varies = |squares: f64, mean: f64| squares > n * (1e-12 * mean).powi(2);
        let size = (aa * bb).sqrt();
        (varies(aa, ma) && varies(bb, mb) && size > 0.0 && size.is_finite()).then(|| ab / size)
    };
    let found: Vec<f64> = pairs.iter().filter_map(of).collect();
    (!found.is_empty()).then(|| found.iter().sum::<f64>() / found.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bell(rate: f64, end: f64, at: f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..=(end * rate) as u32).map(|k| f64::from(k) / rate).collect();
        let values = time.iter().map(|t| 3.0 + (-((t - at) / 0.4).powi(2)).exp()).collect();
        (time, values)
    }

    #[test]
    fn a_late_recording_is_shifted_back() {
        for late in [0.1234, -0.7, 0.0] {
            let (a, b) = (bell(1000.0, 5.0, 2.0), bell(730.0, 4.5, 2.0 + late));
            let found = lag(&[(Series::new(&a.0, &a.1), Series::new(&b.0, &b.1))]).unwrap();
            // Rows of 1 ms, straight between: the shape of the bell is known to 1e-6 of its height.
            assert!((found + late).abs() < 1e-3, "{found} is not {}", -late);
        }
    }

    #[test]
    fn scale_and_offset_do_not_matter() {
        let (a, mut b) = (bell(500.0, 5.0, 2.0), bell(500.0, 5.0, 2.3));
        b.1.iter_mut().for_each(|y| *y = 100.0 + 40.0 * *y);
        let found = lag(&[(Series::new(&a.0, &a.1), Series::new(&b.0, &b.1))]).unwrap();
        assert!((found + 0.3).abs() < 1e-3, "{found}");
    }

    #[test]
    fn what_does_not_vary_has_no_lag() {
        let flat = (vec![0.0, 1.0, 2.0], vec![1.0; 3]);
        let series = Series::new(&flat.0, &flat.1);
        assert_eq!(lag(&[(series, series)]), None);
        assert_eq!(lag(&[]), None);
        assert_eq!(lag(&[(Series::new(&[], &[]), series)]), None);
        let nan = (vec![0.0, 1.0, 2.0], vec![f64::NAN; 3]);
        assert_eq!(lag(&[(Series::new(&nan.0, &nan.1), series)]), None);
    }
}
