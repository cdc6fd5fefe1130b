//! Signals within a range of time.

use std::ops::RangeInclusive;

use crate::series::{Interpolation, Series};

/// Times that differ by less than this share of the whole are one.
const SAME_TIME: f64 = 1e-9;

/// The rows of signals on common times within a range of time, with a row at its beginning and at its end wherever there are
/// values before and behind: what holds there, or is on the way there, belongs to the range, too. Of a jump at its beginning the
/// value behind counts.
///
/// ```
/// use blocksim_analysis::{Interpolation, cut};
/// let (time, ramp) = ([0.0, 1.0, 2.0], [0.0, 10.0, 20.0]);
/// let (time, signals) = cut(&time, &[(&ramp, Interpolation::Linear)], &(0.5..=1.5));
/// assert_eq!((time, signals), (vec![0.5, 1.0, 1.5], vec![vec![5.0, 10.0, 15.0]]));
/// ```
pub fn cut(
    time: &[f64],
    signals: &[(&[f64], Interpolation)],
    range: &RangeInclusive<f64>,
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let (start, end) = (*range.start(), *range.end());
    let (Some(&first), Some(&last)) = (time.first(), time.last()) else {
        return (Vec::new(), vec![Vec::new(); signals.len()]);
    };
    let slack = SAME_TIME * (last - first);
    // Before the first row there is nothing, and of what is there all counts.
    let (mut from, mut begins) = (0, None);
    if start > first + slack {
        let behind = time.partition_point(|&t| t <= start + slack);
        let is_there = time[behind - 1] >= start - slack;
        from = if is_there { behind - 1 } else { behind };
        begins = (!is_there && behind < time.len()).then_some(start);
    }
    let to = time.partition_point(|&t| t <= end + slack).max(from);
    let is_there = to > 0 && time[to - 1] >= end - slack;
    // A range of one instant has one row.
    let ends = (!is_there && to > 0 && to < time.len() && begins != Some(end)).then_some(end);
    let times = begins.into_iter().chain(time[from..to].iter().copied()).chain(ends);
    let values = |&(values, interpolation): &(&[f64], Interpolation)| {
        let series = Series::new(time, values);
        let at = |t: f64| series.at(t, interpolation, 0.0).map_or(f64::NAN, |sides| sides.1);
        let inside = values.get(from..to).unwrap_or_default().iter().copied();
        begins.map(at).into_iter().chain(inside).chain(ends.map(at)).collect()
    };
    (times.collect(), signals.iter().map(values).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(time: &[f64], values: &[f64], range: RangeInclusive<f64>) -> (Vec<f64>, Vec<f64>) {
        let (time, mut all) = cut(time, &[(values, Interpolation::Smooth)], &range);
        (time, all.remove(0))
    }

    #[test]
    fn a_stair_holds_at_both_ends() {
        let (time, values) = ([0.0, 1.0, 1.0, 1.5, 1.5, 2.0], [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
        assert_eq!(of(&time, &values, 1.1..=1.4), (vec![1.1, 1.4], vec![1.0, 1.0]));
        assert_eq!(of(&time, &values, 0.3..=1.2), (vec![0.3, 1.0, 1.0, 1.2], vec![0.0, 0.0, 1.0, 1.0]));
        // What was before a jump at the beginning does not count, whatever the rounding.
        for from in [1.5, 1.5 - 1e-15, 1.5 + 1e-15] {
            assert_eq!(of(&time, &values, from..=9.0), (vec![1.5, 2.0], vec![0.0, 0.0]));
        }
        let held = cut(&[0.0, 1.0, 2.0], &[(&[3.0, 4.0, 5.0], Interpolation::Hold)], &(0.5..=1.5));
        assert_eq!(held, (vec![0.5, 1.0, 1.5], vec![vec![3.0, 4.0, 4.0]]));
    }

    #[test]
    fn a_range_beyond_the_rows_adds_none() {
        let (time, values) = ([0.0, 0.0, 1.0], [7.0, 8.0, 9.0]);
        for range in [f64::NEG_INFINITY..=f64::INFINITY, 0.0..=1.0, -1.0..=2.0] {
            assert_eq!(of(&time, &values, range), (time.to_vec(), values.to_vec()));
        }
        assert_eq!(of(&time, &values, 2.0..=3.0), (vec![], vec![]));
        assert_eq!(of(&time, &values, -2.0..=-1.0), (vec![], vec![]));
        assert_eq!(of(&time, &values, 0.5..=0.5), (vec![0.5], vec![8.5]));
        assert_eq!(of(&[], &[], 0.0..=1.0), (vec![], vec![]));
    }
}
