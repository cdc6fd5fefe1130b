//! Which rows of a run a time base gets.
//!
//! Two rows of one time stand around a jump. A time base that is sparser than the run has the latter alone: what holds from that time
//! on. The former belongs to the time before it, and to the window before where it stands at the end of that.

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
    /// Instants seen.
    seen: u64,
    /// First period that has no row yet.
    period: f64,
    /// The last row, of which it is not known yet whether one of the same time follows; empty before the first.
    waiting: Vec<f64>,
    /// The row before that, where it was not picked.
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
            waiting: Vec::new(),
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
        if matches!(self.rate, Rate::All | Rate::Nth(0 | 1)) {
            pick(&mut self.picked, self.columns.as_deref(), row);
            return;
        }
        if let Some(t) = self.waiting.first() {
            self.judge(*t == row[0]);
        }
        self.waiting.clear();
        pick(&mut self.waiting, self.columns.as_deref(), row);
    }

    /// Picks the row that waits, or does not; `jumps` where another one of the same time follows.
    fn judge(&mut self, jumps: bool) {
        let t = self.waiting[0];
        let picks = match self.rate {
            Rate::All => true,
            Rate::Nth(n) => {
                let is_due = self.seen.is_multiple_of(u64::from(n.max(1)));
                self.seen += u64::from(!jumps);
                is_due && !jumps
            }
            Rate::Every(dt) => !jumps && self.enters((t / dt + CLOSE).floor()),
            Rate::Extremes(dt) => {
                let before = (t / dt - CLOSE).ceil() - 1.0;
                if self.enters(if jumps { before } else { (t / dt + CLOSE).floor() }) {
                    self.close_window();
                }
                self.extremes.push(t, self.waiting.get(1).copied().unwrap_or(f64::NAN));
                return;
            }
        };
        self.pending.clear();
        let to = if picks { &mut self.picked } else { &mut self.pending };
        to.extend(&self.waiting);
    }

    /// Picks what is due at the end: the last row, the last window.
    pub fn end(&mut self) {
        if !self.waiting.is_empty() {
            self.judge(false);
            self.waiting.clear();
        }
        self.picked.append(&mut self.pending);
        self.close_window();
    }

    /// Whether this is the first row of a new period.
    fn enters(&mut self, period: f64) -> bool {
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

    /// Rows of a pulse that is 1 in the first half of each period of 0.2 s, on both sides of each jump.
    fn pulse() -> Vec<[f64; 2]> {
        let edges = (0..4).map(|k| (f64::from(k) * 0.1, f64::from(1 - k % 2)));
        let sides = |(t, to): (f64, f64)| if t == 0.0 { vec![[t, to]] } else { vec![[t, 1.0 - to], [t, to]] };
        edges.flat_map(sides).chain([[0.4, 0.0]]).collect()
    }

    #[test]
    fn where_a_signal_jumps_the_row_behind_counts() {
        for rate in [Rate::Every(0.1), Rate::Every(0.05)] {
            let mut sieve = Sieve::new(rate, vec![0], 1);
            pulse().iter().for_each(|row| sieve.see(row));
            sieve.end();
            assert_eq!(sieve.picked, [0.0, 1.0, 0.1, 0.0, 0.2, 1.0, 0.1 * 3.0, 0.0, 0.4, 0.0]);
        }
        let mut sieve = Sieve::new(Rate::Nth(2), vec![0], 1);
        pulse().iter().for_each(|row| sieve.see(row));
        sieve.end();
        assert_eq!(sieve.picked, [0.0, 1.0, 0.2, 1.0, 0.4, 0.0]);
    }

    /// The mean of a held signal from its rows.
    fn mean(rows: &[f64]) -> f64 {
        let rows: Vec<_> = rows.chunks(2).collect();
        let area = rows.windows(2).map(|pair| pair[0][1] * (pair[1][0] - pair[0][0])).sum::<f64>();
        area / (rows[rows.len() - 1][0] - rows[0][0])
    }

    #[test]
    fn windows_of_a_pulse_keep_its_mean() {
        for dt in [0.1, 0.05, 0.07] {
            let mut sieve = Sieve::new(Rate::Extremes(dt), vec![0], 1);
            pulse().iter().for_each(|row| sieve.see(row));
            sieve.end();
            assert!((mean(&sieve.picked) - 0.5).abs() < 1e-12, "{dt}: {:?}", sieve.picked);
        }
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
