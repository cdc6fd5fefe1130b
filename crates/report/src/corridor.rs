//! Courses as few points between which straight lines, or steps, come near all others.

use std::ops::Range;

/// Share of the range of a course within which the lines stay at first.
const NEAR: f64 = 5e-4;

/// Positions of the points that are kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Few {
    /// Positions, rising.
    pub rows: Vec<usize>,
    /// How far any other point may be off, in the unit of the values.
    pub tolerance: f64,
}

/// At most about `most` points of a course whose times never fall: as near to it as that many allow, and not nearer than
/// 0.05 % of its range. `held` values stay until the next one. Where values are missing a gap stays.
pub fn few(time: &[f64], values: &[f64], held: bool, most: usize) -> Few {
    let finite = || values.iter().copied().filter(|x| x.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    // Half of each, for the difference of two numbers may be too large for one.
    let mut tolerance = if high > low { 2.0 * NEAR * (high / 2.0 - low / 2.0) } else { 0.0 };
    loop {
        let rows = if held { steps(values, tolerance) } else { lines(time, values, tolerance) };
        // Beyond the whole range nothing gets fewer: what is left are gaps and jumps.
        let coarse = tolerance >= 2.0 * (high - low) || tolerance <= 0.0;
        if rows.len() <= most || coarse || !tolerance.is_finite() {
            return Few { rows, tolerance };
        }
        tolerance *= 2.0;
    }
}

/// Points where a value differs from the last one that was kept.
fn steps(values: &[f64], tolerance: f64) -> Vec<usize> {
    let mut rows: Vec<usize> = Vec::new();
    for (row, value) in values.iter().enumerate() {
        let same = rows.last().is_some_and(|&last| {
            let known = values[last];
            (known - value).abs() <= tolerance || (!known.is_finite() && known.to_bits() == value.to_bits())
        });
        if !same {
            rows.push(row);
        }
    }
    keep_last(&mut rows, values.len());
    rows
}

/// Ends of lines: each as long as all points on its way lie within the tolerance ("swinging door").
fn lines(time: &[f64], values: &[f64], tolerance: f64) -> Vec<usize> {
    let mut rows = Vec::new();
    let mut begin = 0;
    // Gaps and what lies between them are stretches of their own.
    for stretch in values.chunk_by(|a, b| a.is_finite() == b.is_finite()) {
        let end = begin + stretch.len();
        rows.push(begin);
        if stretch[0].is_finite() {
            bends(time, values, begin..end, tolerance, &mut rows);
        }
        keep_last(&mut rows, end);
        begin = end;
    }
    rows
}

/// Adds where the lines of a stretch meet.
fn bends(time: &[f64], values: &[f64], stretch: Range<usize>, tolerance: f64, rows: &mut Vec<usize>) {
    const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
    let (mut from, mut slopes) = (stretch.start, ANY);
    for row in stretch.start + 1..stretch.end {
        let slope_to = |from: usize| (values[row] - values[from]) / (time[row] - time[from]);
        if time[row] > time[from] && !(slopes.0..=slopes.1).contains(&slope_to(from)) {
            // The line ends at the point before, where the next one begins.
            (from, slopes) = (row - 1, ANY);
            rows.push(from);
        }
        if time[row] > time[from] {
            let (slope, room) = (slope_to(from), tolerance / (time[row] - time[from]));
            slopes = (slopes.0.max(slope - room), slopes.1.min(slope + room));
        } else {
            // A jump: both of its ends stay.
            rows.push(row);
            (from, slopes) = (row, ANY);
        }
    }
}

fn keep_last(rows: &mut Vec<usize>, length: usize) {
    if length > 0 && rows.last() != Some(&(length - 1)) {
        rows.push(length - 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest distance of a course from what its few points tell.
    fn farthest(time: &[f64], values: &[f64], rows: &[usize]) -> f64 {
        let between = rows.windows(2).flat_map(|pair| {
            let [from, to] = [pair[0], pair[1]];
            (from..=to).map(move |row| {
                let share = if time[to] > time[from] {
                    (time[row] - time[from]) / (time[to] - time[from])
                } else {
                    0.0
                };
                let inner = row != from && row != to;
                if inner {
                    (values[from] + share * (values[to] - values[from]) - values[row]).abs()
                } else {
                    0.0
                }
            })
        });
        between.fold(0.0, f64::max)
    }

    #[test]
    fn a_smooth_course_of_a_hundred_thousand_points_needs_few_and_none_is_farther_off_than_said() {
        let time: Vec<f64> = (0..100_000).map(|k| f64::from(k) * 1e-4).collect();
        let values: Vec<f64> = time.iter().map(|t| 3.0 * (2.0 * t).sin() * (-0.2 * t).exp()).collect();
        let few = few(&time, &values, false, 1000);
        assert!(few.rows.len() < 200, "{}", few.rows.len());
        assert!(few.tolerance < 6e-4 * 6.0, "{}", few.tolerance);
        let off = farthest(&time, &values, &few.rows);
        assert!(off <= few.tolerance * (1.0 + 1e-9), "{off} {}", few.tolerance);
        assert_eq!((few.rows[0], *few.rows.last().unwrap()), (0, 99_999));
    }

    #[test]
    fn noise_becomes_coarser_until_it_fits_and_a_spike_stays() {
        let time: Vec<f64> = (0..50_000).map(f64::from).collect();
        let mut values: Vec<f64> =
            (0..50_000_u32).map(|k| f64::from(k.wrapping_mul(2_654_435_761) >> 20) / 4096.0).collect();
        values[20_001] = 50.0;
        let few = few(&time, &values, false, 300);
        assert!(few.rows.len() <= 300 && few.rows.contains(&20_001));
        assert!(farthest(&time, &values, &few.rows) <= few.tolerance * (1.0 + 1e-9));
    }

    #[test]
    fn jumps_constants_gaps_and_held_values_keep_what_matters() {
        let rows = |time: &[f64], values: &[f64], held| few(time, values, held, 100).rows;
        assert_eq!(rows(&[0.0, 1.0, 2.0, 3.0], &[5.0; 4], false), [0, 3]);
        assert_eq!(rows(&[0.0, 1.0, 1.0, 2.0], &[0.0, 0.0, 1.0, 1.0], false), [0, 1, 2, 3]);
        assert_eq!(rows(&[0.0, 1.0, 2.0, 3.0, 4.0], &[0.0, 0.0, 1.0, 1.0, 0.0], true), [0, 2, 4]);
        let nan = f64::NAN;
        let gap = [1.0, 1.0, nan, nan, nan, nan, 2.0, 2.0];
        assert_eq!(rows(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0], &gap, false), [0, 1, 2, 5, 6, 7]);
        assert_eq!(rows(&[0.0, 1.0, 2.0], &[nan; 3], false), [0, 2]);
        assert_eq!(rows(&[0.0, 1.0, 2.0], &[nan; 3], true), [0, 2]);
        assert!(rows(&[], &[], false).is_empty());
    }
}
