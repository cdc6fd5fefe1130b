//! A signal between its values.

use crate::smooth::Bend;

/// What a signal is between two of its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// On the straight line between them.
    #[default]
    Linear,
    /// On the cubic through the values around them where the signal is smooth there, on the straight line elsewhere.
    Smooth,
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

    /// How the signal is bent between row `from` and the next.
    pub(crate) fn bend(&self, from: usize) -> Bend {
        Bend::between(self.time.len(), |at| (self.time[at], self.values[at]), from)
    }

    /// The values of rows at the very time `t` between the first and the last of them.
    pub fn passed(&self, t: f64) -> &'a [f64] {
        let from = self.time.partition_point(|&x| x < t);
        let rows = self.time[from..].iter().take_while(|&&x| x == t).count();
        if rows > 2 { &self.values[from + 1..from + rows - 1] } else { &[] }
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
            Interpolation::Linear | Interpolation::Smooth => {
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
                let mut between = if a == b { a } else { a * (1.0 - share) + b * share };
                if interpolation == Interpolation::Smooth {
                    between += self.bend(from - 1).off_chord(share, t1 - t0);
                }
                Some((between, between))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_signal_goes_along_its_cubic_between_rows() {
        // Rows of a sine, eight a turn: chords are off by up to 1 - cos(pi / 8) = 0.076.
        let step = std::f64::consts::PI / 4.0;
        let time: Vec<f64> = (0..=16).map(|k| f64::from(k) * step).collect();
        let values: Vec<f64> = time.iter().map(|t| t.sin()).collect();
        let series = Series::new(&time, &values);
        let off = |interpolation| {
            // Where the bend changes its sign the chord is as near.
            let at = |k: u32| step * (2.0 + f64::from(k) / 50.0);
            let error = |t: f64| (series.at(t, interpolation, 0.0).unwrap().0 - t.sin()).abs();
            (1..50).map(|k| error(at(k))).fold(0.0, f64::max)
        };
        assert!((off(Interpolation::Linear) - 0.076).abs() < 0.01, "{}", off(Interpolation::Linear));
        assert!(off(Interpolation::Smooth) < 0.01, "{}", off(Interpolation::Smooth));
    }

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
        let smooth = |t| series.at(t, Interpolation::Smooth, 0.0).unwrap();
        assert_eq!([smooth(0.5), smooth(1.0), smooth(2.0)], [linear(0.5), linear(1.0), linear(2.0)]);
        assert_eq!((linear(-1.0).0, linear(4.0).0), (0.0, 9.0));
        let held = |t| series.at(t, Interpolation::Hold, 0.0).unwrap().1;
        assert_eq!([held(0.9), held(1.0), held(2.9), held(-1.0)], [0.0, 5.0, 5.0, 0.0]);
        assert_eq!(Series::new(&[], &[]).at(0.0, Interpolation::Linear, 0.0), None);
    }
}
