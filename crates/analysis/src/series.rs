//! A signal between its values.

/// What a signal is between two of its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// On the straight line between them.
    #[default]
    Linear,
    /// The earlier one, held.
    Hold,
}

/// A signal over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Series<'a> {
    /// Times, s, finite and never falling.
    pub time: &'a [f64],
    /// As many values; what is beyond the shorter of both is left out.
    pub values: &'a [f64],
}

impl<'a> Series<'a> {
    /// A signal of these times and values.
    pub fn new(time: &'a [f64], values: &'a [f64]) -> Series<'a> {
        let rows = time.len().min(values.len());
        Series { time: &time[..rows], values: &values[..rows] }
    }

    /// First and last time; `None` without any value.
    pub fn span(&self) -> Option<(f64, f64)> {
        Some((*self.time.first()?, *self.time.last()?))
    }

    /// The values that the signal comes from and goes to at time `t`, the same but for jumps; those of its ends
    /// beyond them. `None` without any value.
    ///
    /// A held signal takes its new value `slack` early, lest rounding of times make it late by a whole sample.
    pub fn at(&self, t: f64, interpolation: Interpolation, slack: f64) -> Option<(f64, f64)> {
        let last = self.time.len().checked_sub(1)?;
        let value = |at: usize| self.values[at.min(last)];
        match interpolation {
            Interpolation::Hold => {
                let behind = self.time.partition_point(|&x| x <= t + slack);
                let held = value(behind.saturating_sub(1));
                Some((held, held))
            }
            Interpolation::Linear => {
                let from = self.time.partition_point(|&x| x < t);
                let behind = self.time.partition_point(|&x| x <= t);
                if from < behind {
                    return Some((value(from), value(behind - 1)));
                }
                if from == 0 || from > last {
                    let end = value(from);
                    return Some((end, end));
                }
                let (t0, t1) = (self.time[from - 1], self.time[from]);
                let share = (t - t0) / (t1 - t0);
                let (a, b) = (value(from - 1), value(from));
                // What does not change keeps all its bits.
                let between = if a == b { a } else { a * (1.0 - share) + b * share };
                Some((between, between))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_signal_has_both_values_of_a_jump_and_its_ends_beyond_them() {
        let series = Series::new(&[0.0, 1.0, 1.0, 3.0], &[0.0, 2.0, 5.0, 9.0]);
        let linear = |t| series.at(t, Interpolation::Linear, 0.0).unwrap();
        assert_eq!(linear(0.5), (1.0, 1.0));
        assert_eq!(linear(1.0), (2.0, 5.0));
        assert_eq!(linear(2.0), (7.0, 7.0));
        let level = std::f64::consts::FRAC_PI_2;
        let levels = [level; 2];
        let constant = Series::new(&[0.0, 0.7], &levels);
        let mut all = (0..100).map(|k| constant.at(f64::from(k) * 7e-3, Interpolation::Linear, 0.0));
        assert!(all.all(|found| found == Some((level, level))));
        assert_eq!((linear(-1.0).0, linear(4.0).0), (0.0, 9.0));
        let held = |t| series.at(t, Interpolation::Hold, 0.0).unwrap().1;
        assert_eq!([held(0.9), held(1.0), held(2.9), held(-1.0)], [0.0, 5.0, 5.0, 0.0]);
        assert_eq!(Series::new(&[], &[]).at(0.0, Interpolation::Linear, 0.0), None);
    }
}
