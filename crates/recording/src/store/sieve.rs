//! Which rows of a run a time base gets.

use super::layout::Rate;
use crate::extremes::Extremes;

/// Times closer than this part of a period to its multiples are meant to be them.
const CLOSE: f64 = 1e-9;

/// Picks rows of a run for one time base.
#[derive(Debug)]
pub struct Sieve {
    rate: Rate,
    /// Columns of the row of the run that it keeps; all, in their order, if none is named.
    columns: Option<Vec<usize>>,
    /// Rows picked and not yet taken, one behind the other.
    pub picked: Vec<f64>,
    /// Rows seen.
    seen: u64,
    /// First period that has no row yet.
    period: f64,
    /// The last row, where it was not picked.
    pending: Vec<f64>,
    extremes: Extremes,
}

impl Sieve {
    /// For the columns of these signals (positions in a row, time not counted) of a run with `width` signals.
    pub fn new(rate: Rate, columns: Vec<usize>, width: usize) -> Sieve {
        let is_all = columns.iter().copied().eq(0..width);
        Sieve {
            rate,
            columns: (!is_all).then_some(columns),
            picked: Vec::new(),
            seen: 0,
            period: f64::NEG_INFINITY,
            pending: Vec::new(),
            extremes: Extremes::without_end(),
        }
    }

    /// Whether it picks all rows as they are.
    pub fn is_open(&self) -> bool {
        self.rate == Rate::All && self.columns.is_none()
    }

    /// Sees the next row: time and all values.
    pub fn see(&mut self, row: &[f64]) {
        let picks = match self.rate {
            Rate::All => true,
            Rate::Nth(n) => self.seen.is_multiple_of(u64::from(n.max(1))),
            Rate::Every(dt) => self.enters(row[0], dt),
            Rate::Extremes(dt) => {
                if self.enters(row[0], dt) {
                    self.close_window();
                }
                let value = self.columns.as_ref().map_or(row.get(1), |columns| row.get(columns[0] + 1));
                self.extremes.push(row[0], value.copied().unwrap_or(f64::NAN));
                return;
            }
        };
        self.seen += 1;
        if picks {
            self.pending.clear();
            pick(&mut self.picked, self.columns.as_deref(), row);
        } else {
            self.pending.clear();
            pick(&mut self.pending, self.columns.as_deref(), row);
        }
    }

    /// Picks what is due at the end: the last row, the last window.
    pub fn end(&mut self) {
        self.picked.append(&mut self.pending);
        self.close_window();
    }

    /// Whether this is the first row of a new period.
    fn enters(&mut self, t: f64, dt: f64) -> bool {
        let period = (t / dt + CLOSE).floor();
        let is_first = period > self.period;
        if is_first {
            self.period = period;
        }
        is_first
    }

    fn close_window(&mut self) {
        self.extremes.close();
        let kept = self.extremes.take();
        for (t, y) in kept.time.iter().zip(&kept.values) {
            self.picked.extend([t, y]);
        }
    }
}

fn pick(into: &mut Vec<f64>, columns: Option<&[usize]>, row: &[f64]) {
    match columns {
        None => into.extend(row),
        Some(columns) => {
            into.push(row[0]);
            into.extend(columns.iter().map(|&column| row[column + 1]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picked(rate: Rate, times: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut sieve = Sieve::new(rate, vec![1], 2);
        times.for_each(|t| sieve.see(&[t, 0.0, (10.0 * t).sin()]));
        sieve.end();
        sieve.picked.chunks(2).map(|row| row[0]).collect()
    }

    #[test]
    fn every_nth_row_and_the_last_are_picked() {
        assert_eq!(picked(Rate::Nth(4), (0..10).map(f64::from)), [0.0, 4.0, 8.0, 9.0]);
        assert_eq!(picked(Rate::Nth(3), (0..10).map(f64::from)), [0.0, 3.0, 6.0, 9.0]);
        assert_eq!(picked(Rate::Nth(1), (0..3).map(f64::from)), [0.0, 1.0, 2.0]);
    }

    #[test]
    fn a_period_has_its_first_row_though_its_multiples_are_rounded() {
        let times = picked(Rate::Every(0.1), (0..=1000).map(|k| f64::from(k) * 1e-3));
        assert_eq!(times.len(), 11);
        for (k, t) in times.iter().enumerate() {
            assert!((t - k as f64 * 0.1).abs() < 1e-12, "{t}");
        }
        assert_eq!(
            picked(Rate::Every(1.0), [0.0, 0.9, 2.5, 2.6, 3.0, 3.1].into_iter()),
            [0.0, 2.5, 3.0, 3.1]
        );
    }

    #[test]
    fn a_window_has_its_least_and_largest_value() {
        let mut sieve = Sieve::new(Rate::Extremes(1.0), vec![0], 1);
        for (t, y) in [(0.0, 5.0), (0.5, 7.0), (0.9, 1.0), (1.0, 3.0), (1.5, 3.0), (2.0, f64::NAN)] {
            sieve.see(&[t, y]);
        }
        sieve.end();
        assert_eq!(sieve.picked[..6], [0.5, 7.0, 0.9, 1.0, 1.0, 3.0]);
        assert!(sieve.picked[6] == 2.0 && sieve.picked[7].is_nan() && sieve.picked.len() == 8);
    }
}
