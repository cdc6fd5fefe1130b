//! Rows on both sides of the jumps of held signals.
//!
//! A signal that is sampled is recorded once at each hit and keeps its value until the next. Who goes straight from row to
//! row would see a ramp, so a row is put before each jump: at its time, with the old value of what is held and the new
//! one of all else.

use crate::recording::{Recording, Signal};

/// Puts rows before jumps, block by block of a recording.
#[derive(Debug)]
pub(crate) struct Unfolding {
    held: Vec<bool>,
    /// The last row of the block before.
    last: Option<(f64, Vec<f64>)>,
    time: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl Unfolding {
    /// For signals of which some are held; `None` where none is, as nothing is to be done then.
    pub fn new(held: Vec<bool>) -> Option<Unfolding> {
        let values = vec![Vec::new(); held.len()];
        held.contains(&true).then_some(Unfolding { held, last: None, time: Vec::new(), values })
    }

    /// The rows of the next block, with those before jumps.
    pub fn unfold(&mut self, time: &[f64], values: &[Vec<f64>]) -> (&[f64], &[Vec<f64>]) {
        self.time.clear();
        self.values.iter_mut().for_each(Vec::clear);
        for row in 0..time.len() {
            if let Some((last_time, last)) = &self.last {
                let jumps = |((&held, column), &old): ((&bool, &Vec<f64>), &f64)| {
                    held && column[row].to_bits() != old.to_bits()
                };
                if time[row] > *last_time && self.held.iter().zip(values).zip(last).any(jumps) {
                    self.time.push(time[row]);
                    for (n, column) in self.values.iter_mut().enumerate() {
                        column.push(if self.held[n] { last[n] } else { values[n][row] });
                    }
                }
            }
            self.time.push(time[row]);
            self.values.iter_mut().zip(values).for_each(|(column, new)| column.push(new[row]));
            let (at, last) = self.last.get_or_insert_with(|| (0.0, vec![0.0; values.len()]));
            *at = time[row];
            last.iter_mut().zip(values).for_each(|(last, new)| *last = new[row]);
        }
        (&self.time, &self.values)
    }
}

impl Recording {
    /// The recording with rows on both sides of the jumps of those of its signals that are held; `held` has one entry for
    /// each signal.
    pub fn unfolded(self, held: Vec<bool>) -> Recording {
        let Some(mut unfolding) = Unfolding::new(held) else { return self };
        let values: Vec<Vec<f64>> = self.signals.iter().map(|signal| signal.values.clone()).collect();
        let (time, values) = unfolding.unfold(&self.time, &values);
        let signals = self.signals.into_iter().zip(values);
        Recording {
            time: time.to_vec(),
            signals: signals.map(|(signal, values)| Signal { values: values.clone(), ..signal }).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kind;

    fn recording() -> Recording {
        let signals = ["held", "moving"].map(|path| Signal::new(path, "1", Kind::Real));
        let mut recording = Recording::new(signals.to_vec());
        for (t, values) in
            [(0.0, [0.0, 0.0]), (0.5, [0.0, 1.0]), (1.0, [1.0, 2.0]), (1.5, [1.0, 3.0]), (2.0, [5.0, 4.0])]
        {
            recording.push_row(t, &values).unwrap();
        }
        recording
    }

    #[test]
    fn a_held_signal_has_a_row_before_each_jump() {
        let unfolded = recording().unfolded(vec![true, false]);
        assert_eq!(unfolded.time, [0.0, 0.5, 1.0, 1.0, 1.5, 2.0, 2.0]);
        assert_eq!(unfolded.signals[0].values, [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 5.0]);
        assert_eq!(unfolded.signals[1].values, [0.0, 1.0, 2.0, 2.0, 3.0, 4.0, 4.0]);
    }

    #[test]
    fn what_goes_on_or_has_both_rows_already_stays_as_it_is() {
        assert_eq!(recording().unfolded(vec![false, false]), recording());
        let both = recording().unfolded(vec![true, false]);
        assert_eq!(both.clone().unfolded(vec![true, false]), both);
    }

    #[test]
    fn blocks_follow_each_other_as_if_they_were_one() {
        let Recording { time, signals } = recording();
        let whole = recording().unfolded(vec![true, false]);
        for cut in 0..=time.len() {
            let mut unfolding = Unfolding::new(vec![true, false]).unwrap();
            let mut found = (Vec::new(), Vec::new());
            for range in [0..cut, cut..time.len()] {
                let values: Vec<Vec<f64>> =
                    signals.iter().map(|signal| signal.values[range.clone()].to_vec()).collect();
                let (times, columns) = unfolding.unfold(&time[range], &values);
                found.0.extend_from_slice(times);
                found.1.extend_from_slice(&columns[0]);
            }
            assert_eq!(found, (whole.time.clone(), whole.signals[0].values.clone()));
        }
    }
}
