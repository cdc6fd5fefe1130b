//! Signals of all rates on one grid of times.

use std::ops::RangeInclusive;

use blocksim_analysis::{Interpolation, Series};

use blocksim_recording::Column;
use blocksim_recording::ResultsError;
use blocksim_recording::Run;
use blocksim_recording::{Kind, Recording, Signal};

/// Most numbers of the result.
const MOST: u64 = 1 << 27;

/// Signals at the multiples of `every`, s, within a range of time and the run. Real signals follow a cubic where
/// they are smooth and are straight elsewhere, others keep their last value. Of two values at one time the later one counts;
/// before its first value a signal is NaN.
///
/// # Errors
/// As [`Run::read`], and [`ResultsError::TooLong`] if the grid is too fine for the memory.
pub fn resampled(
    run: &Run,
    signals: &[usize],
    range: &RangeInclusive<f64>,
    every: f64,
) -> Result<Run, ResultsError> {
    let (first, last) = run.span().unwrap_or((0.0, -1.0));
    let (first, last) = (first.max(*range.start()), last.min(*range.end()));
    // A point that rounding has moved over the bound is still meant.
    let (from, to) = ((first / every - 1e-9).ceil(), (last / every + 1e-9).floor());
    let count = if to >= from { (to - from) as u64 + 1 } else { 0 };
    let values = count.saturating_mul(signals.len() as u64 + 1);
    if values > MOST {
        return Err(ResultsError::TooLong { path: run.path().to_owned(), values });
    }
    let time: Vec<f64> = (0..count).map(|k| (from + k as f64) * every).collect();
    let mut result = Recording { time, signals: Vec::with_capacity(signals.len()) };
    for &at in signals {
        let column = run.read(at, &(f64::NEG_INFINITY..=f64::INFINITY))?;
        let info = &run.signals()[at];
        let values = on_grid(&column, &result.time, info.kind == Kind::Real);
        result.signals.push(Signal { values, ..Signal::new(&info.path, &info.unit, info.kind) });
    }
    Ok(Run::of_recording(result, run.path()))
}

fn on_grid(column: &Column, grid: &[f64], interpolates: bool) -> Vec<f64> {
    let series = Series::new(&column.time, &column.values);
    let between = if interpolates { Interpolation::Smooth } else { Interpolation::Hold };
    let Some((first, last)) = series.span() else { return vec![f64::NAN; grid.len()] };
    let value = |&t: &f64| {
        // A point that rounding has moved beside a value is at it.
        let tolerance = 1e-12 * t.abs().max((last - first).min(1.0));
        if t < first - tolerance {
            return f64::NAN;
        }
        let at = column.time.partition_point(|x| *x <= t + tolerance).checked_sub(1);
        match at.filter(|at| column.time[*at] >= t - tolerance) {
            Some(at) => column.values[at],
            None => series.at(t, between, 0.0).map_or(f64::NAN, |value| value.1),
        }
    };
    grid.iter().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_recording::ALWAYS;

    #[test]
    fn reals_are_interpolated_and_others_are_held() {
        let signals = [("x", Kind::Real), ("n", Kind::Int)].map(|(path, kind)| Signal::new(path, "1", kind));
        let mut recording = Recording::new(signals.to_vec());
        for (t, y) in [(0.0, 0.0), (1.0, 1.0), (1.0, 5.0), (2.0, 7.0), (2.4, 8.0)] {
            recording.push_row(t, &[y, y]).unwrap();
        }
        let run = Run::of_recording(recording, "memory".as_ref());
        let grid = resampled(&run, &[1, 0], &ALWAYS, 0.5).unwrap();
        let both = grid.read_together(&[0, 1], &ALWAYS).unwrap();
        assert_eq!(both.time, [0.0, 0.5, 1.0, 1.5, 2.0]);
        assert_eq!(both.signals[0].values, [0.0, 0.0, 5.0, 5.0, 7.0]);
        assert_eq!(both.signals[1].values, [0.0, 0.5, 5.0, 6.0, 7.0]);
        assert_eq!(grid.signals()[0].path, "n");
        let part = resampled(&run, &[0], &(0.9..=1.6), 0.5).unwrap();
        assert_eq!(part.read(0, &ALWAYS).unwrap().time, [1.0, 1.5]);
        assert_eq!(resampled(&run, &[0], &(5.0..=6.0), 0.5).unwrap().rows(0), 0);
        assert!(matches!(resampled(&run, &[0], &ALWAYS, 1e-12), Err(ResultsError::TooLong { .. })));
    }
}
