//! Minimum and maximum of a signal within a window that slides over it.

use std::collections::VecDeque;

use crate::series::{Interpolation, Series};

/// Slides a window of constant width over a signal; the cost is that of one pass.
pub(crate) struct Window<'a> {
    series: Series<'a>,
    interpolation: Interpolation,
    half: f64,
    slack: f64,
    /// Rows that were not looked at yet begin here.
    next: usize,
    /// Times and values that are not in the window yet.
    ahead: VecDeque<(f64, f64)>,
    /// Candidates for the minimum, times and values, both rising; and for the maximum, values falling.
    low: VecDeque<(f64, f64)>,
    high: VecDeque<(f64, f64)>,
}

impl<'a> Window<'a> {
    pub fn new(series: Series<'a>, interpolation: Interpolation, half: f64, slack: f64) -> Window<'a> {
        let [ahead, low, high] = [const { VecDeque::new() }; 3];
        Window { series, interpolation, half, slack, next: 0, ahead, low, high }
    }

    /// Looks at the next row, and at the places behind it where a smooth signal goes beyond it and the row after it.
    fn look_ahead(&mut self) {
        let Series { time, values } = self.series;
        let at = self.next;
        self.ahead.push_back((time[at], values[at]));
        self.next += 1;
        if self.interpolation == Interpolation::Smooth && at + 1 < time.len() {
            let (h, rise, bend) =
                (time[at + 1] - time[at], values[at + 1] - values[at], self.series.bend(at));
            let mut shares: Vec<f64> = bend.at_rest(rise, h).collect();
            shares.sort_by(f64::total_cmp);
            let point = |s: f64| (time[at] + s * h, values[at] + s * rise + bend.off_chord(s, h));
            self.ahead.extend(shares.into_iter().map(point));
        }
    }

    /// The next value that is within the window around `t`, taken out of those ahead.
    fn come_in(&mut self, t: f64) -> Option<(f64, f64)> {
        if self.ahead.is_empty() && self.next < self.series.time.len() {
            self.look_ahead();
        }
        let end = t + self.half + self.slack;
        self.ahead.front().is_some_and(|(time, _)| *time <= end).then(|| self.ahead.pop_front())?
    }

    /// Minimum and maximum within `half` of `t`, or as near as rounding of times, which must not fall from call to call. Values that are not finite are left
    /// out.
    pub fn around(&mut self, t: f64) -> Option<(f64, f64)> {
        while let Some(new) = self.come_in(t) {
            if new.1.is_finite() {
                while self.low.back().is_some_and(|(_, value)| *value >= new.1) {
                    self.low.pop_back();
                }
                while self.high.back().is_some_and(|(_, value)| *value <= new.1) {
                    self.high.pop_back();
                }
                self.low.push_back(new);
                self.high.push_back(new);
            }
        }
        for candidates in [&mut self.low, &mut self.high] {
            while candidates.front().is_some_and(|(time, _)| *time < t - self.half - self.slack) {
                candidates.pop_front();
            }
        }
        // The signal at both ends of the window, between its values.
        let ends = [t - self.half, t + self.half].map(|t| self.series.at(t, self.interpolation, self.slack));
        let ends = ends.into_iter().flatten().flat_map(|(from, to)| [from, to]);
        let inside = [self.low.front(), self.high.front()].into_iter().flatten().map(|(_, value)| *value);
        let (low, high) = ends
            .chain(inside)
            .filter(|x| x.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        (low <= high).then_some((low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_agrees_with_looking_at_all_values() {
        let time: Vec<f64> = (0..500).map(|k| f64::from(k) * 0.01).collect();
        let values: Vec<f64> = time.iter().map(|t| (7.0 * t).sin() * (1.3 * t).cos()).collect();
        let series = Series::new(&time, &values);
        let mut window = Window::new(series, Interpolation::Hold, 0.2, 0.0);
        for &t in &time {
            let (low, high) = window.around(t).unwrap();
            let near = |s: &f64| (s - t).abs() <= 0.2;
            let all: Vec<f64> = time.iter().zip(&values).filter(|(s, _)| near(s)).map(|p| *p.1).collect();
            // The value held at the beginning of the window may come from just before it.
            assert!(low <= all.iter().copied().fold(f64::INFINITY, f64::min) + 1e-12);
            assert!(high >= all.iter().copied().fold(f64::NEG_INFINITY, f64::max) - 1e-12);
            assert!(high - low <= 0.4 * 8.5, "the slope is at most 8.3 1/s: {low} {high}");
        }
    }

    #[test]
    fn a_smooth_signal_reaches_its_maximum_between_its_values() {
        // Rows of a parabola with its top between them, at 2.4.
        let time: Vec<f64> = (0..8).map(f64::from).collect();
        let values: Vec<f64> = time.iter().map(|t| 5.0 - (t - 2.4).powi(2)).collect();
        let series = Series::new(&time, &values);
        let around = |interpolation| {
            let mut window = Window::new(series, interpolation, 0.3, 0.0);
            [1.9, 2.05, 2.2, 2.6, 2.75].map(|t| window.around(t).unwrap().1)
        };
        let top = |t: f64| 5.0 - (t - 2.4).powi(2);
        let expected = [top(2.2), top(2.35), 5.0, 5.0, top(2.45)];
        let found = around(Interpolation::Smooth);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        assert!(around(Interpolation::Linear).iter().all(|high| *high <= top(2.0)));
    }

    /// 0.117 - 0.01 is a rounding above 0.107.
    #[test]
    fn a_row_exactly_at_the_end_of_the_window_is_within() {
        let time: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.001).collect();
        for at in 20..980 {
            let values: Vec<f64> = (0..1000).map(|k| f64::from(k >= at)).collect();
            let series = Series::new(&time, &values);
            let mut window = Window::new(series, Interpolation::Linear, 0.01, 1e-12);
            // Late and early by the tolerance: the row that has changed, and the one that has not yet.
            for t in [time[at as usize - 10], time[at as usize - 1 + 10]] {
                assert_eq!(window.around(t), Some((0.0, 1.0)), "{at} at {t}");
            }
        }
    }
}
