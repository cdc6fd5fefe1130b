//! Any number of values reduced to what a screen can show.

use std::ops::RangeInclusive;

/// The course of a signal within a range of time, by at most four points for each of `columns` equally wide columns of
/// a screen: the first, the least, the largest and the last, at their times (Jugel et al., "M4", VLDB 2014). A line
/// through them covers the same dots as one through all. Where values or times are not finite the course ends, and
/// another begins behind them. `step` is for values that hold until the next one.
///
/// One point beyond each end of the range is kept where there is one, so that the line reaches it.
pub fn thinned(
    time: &[f64],
    values: &[f64],
    range: &RangeInclusive<f64>,
    columns: usize,
    step: bool,
) -> Vec<Vec<(f64, f64)>> {
    let rows = time.len().min(values.len());
    let (time, values) = (&time[..rows], &values[..rows]);
    let (from, to) = (*range.start(), *range.end());
    let begin = time.partition_point(|&t| t < from).saturating_sub(1);
    let end = (time.partition_point(|&t| t <= to) + 1).min(rows);
    let width = (to - from) / columns.max(1) as f64;
    let column = |t: f64| if width > 0.0 { ((t - from) / width).floor() } else { 0.0 };

    let mut courses = Vec::new();
    let mut course: Vec<(f64, f64)> = Vec::new();
    let mut open: Option<Column> = None;
    for at in begin..end.max(begin) {
        let point = (time[at], values[at]);
        if !point.0.is_finite() || !point.1.is_finite() {
            close(&mut course, open.take());
            if !course.is_empty() {
                courses.push(std::mem::take(&mut course));
            }
            continue;
        }
        let here = column(point.0);
        match &mut open {
            Some(column) if column.number == here => column.add(point),
            _ => {
                close(&mut course, open.take());
                open = Some(Column { number: here, first: point, low: point, high: point, last: point });
            }
        }
    }
    close(&mut course, open);
    if !course.is_empty() {
        courses.push(course);
    }
    if step { courses.iter().map(|course| stairs(course)).collect() } else { courses }
}

/// What is known of one column of the screen.
struct Column {
    number: f64,
    first: (f64, f64),
    low: (f64, f64),
    high: (f64, f64),
    last: (f64, f64),
}

impl Column {
    fn add(&mut self, point: (f64, f64)) {
        if point.1 < self.low.1 {
            self.low = point;
        }
        if point.1 > self.high.1 {
            self.high = point;
        }
        self.last = point;
    }
}

fn close(course: &mut Vec<(f64, f64)>, column: Option<Column>) {
    let Some(Column { first, low, high, last, .. }) = column else { return };
    let between = if low.0 <= high.0 { [low, high] } else { [high, low] };
    let begin = course.len();
    for point in [first, between[0], between[1], last] {
        if course[begin..].last() != Some(&point) {
            course.push(point);
        }
    }
}

/// The same with a corner before each value.
fn stairs(course: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut stairs: Vec<(f64, f64)> = Vec::with_capacity(2 * course.len());
    for &(t, y) in course {
        if let Some(&(_, before)) = stairs.last()
            && before != y
        {
            stairs.push((t, before));
        }
        stairs.push((t, y));
    }
    stairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_million_values_become_four_a_column_and_no_spike_is_lost() {
        let n = 2_000_000;
        let time: Vec<f64> = (0..n).map(|k| f64::from(k) * 1e-3).collect();
        let mut values: Vec<f64> = time.iter().map(|t| t.sin()).collect();
        values[1_234_567] = 9.0;
        let courses = thinned(&time, &values, &(0.0..=2000.0), 800, false);
        assert_eq!(courses.len(), 1);
        assert!(courses[0].len() <= 4 * 801, "{}", courses[0].len());
        assert!(courses[0].contains(&(1234.567, 9.0)));
        assert!(courses[0].is_sorted_by_key(|p| p.0));
        assert_eq!(
            (courses[0][0], *courses[0].last().unwrap()),
            ((0.0, 0.0), (time[n as usize - 1], values[n as usize - 1]))
        );
    }

    #[test]
    fn few_values_stay_as_they_are() {
        let courses = thinned(&[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 6.0], &(0.0..=2.0), 100, false);
        assert_eq!(courses, [vec![(0.0, 0.0), (1.0, 1.0), (1.0, 5.0), (2.0, 6.0)]]);
    }

    #[test]
    fn what_is_not_finite_is_a_gap() {
        let time = [0.0, 1.0, 2.0, 3.0, 4.0];
        let courses = thinned(&time, &[0.0, f64::NAN, 2.0, 3.0, f64::INFINITY], &(0.0..=4.0), 10, false);
        assert_eq!(courses, [vec![(0.0, 0.0)], vec![(2.0, 2.0), (3.0, 3.0)]]);
        assert!(thinned(&[f64::NAN], &[1.0], &(0.0..=1.0), 10, false).is_empty());
        assert!(thinned(&[], &[], &(0.0..=1.0), 10, false).is_empty());
    }

    #[test]
    fn a_range_keeps_one_point_beyond_each_end() {
        let time: Vec<f64> = (0..10).map(f64::from).collect();
        let courses = thinned(&time, &time, &(3.5..=5.5), 10, false);
        assert_eq!(courses, [vec![(3.0, 3.0), (4.0, 4.0), (5.0, 5.0), (6.0, 6.0)]]);
    }

    #[test]
    fn held_values_have_corners() {
        let courses = thinned(&[0.0, 1.0, 2.0], &[0.0, 1.0, 1.0], &(0.0..=2.0), 10, true);
        assert_eq!(courses, [vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0)]]);
    }
}
