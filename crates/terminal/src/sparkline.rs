//! A series in one line.

/// Share of a signal's size below which what differs is rounding.
const ROUNDING: f64 = 1e-12;

/// The course of a signal over time in `width` signs from `▁` to `█`: each is the mean of the signal over its share of
/// the time from the first to the last of `time` (s, never falling). Values are joined by straight lines, or held until
/// the next one if `held`; around what is not finite nothing is known, and a share of the time without any known value
/// is a space.
///
/// Differences below `floor`, in the unit of the values, or below 1e-12 of the largest value are rounding: the line is
/// flat and low, as that of a constant.
pub fn sparkline(time: &[f64], values: &[f64], held: bool, floor: f64, width: usize) -> String {
    const SIGNS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let means = means(time, values, held, width);
    let known = || means.iter().flatten().copied();
    let (low, high) = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let is_flat = high - low <= floor.max(ROUNDING * low.abs().max(high.abs()));
    let sign = |mean: &Option<f64>| match mean {
        None => ' ',
        Some(_) if is_flat => SIGNS[0],
        Some(mean) => {
            let share = (mean / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0);
            SIGNS[((share * 8.0) as usize).min(7)]
        }
    };
    means.iter().map(sign).collect()
}

/// Means over `width` equal shares of the time; none where no value is known.
fn means(time: &[f64], values: &[f64], held: bool, width: usize) -> Vec<Option<f64>> {
    let rows = time.len().min(values.len());
    let Some((from, to)) = time[..rows].first().copied().zip(time[..rows].last().copied()) else {
        return Vec::new();
    };
    if to <= from || !(to - from).is_finite() {
        // Of one instant the last value is all there is.
        let last = values[..rows].iter().rev().copied().find(|x| x.is_finite());
        return if width > 0 { vec![last] } else { Vec::new() };
    }
    let wide = (to - from) / width as f64;
    // Area and time that are known, in shares of a column.
    let mut columns = vec![(0.0, 0.0); width];
    for n in 1..rows {
        let (begin, end) = (time[n - 1], time[n]);
        let (a, b) = (values[n - 1], if held { values[n - 1] } else { values[n] });
        if !(a.is_finite() && b.is_finite() && end > begin) {
            continue;
        }
        let at = |t: f64| a + (b / 2.0 - a / 2.0) * (2.0 * ((t - begin) / (end - begin)));
        let column = |t: f64| (((t - from) / wide) as usize).min(width.saturating_sub(1));
        for (k, (area, known)) in columns.iter_mut().enumerate().take(column(end) + 1).skip(column(begin)) {
            let left = begin.max(from + k as f64 * wide);
            let right = end.min(from + (k + 1) as f64 * wide);
            if right > left {
                let share = (right - left) / wide;
                *area += (at(left) / 2.0 + at(right) / 2.0) * share;
                *known += share;
            }
        }
    }
    let mean = |(area, known): &(f64, f64)| {
        (*known > 0.0).then(|| (area / known).clamp(f64::MIN, f64::MAX)).filter(|mean| !mean.is_nan())
    };
    columns.iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(n: u32) -> Vec<f64> {
        (0..n).map(f64::from).collect()
    }

    #[test]
    fn a_ramp_rises_through_all_signs() {
        assert_eq!(sparkline(&ramp(801), &ramp(801), false, 0.0, 8), "▁▂▃▄▅▆▇█");
    }

    #[test]
    fn many_rows_of_a_short_time_take_no_more_room_than_that_time() {
        // A thousand rows in the first tenth, five behind it: a straight line all the same.
        let time: Vec<f64> =
            (0..1000).map(|k| f64::from(k) * 1e-3).chain([1.0, 2.5, 5.0, 7.5, 10.0]).collect();
        assert_eq!(sparkline(&time, &time, false, 0.0, 8), "▁▂▃▄▅▆▇█");
        // A pulse from 6 s to 8 s that is held, of few rows behind many.
        let rows = [6.0, 8.0, 10.0];
        let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * 1e-3).chain(rows).collect();
        let values: Vec<f64> = time.iter().map(|&t| f64::from(u8::from((6.0..8.0).contains(&t)))).collect();
        assert_eq!(sparkline(&time, &values, true, 0.0, 10), "▁▁▁▁▁▁██▁▁");
    }

    #[test]
    fn noise_of_rounding_is_a_flat_line() {
        let time = ramp(100);
        let noise = |offset: f64, size: f64| -> Vec<f64> {
            time.iter().map(|t| offset + size * (7.0 * t).sin()).collect()
        };
        assert_eq!(sparkline(&time, &noise(3.0, 1e-15), false, 0.0, 6), "▁▁▁▁▁▁");
        assert_eq!(sparkline(&time, &noise(0.0, 1e-15), false, 1e-14, 6), "▁▁▁▁▁▁");
        assert_ne!(sparkline(&time, &noise(0.0, 1e-12), false, 1e-14, 6), "▁▁▁▁▁▁");
    }

    #[test]
    fn gaps_constants_and_extremes_are_drawn() {
        let values = [0.0, 0.0, f64::NAN, 1.0, 1.0];
        assert_eq!(sparkline(&ramp(5), &values, false, 0.0, 4), "▁  █");
        assert_eq!(sparkline(&ramp(5), &[3.0; 5], false, 0.0, 3), "▁▁▁");
        let extremes = [f64::MIN, f64::MIN, f64::MAX, f64::MAX];
        assert_eq!(sparkline(&[0.0, 1.0, 1.0, 2.0], &extremes, false, 0.0, 2), "▁█");
        assert_eq!(sparkline(&[], &[], false, 0.0, 10), "");
        assert_eq!(sparkline(&[0.0, 1.0], &[1.0, 2.0], false, 0.0, 0), "");
        assert_eq!(sparkline(&[2.0, 2.0], &[1.0, 2.0], false, 0.0, 7), "▁");
    }
}
