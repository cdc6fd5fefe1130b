//! How recorded signals change with a parameter, over time.
//!
//! The model is given with five values of the parameter. From four of them follow differences, extrapolated after Richardson, with what
//! the two distances say of their error. Where laws that are data lead from the parameter to the signals, the model is run once more
//! with its tangent: beside each block that the parameter acts on stands one that integrates the derivatives of its states by the
//! parameter (forward sensitivity analysis: A. C. Hindmarsh et al., SUNDIALS, ACM Trans. Math. Softw. 31 (2005) 363, section 2.4). Both ways
//! must agree, or differences count: a tangent knows nothing of jumps at times that depend on the parameter.

mod tangent;

use std::sync::Arc;

use blocksim_block::schedule::{OutputTimes, Schedule, Solver};

use crate::{Control, Counts, Ended, Observer, SimError, Simulation};

/// Intervals of the grid of times.
const INTERVALS: usize = 1000;
/// Relative tolerances of runs whose difference is taken, as a part of that of the model, and at most.
const TIGHTER: f64 = 1e-5;
const AT_MOST: f64 = 1e-9;
/// The tightest that is of use.
const TIGHTEST: f64 = 1e-13;
/// By how many of the errors of differences, and by which part of the largest value, a tangent may be off from them.
const ERRORS: f64 = 30.0;
const SHARE: f64 = 1e-3;

/// Distances of the values of the parameter from its own, in parts of the largest.
pub const DISTANCES: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];

/// Derivatives of recorded signals by a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Times, s.
    pub times: Vec<f64>,
    /// Of each recorded signal the derivative at each time, in the SI unit of the signal for one of the parameter.
    pub values: Vec<Vec<f64>>,
    /// How far each may be off.
    pub errors: Vec<Vec<f64>>,
    /// Why these are differences of runs and no tangent; nothing where they are one.
    pub by_differences: Option<String>,
}

/// The derivatives by a parameter of which `variants` have the values at [`DISTANCES`] times `distance` from its own, in SI. Nothing
/// if `go_on`, asked now and then, says no.
///
/// # Errors
/// What ends one of the runs; `settings` if the variants are no variants of one model.
///
/// # Panics
/// Panics if `distance` is not positive.
pub fn sensitivity(
    variants: &[Schedule; 5],
    distance: f64,
    go_on: &mut dyn FnMut() -> Control,
) -> Result<Option<Sensitivity>, SimError> {
    sensitivity_on(variants, distance, INTERVALS, go_on)
}

/// The same at the ends of so many equal intervals of the run.
///
/// # Errors
/// As [`sensitivity`].
///
/// # Panics
/// As [`sensitivity`].
pub fn sensitivity_on(
    variants: &[Schedule; 5],
    distance: f64,
    intervals: usize,
    go_on: &mut dyn FnMut() -> Control,
) -> Result<Option<Sensitivity>, SimError> {
    assert!(distance > 0.0, "the values of a parameter are apart");
    let own = &variants[2];
    let noise = tightened(&own.settings.solver).unwrap_or(f64::EPSILON);
    let paths = |schedule: &Schedule| schedule.recorded.iter().map(|r| r.path.clone()).collect::<Vec<_>>();
    let stop = |schedule: &Schedule| schedule.settings.stop_time;
    if variants.iter().any(|other| paths(other) != paths(own) || stop(other) != stop(own)) {
        let message = "the parameter changes what is recorded or how long the model runs, so that there is no derivative by it";
        return Err(SimError::new("settings", 0.0, message).help("name a number of a block"));
    }
    let mut runs = Vec::with_capacity(4);
    for number in [0, 1, 3, 4] {
        match on_grid(&variants[number], intervals, go_on)? {
            Some(rows) => runs.push(rows),
            None => return Ok(None),
        }
    }
    let length = runs.iter().map(Vec::len).min().unwrap_or(0);
    let signals = own.recorded.len();
    let (mut values, mut errors) = (vec![vec![0.0; length]; signals], vec![vec![0.0; length]; signals]);
    let mut noises = vec![0.0_f64; signals];
    for signal in 0..signals {
        for at in 0..length {
            let courses = [0, 1, 2, 3].map(|run| runs[run][at][signal]);
            let (value, error) = extrapolated(courses, distance);
            (values[signal][at], errors[signal][at]) = (value, error);
            noises[signal] =
                courses.iter().fold(noises[signal], |most, y| most.max(noise * y.abs() / distance));
        }
    }
    let times = times(stop(own), intervals, length);
    let differences = Sensitivity { times, values, errors, by_differences: None };
    let because = match tangent::with_tangent(variants, distance) {
        Err(reason) => reason,
        Ok((tangent, cells)) => match on_grid(&tangent, intervals, go_on) {
            Ok(None) => return Ok(None),
            Ok(Some(rows)) => match taken(&differences, &noises, &rows, &cells, own) {
                Ok(found) => return Ok(Some(found)),
                Err(reason) => reason,
            },
            Err(SimError { path: Some(path), message, .. }) if message.ends_with(tangent::JUMPS) => {
                format!("the law of `{path}` {}", tangent::JUMPS)
            }
            Err(error) => error.message,
        },
    };
    Ok(Some(Sensitivity { by_differences: Some(because), ..differences }))
}

/// Derivatives by the tangent alone, in one run: values that nothing stands against, for a parameter close to one for which
/// [`sensitivity_on`] has found that the tangent is right. Each signal's at all times; nothing if `go_on` says no.
///
/// # Errors
/// What ends the run, or why there is no tangent.
pub fn tangent_on(
    variants: &[Schedule; 5],
    distance: f64,
    intervals: usize,
    go_on: &mut dyn FnMut() -> Control,
) -> Result<Option<Vec<Vec<f64>>>, SimError> {
    let (tangent, cells) =
        tangent::with_tangent(variants, distance).map_err(|reason| SimError::new("settings", 0.0, reason))?;
    let Some(rows) = on_grid(&tangent, intervals, go_on)? else { return Ok(None) };
    let column = |cell: &Option<usize>| rows.iter().map(|row| cell.map_or(0.0, |cell| row[cell])).collect();
    Ok(Some(cells.iter().map(column).collect()))
}

/// What a model records, as exactly as its derivatives are taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// Times, s: the ends of equal intervals.
    pub times: Vec<f64>,
    /// Each recorded signal at these times, in SI.
    pub values: Vec<Vec<f64>>,
}

/// Runs a model and keeps what it records at the ends of so many intervals; nothing if `go_on` says no.
///
/// # Errors
/// What ends the run.
pub fn course(
    schedule: &Schedule,
    intervals: usize,
    go_on: &mut dyn FnMut() -> Control,
) -> Result<Option<Course>, SimError> {
    let Some(rows) = on_grid(schedule, intervals, go_on)? else { return Ok(None) };
    let column = |signal: usize| rows.iter().map(|row| row[signal]).collect();
    let times = times(schedule.settings.stop_time, intervals, rows.len());
    Ok(Some(Course { times, values: (0..schedule.recorded.len()).map(column).collect() }))
}

/// The times of a grid.
fn times(stop: f64, intervals: usize, length: usize) -> Vec<f64> {
    let spacing = stop / intervals as f64;
    (0..length).map(|at| (at as f64 * spacing).min(stop)).collect()
}

/// The derivative from values at -1, -1/2, 1/2 and 1 of a distance, and how far it may be off.
fn extrapolated([far_below, below, above, far_above]: [f64; 4], distance: f64) -> (f64, f64) {
    let (wide, narrow) = ((far_above - far_below) / (2.0 * distance), (above - below) / distance);
    let size = [far_below, below, above, far_above].into_iter().fold(0.0, |size: f64, y| size.max(y.abs()));
    ((4.0 * narrow - wide) / 3.0, (narrow - wide).abs().max(f64::EPSILON * size / distance))
}

/// What a tangent gives, with its difference from differences as its error, if both agree. `noises` are what the tolerance of the runs
/// may make of the difference of a signal that does not depend on the parameter, where their steps do.
fn taken(
    differences: &Sensitivity,
    noises: &[f64],
    rows: &[Vec<f64>],
    cells: &[Option<usize>],
    own: &Schedule,
) -> Result<Sensitivity, String> {
    if rows.len() < differences.times.len() {
        return Err("the run with the tangent ends earlier".to_owned());
    }
    let mut found = differences.clone();
    for (signal, cell) in cells.iter().enumerate() {
        let (values, errors) = (&mut found.values[signal], &mut found.errors[signal]);
        let largest = differences.values[signal].iter().fold(0.0, |size: f64, y| size.max(y.abs()));
        for (at, (value, error)) in values.iter_mut().zip(errors).enumerate() {
            let exact = cell.map_or(0.0, |cell| rows[at][cell]);
            let apart = (exact - *value).abs();
            let within = apart <= ERRORS * error.max(noises[signal]) + SHARE * largest;
            if !within {
                return Err(format!(
                    "the tangent of `{}` differs from differences from {} s on, as where something jumps at a time that depends on the \
                     parameter",
                    own.recorded[signal].path, differences.times[at]
                ));
            }
            // What differences leave uncertain is no error of the tangent, but all that is known of it.
            (*value, *error) = (exact, apart);
        }
    }
    Ok(found)
}

/// The relative tolerance of runs whose difference is taken; none with steps of fixed length.
fn tightened(solver: &Solver) -> Option<f64> {
    match solver {
        Solver::Variable { rtol, .. } => Some((rtol * TIGHTER).clamp(TIGHTEST, AT_MOST)),
        _ => None,
    }
}

/// Runs a model and keeps the recorded signals on the grid; nothing if `go_on` says no.
fn on_grid(
    schedule: &Schedule,
    intervals: usize,
    go_on: &mut dyn FnMut() -> Control,
) -> Result<Option<Vec<Vec<f64>>>, SimError> {
    let mut schedule = schedule.clone();
    let tight = tightened(&schedule.settings.solver);
    if let (Solver::Variable { rtol, atol, .. }, Some(tight)) = (&mut schedule.settings.solver, tight) {
        let part = tight / std::mem::replace(rtol, tight);
        atol.iter_mut().for_each(|atol| *atol *= part);
        schedule.settings.atol.iter_mut().for_each(|tolerance| tolerance.value *= part);
    }
    let stop = schedule.settings.stop_time;
    let spacing = stop / intervals as f64;
    schedule.settings.output = OutputTimes::Every(spacing);
    let mut samples = Samples { spacing, intervals, stop, rows: Vec::new(), go_on };
    let mut simulation = Simulation::new(Arc::new(schedule))?;
    let ended = simulation.run(&mut samples)?;
    Ok((ended != Ended::Interrupted).then_some(samples.rows))
}

/// Keeps the rows of a grid; of two at one time the later one.
struct Samples<'a> {
    spacing: f64,
    intervals: usize,
    stop: f64,
    rows: Vec<Vec<f64>>,
    go_on: &'a mut dyn FnMut() -> Control,
}

impl Observer for Samples<'_> {
    fn row(&mut self, t: f64, values: &[f64]) {
        let at = if t >= self.stop { self.intervals as f64 } else { (t / self.spacing).round() };
        if t >= self.stop || (t - at * self.spacing).abs() <= 1e-9 * self.spacing {
            self.rows.truncate(at as usize);
            self.rows.resize(at as usize, values.to_vec());
            self.rows.push(values.to_vec());
        }
    }

    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        (self.go_on)()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrapolation_is_of_fourth_order_and_knows_its_error() {
        let (p, h) = (0.7_f64, 1e-2);
        let y = [-1.0, -0.5, 0.5, 1.0].map(|part| (3.0 * (p + part * h)).exp());
        let (value, error) = extrapolated(y, h);
        let exact = 3.0 * (3.0 * p).exp();
        assert!(
            (value - exact).abs() < 1e-6 * exact && (value - exact).abs() < error,
            "{value} +- {error}, not {exact}"
        );
    }
}
