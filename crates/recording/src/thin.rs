//! Parts of a run that fit into memory.

use std::ops::RangeInclusive;

use crate::error::ResultsError;
use crate::recording::{Recording, Signal};
use crate::run::Run;

impl Run {
    /// Signals of one time base by at most about `most` numbers: all rows, or every n-th and the last; returns n as well.
    ///
    /// # Errors
    /// As [`Run::blocks`].
    pub fn thinned(
        &self,
        base: usize,
        signals: &[usize],
        range: &RangeInclusive<f64>,
        most: u64,
    ) -> Result<(Recording, u64), ResultsError> {
        let numbers = self.rows(base).saturating_mul(signals.len() as u64 + 1);
        let n = numbers.div_ceil(most.max(1)).max(1);
        let empty = |&at: &usize| self.signals().get(at).map(|s| Signal::new(&s.path, &s.unit, s.kind));
        let mut recording = Recording::new(signals.iter().filter_map(empty).collect());
        let mut seen = 0;
        let mut last: Option<(f64, Vec<f64>)> = None;
        self.blocks(base, signals, range, &mut |time, values| {
            for (at, &t) in time.iter().enumerate() {
                if seen % n == 0 {
                    last = None;
                    recording.time.push(t);
                    for (signal, values) in recording.signals.iter_mut().zip(values) {
                        signal.values.push(values[at]);
                    }
                } else if at + 1 == time.len() {
                    last = Some((t, values.iter().map(|values| values[at]).collect()));
                }
                seen += 1;
            }
            Ok(())
        })?;
        if let Some((t, values)) = last {
            recording.time.push(t);
            recording.signals.iter_mut().zip(values).for_each(|(signal, value)| signal.values.push(value));
        }
        Ok((recording, n))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ALWAYS, Kind};

    #[test]
    fn every_nth_row_and_the_last_are_kept() {
        let mut recording = Recording::new(vec![Signal::new("a", "m", Kind::Real)]);
        (0..100_000).for_each(|k| recording.push_row(f64::from(k), &[-f64::from(k)]).unwrap());
        let run = Run::of_recording(recording.clone(), "memory".as_ref());
        let (all, n) = run.thinned(0, &[0], &ALWAYS, 1 << 20).unwrap();
        assert_eq!((all, n), (recording, 1));
        let (thin, n) = run.thinned(0, &[0], &ALWAYS, 1000).unwrap();
        assert_eq!((n, thin.rows()), (200, 501));
        assert_eq!((thin.time[1], thin.signals[0].values.last()), (200.0, Some(&-99_999.0)));
    }
}
