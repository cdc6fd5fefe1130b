//! The values of a run.

use std::ops::RangeInclusive;

use super::{Run, Source};
use crate::error::ResultsError;
use crate::extremes::Extremes;
use crate::held_signals::Unfolding;
use crate::recording::{Column, Recording, Signal};
use crate::store::Take;

/// Most rows that [`Run::read`] brings into memory.
const MOST_ROWS: u64 = 1 << 27;

/// Rows of a table in memory that are handed on at a time.
const BLOCK: usize = 1 << 16;

/// Rows of a table in memory before and behind a range that [`Run::around`] adds: as many as a curve needs.
const AROUND: usize = 8;

impl Run {
    /// A signal within a range of time, bounds included, with both values of its jumps. Reads nothing else.
    ///
    /// # Errors
    /// [`ResultsError`] where the file cannot be read, is damaged, or has more rows than fit into memory.
    pub fn read(&self, signal: usize, range: &RangeInclusive<f64>) -> Result<Column, ResultsError> {
        let base = self.base_of(signal)?;
        self.refuse_too_many(base, range, 1)?;
        let mut column = Column::default();
        self.blocks(base, &[signal], range, &mut |time, values| {
            column.time.extend(time);
            column.values.extend(&values[0]);
            Ok(())
        })?;
        Ok(column)
    }

    /// Several signals of one time base within a range of time, on common times: where one of them is held, all have a row
    /// on both sides of its jumps.
    ///
    /// # Errors
    /// As [`Run::read`], and [`ResultsError::TwoRates`] if the signals are not of one time base.
    pub fn read_together(
        &self,
        signals: &[usize],
        range: &RangeInclusive<f64>,
    ) -> Result<Recording, ResultsError> {
        let Some(&first) = signals.first() else { return Ok(Recording::default()) };
        let base = self.base_of(first)?;
        for &signal in signals {
            if self.base_of(signal)? != base {
                let [a, b] = [first, signal].map(|at| self.signals()[at].path.clone());
                return Err(ResultsError::TwoRates { path: self.path.clone(), signals: [a, b] });
            }
        }
        self.refuse_too_many(base, range, signals.len())?;
        let empty = |&at: &usize| {
            let info = &self.signals()[at];
            Signal::new(&info.path, &info.unit, info.kind)
        };
        let mut recording = Recording::new(signals.iter().map(empty).collect());
        self.blocks(base, signals, range, &mut |time, values| {
            recording.time.extend(time);
            for (signal, values) in recording.signals.iter_mut().zip(values) {
                signal.values.extend(values);
            }
            Ok(())
        })?;
        Ok(recording)
    }

    /// A signal within a range of time by about `points` of its values: all, where there are not more, else the
    /// least and the largest of each of equally long stretches of rows, at their times. Keeps `points` values in
    /// memory, however long the run is. Where there are others, values that are not finite are passed over.
    ///
    /// # Errors
    /// [`ResultsError`] where the file cannot be read or is damaged.
    pub fn overview(
        &self,
        signal: usize,
        range: &RangeInclusive<f64>,
        points: usize,
    ) -> Result<Column, ResultsError> {
        let base = self.base_of(signal)?;
        let rows = match &self.source {
            Source::Store(store) => store.rows_about(base, range),
            Source::Table { recording, .. } => {
                let before = |limit: f64| recording.time.partition_point(|&t| t < limit);
                let after = recording.time.partition_point(|&t| t <= *range.end());
                after.saturating_sub(before(*range.start())) as u64
            }
        };
        // Each row of what is held may come twice.
        let rows = if self.signals()[signal].held { 2 * rows } else { rows };
        let mut extremes = Extremes::new(rows, points);
        self.blocks(base, &[signal], range, &mut |time, values| {
            time.iter().zip(&values[0]).for_each(|(&t, &y)| extremes.push(t, y));
            Ok(())
        })?;
        Ok(extremes.finish())
    }

    /// Hands the rows of a time base within a range of time to `take`, some thousands at a time: times, and the
    /// values of each of the signals, which must be of this time base. Where one of these signals is held there is a row
    /// on both sides of each of its jumps, so that all of them may be taken to go straight from row to row.
    ///
    /// # Errors
    /// [`ResultsError`] where the file cannot be read or is damaged, and whatever `take` answers.
    pub fn blocks(
        &self,
        base: usize,
        signals: &[usize],
        range: &RangeInclusive<f64>,
        take: Take,
    ) -> Result<(), ResultsError> {
        for &signal in signals {
            self.base_of(signal)?;
        }
        let held = signals.iter().map(|&at| self.signals()[at].held).collect();
        let Some(mut unfolding) = Unfolding::new(held) else {
            return self.recorded_blocks(base, signals, range, take);
        };
        self.recorded_blocks(base, signals, range, &mut |time, values| {
            let (time, values) = unfolding.unfold(time, values);
            take(time, values)
        })
    }

    /// As [`Run::blocks`], with the rows as they were recorded.
    ///
    /// # Errors
    /// As [`Run::blocks`].
    pub fn recorded_blocks(
        &self,
        base: usize,
        signals: &[usize],
        range: &RangeInclusive<f64>,
        take: Take,
    ) -> Result<(), ResultsError> {
        match &self.source {
            Source::Store(store) => store.blocks(base, signals, range, take),
            Source::Table { recording, .. } => {
                let from = recording.time.partition_point(|&t| t < *range.start());
                let to = recording.time.partition_point(|&t| t <= *range.end()).max(from);
                for start in (from..to).step_by(BLOCK) {
                    let end = (start + BLOCK).min(to);
                    let part = |&at: &usize| recording.signals[at].values[start..end].to_vec();
                    let values: Vec<Vec<f64>> = signals.iter().map(part).collect();
                    take(&recording.time[start..end], &values)?;
                }
                Ok(())
            }
        }
    }

    /// A range of time widened so that a signal has rows before its beginning and behind its end, if there are any.
    ///
    /// # Errors
    /// [`ResultsError::NoSignal`] if there is no such signal.
    pub fn around(
        &self,
        signal: usize,
        range: &RangeInclusive<f64>,
    ) -> Result<RangeInclusive<f64>, ResultsError> {
        let base = self.base_of(signal)?;
        Ok(match &self.source {
            Source::Store(store) => store.around(base, range),
            Source::Table { recording, .. } => {
                let time = &recording.time;
                let from = time.partition_point(|t| t < range.start()).saturating_sub(AROUND);
                let to = time.partition_point(|t| t <= range.end()) + AROUND - 1;
                let from = time.get(from).map_or(*range.start(), |t| t.min(*range.start()));
                let to = time.get(to).or(time.last()).map_or(*range.end(), |t| t.max(*range.end()));
                from..=to
            }
        })
    }

    fn base_of(&self, signal: usize) -> Result<usize, ResultsError> {
        let lost = || ResultsError::NoSignal {
            path: self.path.clone(),
            signal: format!("number {signal}"),
            likely: None,
        };
        self.signals().get(signal).map(|info| info.base).ok_or_else(lost)
    }

    fn refuse_too_many(
        &self,
        base: usize,
        range: &RangeInclusive<f64>,
        signals: usize,
    ) -> Result<(), ResultsError> {
        let Source::Store(store) = &self.source else { return Ok(()) };
        let values = store.rows_about(base, range).saturating_mul(signals as u64);
        if values <= MOST_ROWS {
            return Ok(());
        }
        Err(ResultsError::TooLong { path: self.path.clone(), values })
    }
}
