//! How far a run is from one that is made more exactly.
//!
//! A tolerance bounds the error of a step. Where a model amplifies small differences, as stops that are hit again and again do, or adds
//! them up for long, the result of a run may be off by far more, and no step knows it. So the model is run again with a tolerance a
//! hundred times as tight (or half the step, where that is fixed), and both runs are compared at many times.

use std::collections::HashMap;
use std::sync::Arc;

use blocksim_block::schedule::{OutputTimes, Schedule, Solver};

use crate::{Control, Counts, Ended, Observer, SimError, Simulation};

/// Times at which runs are compared. No round number, so that hardly any model has events at just these times.
const POINTS: f64 = 1000.37;
/// Tolerance of the other run as part of that of the run.
const TIGHTER: f64 = 1e-2;
/// The tightest of a run that leaves room for another one.
const TIGHTEST: f64 = 1e-12;
/// Step of the other run as part of a fixed one, and maximum step as part of that of a run.
const FINER: f64 = 0.5;
/// Maximum step where none is given, as a part of the run.
const DEFAULT: f64 = 1.0 / 50.0;
/// Part of the largest range of all signals of a dimension below which a range is nothing, and of the magnitude of a signal.
const NOTHING: f64 = 1e-6;

/// What a run was compared with, and how far it is from that.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// How the other run was made.
    pub method: Solver,
    /// Times at which all recorded signals were compared.
    pub points: usize,
    /// Of each recorded signal the largest difference, the worst signal first; signals without any are left out.
    pub differences: Vec<Difference>,
    /// Number of events of the run and of the other one.
    pub events: (u64, u64),
}

/// The largest difference of one signal between two runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Its place in `Schedule::recorded`.
    pub recorded: usize,
    /// When that is, s.
    pub t: f64,
    /// How large it is, in the SI unit of the signal.
    pub amount: f64,
    /// The same as a part of the range that the signal has over the run.
    pub share: f64,
}

/// Runs a model twice, as it says and more exactly, and compares. Nothing if `go_on`, asked now and then, says no.
///
/// # Errors
/// What ends one of the runs; a relative tolerance below 1e-12, beside which nothing is more exact.
pub fn verify(
    schedule: &Schedule,
    go_on: &mut dyn FnMut() -> Control,
) -> Result<Option<Verification>, SimError> {
    let spacing = schedule.settings.stop_time / POINTS;
    let mut runs = Vec::with_capacity(2);
    if let Solver::Variable { rtol, .. } = schedule.settings.solver
        && rtol < TIGHTEST
    {
        let message = format!("rtol {rtol:e} leaves no room for a run that is more exact");
        return Err(SimError::new("settings", 0.0, message).help("verify a run at 1e-12 or more"));
    }
    let method = closer(schedule.settings.solver, schedule.settings.stop_time);
    for (solver, part) in [(schedule.settings.solver, 1.0), (method, TIGHTER)] {
        let mut schedule = schedule.clone();
        schedule.settings.solver = solver;
        schedule.settings.atol.iter_mut().for_each(|tolerance| tolerance.value *= part);
        schedule.settings.output = OutputTimes::Every(spacing);
        let mut samples = Samples::new(&schedule, spacing, go_on);
        let mut simulation = Simulation::new(Arc::new(schedule))?;
        if simulation.run(&mut samples)? == Ended::Interrupted {
            return Ok(None);
        }
        let Samples { rows, jumps, .. } = samples;
        runs.push((rows, jumps, simulation.counts().events));
    }
    let [run, other] = [&runs[0], &runs[1]];
    let differences = differences(schedule, spacing, [&run.0, &other.0], [&run.1, &other.1]);
    Ok(Some(Verification { method, points: run.0.len(), differences, events: (run.2, other.2) }))
}

/// A method of the same kind that is more exact over a run of this length.
fn closer(solver: Solver, stop: f64) -> Solver {
    match solver {
        Solver::Fixed { method, step } => Solver::Fixed { method, step: FINER * step },
        Solver::Variable { method, rtol, atol, max_step } => Solver::Variable {
            method,
            rtol: TIGHTER * rtol,
            atol: atol.map(|atol| TIGHTER * atol),
            // What long steps pass over, others of the same length may pass over as well.
            max_step: FINER * if max_step.is_finite() { max_step } else { DEFAULT * stop },
        },
    }
}

/// Smallest and largest value of a signal beside its jumps, by the point of the grid before and the signal.
type Jumps = HashMap<(usize, usize), (f64, f64)>;

/// Keeps the rows of a grid, and what lies on both sides of jumps.
struct Samples<'a> {
    spacing: f64,
    stop: f64,
    rows: Vec<Vec<f64>>,
    jumps: Jumps,
    last: (f64, Vec<f64>),
    go_on: &'a mut dyn FnMut() -> Control,
}

impl<'a> Samples<'a> {
    fn new(schedule: &Schedule, spacing: f64, go_on: &'a mut dyn FnMut() -> Control) -> Self {
        let last = (f64::NEG_INFINITY, Vec::new());
        Self {
            spacing,
            stop: schedule.settings.stop_time,
            rows: Vec::new(),
            jumps: Jumps::new(),
            last,
            go_on,
        }
    }
}

impl Observer for Samples<'_> {
    fn row(&mut self, t: f64, values: &[f64]) {
        // Of two rows at the end the later one counts.
        let at = if t >= self.stop { POINTS.ceil() } else { (t / self.spacing).round() };
        let on_grid = t >= self.stop || (t - at * self.spacing).abs() <= 1e-9 * self.spacing;
        let before = (t / self.spacing) as usize;
        if on_grid {
            self.rows.truncate(at as usize);
            self.rows.resize(at as usize, values.to_vec());
            self.rows.push(values.to_vec());
        }
        if t == self.last.0 {
            let pairs = self.last.1.iter().zip(values).enumerate();
            for (signal, (a, b)) in pairs.filter(|(_, (a, b))| a != b) {
                let ends = self.jumps.entry((before, signal)).or_insert((f64::INFINITY, f64::NEG_INFINITY));
                *ends = (ends.0.min(a.min(*b)), ends.1.max(a.max(*b)));
            }
        }
        self.last.0 = t;
        self.last.1.clear();
        self.last.1.extend_from_slice(values);
    }

    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        (self.go_on)()
    }
}

/// The largest differences of all signals that differ, the worst one first.
fn differences(
    schedule: &Schedule,
    spacing: f64,
    rows: [&Vec<Vec<f64>>; 2],
    jumps: [&Jumps; 2],
) -> Vec<Difference> {
    let signals = schedule.recorded.len();
    let points = rows[0].len().min(rows[1].len());
    let values = |signal: usize| rows.into_iter().flatten().map(move |row| row[signal]);
    let spread = |signal: usize| {
        let (low, high) = values(signal)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        (high - low, low.abs().max(high.abs()))
    };
    let spreads: Vec<(f64, f64)> = (0..signals).map(spread).collect();
    let scale = |signal: usize| {
        let same = |other: &usize| schedule.recorded[*other].dimension == schedule.recorded[signal].dimension;
        let largest = (0..signals).filter(same).map(|other| spreads[other].0).fold(0.0, f64::max);
        let (range, magnitude) = spreads[signal];
        range.max(NOTHING * largest).max(NOTHING * magnitude)
    };
    let of = |signal: usize| {
        let at = |k: usize| (k, apart(signal, k, rows, jumps));
        let (k, amount) = (0..points).map(at).max_by(|a, b| a.1.total_cmp(&b.1))?;
        let t = (k as f64 * spacing).min(schedule.settings.stop_time);
        (amount > 0.0).then(|| Difference { recorded: signal, t, amount, share: amount / scale(signal) })
    };
    let mut differences: Vec<Difference> = (0..signals).filter_map(of).collect();
    differences.sort_by(|a, b| b.share.total_cmp(&a.share));
    differences
}

/// How far a signal of the first run is from the other at a point; beside a jump, from all that the other is around it, since a
/// jump that comes a moment later is no difference.
fn apart(signal: usize, k: usize, rows: [&Vec<Vec<f64>>; 2], jumps: [&Jumps; 2]) -> f64 {
    let value = rows[0][k][signal];
    let near: Vec<(f64, f64)> = jumps
        .into_iter()
        .flat_map(|jumps| (k.saturating_sub(2)..=k + 1).filter_map(move |at| jumps.get(&(at, signal))))
        .copied()
        .collect();
    if near.is_empty() {
        return (value - rows[1][k][signal]).abs();
    }
    let around = rows[1][k.saturating_sub(1)..rows[1].len().min(k + 2)].iter();
    let ends = around.map(|row| (row[signal], row[signal])).chain(near);
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    (value - high).max(low - value).max(0.0)
}
