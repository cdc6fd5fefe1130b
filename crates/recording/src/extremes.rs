//! Least and largest values of stretches of a signal: what a plot needs of it.

use crate::recording::Column;

/// Collects the least and the largest value of each stretch of rows, at their times.
#[derive(Debug)]
pub struct Extremes {
    /// Rows of a stretch; 1 keeps all rows.
    stretch: u64,
    rows: u64,
    /// Least and largest value so far, each with the number of its row.
    low: Option<(f64, f64, u64)>,
    high: Option<(f64, f64, u64)>,
    /// A value that is not finite, for a stretch that has no other.
    odd: Option<(f64, f64)>,
    kept: Column,
}

impl Extremes {
    /// For a signal of so many rows, of which about `points` are to be kept.
    pub fn new(rows: u64, points: usize) -> Extremes {
        let points = points.max(2) as u64;
        let stretch = if rows <= points { 1 } else { (2 * rows).div_ceil(points) };
        Extremes { stretch, rows: 0, low: None, high: None, odd: None, kept: Column::default() }
    }

    /// For stretches that are closed from outside.
    pub fn without_end() -> Extremes {
        Extremes { stretch: u64::MAX, ..Extremes::new(0, 0) }
    }

    /// Takes the next row.
    pub fn push(&mut self, t: f64, y: f64) {
        if self.stretch == 1 {
            self.keep(t, y);
            return;
        }
        if y.is_finite() {
            if self.low.is_none_or(|(_, least, _)| y < least) {
                self.low = Some((t, y, self.rows));
            }
            if self.high.is_none_or(|(_, most, _)| y > most) {
                self.high = Some((t, y, self.rows));
            }
        } else {
            self.odd.get_or_insert((t, y));
        }
        self.rows += 1;
        if self.rows == self.stretch {
            self.close();
        }
    }

    /// What was kept.
    pub fn finish(mut self) -> Column {
        self.close();
        self.kept
    }

    /// Ends a stretch: keeps its extremes in the order in which they came.
    pub fn close(&mut self) {
        self.rows = 0;
        let odd = self.odd.take();
        match (self.low.take(), self.high.take()) {
            (Some(low), Some(high)) if low == high => self.keep(low.0, low.1),
            (Some(low), Some(high)) => {
                let (first, second) = if high.2 < low.2 { (high, low) } else { (low, high) };
                self.keep(first.0, first.1);
                self.keep(second.0, second.1);
            }
            _ => odd.into_iter().for_each(|(t, y)| self.keep(t, y)),
        }
    }

    /// What was kept since the last call.
    pub fn take(&mut self) -> Column {
        std::mem::take(&mut self.kept)
    }

    fn keep(&mut self, t: f64, y: f64) {
        self.kept.time.push(t);
        self.kept.values.push(y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_between_a_million_rows_is_kept_at_its_time() {
        let mut extremes = Extremes::new(1_000_000, 500);
        for k in 0..1_000_000_u32 {
            let t = f64::from(k) * 1e-3;
            extremes.push(t, if k == 123_456 { 7.0 } else { t.sin() });
        }
        let kept = extremes.finish();
        assert!(kept.time.len() <= 500 && kept.time.is_sorted(), "{}", kept.time.len());
        let at = kept.values.iter().position(|&y| y == 7.0).unwrap();
        assert_eq!(kept.time[at], 123.456);
    }

    #[test]
    fn a_fall_within_one_time_stays_a_fall() {
        let mut extremes = Extremes::new(8, 4);
        let rows =
            [(0.0, 1.0), (1.0, 1.0), (2.0, 3.0), (2.0, -3.0), (3.0, 0.0), (4.0, 0.0), (4.0, 2.0), (5.0, 2.0)];
        rows.iter().for_each(|&(t, y)| extremes.push(t, y));
        let kept = extremes.finish();
        assert_eq!(kept.time, [2.0, 2.0, 3.0, 4.0]);
        assert_eq!(kept.values, [3.0, -3.0, 0.0, 2.0]);
    }

    #[test]
    fn few_rows_are_kept_as_they_are() {
        let mut extremes = Extremes::new(3, 3);
        let rows = [(0.0, 1.0), (1.0, f64::NAN), (1.0, 3.0)];
        rows.iter().for_each(|&(t, y)| extremes.push(t, y));
        let kept = extremes.finish();
        assert_eq!(kept.time, [0.0, 1.0, 1.0]);
        assert!(kept.values[1].is_nan());
    }

    #[test]
    fn numbers_that_are_not_finite_stand_only_for_themselves() {
        let mut extremes = Extremes::new(40, 20);
        for k in 0..40 {
            let y = if k < 4 || k == 10 { f64::NAN } else { f64::from(k) };
            extremes.push(f64::from(k), y);
        }
        let kept = extremes.finish();
        assert_eq!((kept.time[0], kept.time[1]), (0.0, 4.0));
        assert!(kept.values[0].is_nan());
        assert_eq!(kept.values.iter().filter(|y| y.is_nan()).count(), 1);
    }
}
