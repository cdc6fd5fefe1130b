//! By how much one recording is late.

use crate::series::{Interpolation, Series};

/// Instants at which signals are looked at.
const POINTS: usize = 800;
/// Least common share of the shorter recording.
const OVERLAP: f64 = 0.5;
/// Halvings of the place of a fit.
const HALVINGS: usize = 40;
/// Fits whose correlations differ by less, or squared differences by less than this share of those of the first signals, are
/// equally good: what remains are the errors between rows.
const SAME_CORRELATION: f64 = 1e-3;
const SAME_SQUARES: f64 = 1e-5;
/// Correlations of maxima on the grid that differ by less are looked at more closely.
const NEAR: f64 = 1e-2;
/// Most maxima that are looked at more closely, those with the least shifts, beside the highest.
const MOST: usize = 32;
/// From this share of the squares of the first signals on, the second ones have another scale, and differences say nothing.
const OTHER_SCALE: f64 = 0.5;

/// The time to add to the times of the second signals so that they agree best with the first ones: the maximum of
/// their cross-correlation, normalised over what both cover and averaged over all pairs. Signals that repeat have several:
/// of these it is the one with the least squared differences, and of equal ones that with the least shift. At least half of the
/// shorter recording is covered. `None` where nothing varies or there are no values.
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
    let grid: Vec<(f64, Option<f64>)> =
        (0..=shifts).map(|n| from + n as f64 * step).map(|shift| (shift, score(shift))).collect();
    let at = |n: Option<usize>| n.and_then(|n| grid.get(n)?.1).unwrap_or(f64::NEG_INFINITY);
    // The maxima on the grid and how high they are between its points: that of a parabola.
    let peak = |n: usize| {
        let (before, own, behind) = (at(n.checked_sub(1)), at(Some(n)), at(Some(n + 1)));
        let bend = 2.0 * own - before - behind;
        let above =
            if bend > 0.0 && bend.is_finite() { (behind - before).powi(2) / (8.0 * bend) } else { 0.0 };
        (own.is_finite() && own >= before && own > behind).then_some((grid[n].0, own + above))
    };
    let peaks: Vec<(f64, f64)> = (0..grid.len()).filter_map(peak).collect();
    let highest = peaks.iter().map(|peak| peak.1).fold(f64::NEG_INFINITY, f64::max);
    // Between its neighbours a maximum is the only one: thirds.
    let refined = |&(shift, _): &(f64, f64)| {
        let (mut low, mut high) = ((shift - step).max(from), (shift + step).min(to));
        for _ in 0..HALVINGS {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if score(a).unwrap_or(-1.0) < score(b).unwrap_or(-1.0) { low = a } else { high = b }
        }
        let shift = (low + high) / 2.0;
        // Recordings that are the same are not shifted by rounding.
        let shift = if shift.abs() < step && score(0.0) >= score(shift) { 0.0 } else { shift };
        Some((shift, score(shift)?))
    };
    let mut near: Vec<(f64, f64)> = peaks.into_iter().filter(|peak| peak.1 >= highest - NEAR).collect();
    near.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let is_chosen = |&(n, peak): &(usize, &(f64, f64))| n < MOST || peak.1 == highest;
    let chosen = near.iter().enumerate().filter(is_chosen).map(|(_, peak)| peak);
    let fits: Vec<(f64, f64)> = chosen.filter_map(refined).collect();
    let best = fits.iter().map(|fit| fit.1).fold(f64::NEG_INFINITY, f64::max);
    let alike = fits.iter().filter(|fit| fit.1 >= best - SAME_CORRELATION);
    let alike: Vec<(f64, f64)> = alike.map(|&(shift, _)| (shift, difference(pairs, shift))).collect();
    let least = alike.iter().map(|fit| fit.1).fold(f64::INFINITY, f64::min);
    let most = if least < OTHER_SCALE { least + SAME_SQUARES } else { f64::INFINITY };
    let nearest = alike.iter().filter(|fit| fit.1 <= most).map(|fit| fit.0);
    nearest.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// The values of a pair at the same instants, the second one shifted.
fn samples((a, b): &(Series, Series), shift: f64, interpolation: Interpolation) -> Option<Vec<(f64, f64)>> {
    let (span_a, span_b) = (a.span()?, b.span()?);
    let (from, to) = (span_a.0.max(span_b.0 + shift), span_a.1.min(span_b.1 + shift));
    if from >= to {
        return None;
    }
    let value = |s: &Series, t: f64| s.at(t, interpolation, 0.0).map(|v| v.1).filter(|x| x.is_finite());
    let samples = (0..=POINTS).filter_map(|n| {
        let t = from + (to - from) * n as f64 / POINTS as f64;
        Some((value(a, t)?, value(b, t - shift)?))
    });
    Some(samples.collect())
}

/// Mean over the pairs of the squared differences, as a share of the squares of the first signal about its mean.
fn difference(pairs: &[(Series, Series)], shift: f64) -> f64 {
    let of = |pair: &(Series, Series)| {
        let samples = samples(pair, shift, Interpolation::Smooth)?;
        let mean = samples.iter().map(|s| s.0).sum::<f64>() / samples.len() as f64;
        let squares = |of: &dyn Fn(&(f64, f64)) -> f64| samples.iter().map(|s| of(s).powi(2)).sum::<f64>();
        let share = squares(&|s| s.0 - s.1) / squares(&|s| s.0 - mean);
        share.is_finite().then_some(share)
    };
    let found: Vec<f64> = pairs.iter().filter_map(of).collect();
    if found.is_empty() { f64::INFINITY } else { found.iter().sum::<f64>() / found.len() as f64 }
}

/// Mean over the pairs of the correlation of the first signal with the second one shifted; `None` where none varies.
fn correlation(pairs: &[(Series, Series)], shift: f64) -> Option<f64> {
    let of = |pair: &(Series, Series)| {
        let samples = samples(pair, shift, Interpolation::Linear)?;
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
    fn a_signal_that_repeats_is_shifted_by_no_whole_period() {
        let wave = |rate: f64, y: &dyn Fn(f64) -> f64| -> (Vec<f64>, Vec<f64>) {
            let time: Vec<f64> = (0..=(5.0 * rate) as u32).map(|k| f64::from(k) / rate).collect();
            let values = time.iter().map(|&t| y(t)).collect();
            (time, values)
        };
        let sine = |t: f64| (std::f64::consts::TAU * 0.7 * t).sin();
        for (slope, late, rate) in [
            (0.0, 0.01, 100.0),
            (0.3, 0.01, 100.0),
            (0.0, 0.0, 100.0),
            (0.0, 0.123, 20.0),
            (-0.3, -0.2, 73.0),
        ] {
            let y = |t: f64| sine(t) + slope * t;
            let (a, b) = (wave(100.0, &y), wave(rate, &|t| y(t - late)));
            let found = lag(&[(Series::new(&a.0, &a.1), Series::new(&b.0, &b.1))]).unwrap();
            assert!((found + late).abs() < 2e-3, "{found} is not {}", -late);
        }
        // Each stair is the one before, but for its height.
        let stairs = wave(100.0, &f64::floor);
        let series = Series::new(&stairs.0, &stairs.1);
        assert_eq!(lag(&[(series, series)]), Some(0.0));
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
