//! Least and largest value of a signal within a window that slides over it.

use std::collections::VecDeque;

use crate::series::{Interpolation, Series};

/// Slides a window of constant width over a signal; the cost is that of one pass.
pub(crate) struct Window<'a> {
    series: Series<'a>,
    interpolation: Interpolation,
    half: f64,
    slack: f64,
    /// Values that are not yet in the window begin here.
    next: usize,
    /// Positions of candidates for the least value, values rising; and for the largest, falling.
    least: VecDeque<usize>,
    largest: VecDeque<usize>,
}

impl<'a> Window<'a> {
    pub fn new(series: Series<'a>, interpolation: Interpolation, half: f64, slack: f64) -> Window<'a> {
        let (least, largest) = (VecDeque::new(), VecDeque::new());
        Window { series, interpolation, half, slack, next: 0, least, largest }
    }

    /// Least and largest value within `half` of `t`, which must not fall from call to call. Values that are not finite
    /// are left out.
    pub fn around(&mut self, t: f64) -> Option<(f64, f64)> {
        let Series { time, values } = self.series;
        while self.next < time.len() && time[self.next] <= t + self.half {
            let new = values[self.next];
            if new.is_finite() {
                while self.least.back().is_some_and(|&at| values[at] >= new) {
                    self.least.pop_back();
                }
                while self.largest.back().is_some_and(|&at| values[at] <= new) {
                    self.largest.pop_back();
                }
                self.least.push_back(self.next);
                self.largest.push_back(self.next);
            }
            self.next += 1;
        }
        for candidates in [&mut self.least, &mut self.largest] {
            while candidates.front().is_some_and(|&at| time[at] < t - self.half) {
                candidates.pop_front();
            }
        }
        // The signal at both ends of the window, between its values.
        let ends = [t - self.half, t + self.half].map(|t| self.series.at(t, self.interpolation, self.slack));
        let ends = ends.into_iter().flatten().flat_map(|(from, to)| [from, to]);
        let inside = [self.least.front(), self.largest.front()].into_iter().flatten().map(|&at| values[at]);
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
}
