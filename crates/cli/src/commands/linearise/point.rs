//! The operating point: where a run has come to, or where nothing moves.

use std::sync::Arc;

use blocksim_block::schedule::Schedule;
use blocksim_linear::{DMatrix, jacobian};
use blocksim_sim::{Control, Counts, Ended, Frozen, Observer, SimError, Simulation, state_names};

use crate::running::interrupt;
use crate::terminal::format::short_time;

/// Steps of Newton's method.
const STEPS: usize = 60;
/// States are at rest when they change by less than this, relative to their size or to 1, in a second.
const REST: f64 = 1e-8;
/// Directions that move the derivatives by less than this part are left alone.
const RANK: f64 = 1e-10;
/// States that are named where there is no rest.
const NAMED: usize = 5;

/// Why there is no operating point.
#[derive(Debug)]
pub enum Lost {
    /// The simulation could not go on.
    Simulation(SimError),
    /// Ctrl-C.
    Interrupted,
    /// In words.
    Said(String),
}

impl From<SimError> for Lost {
    fn from(error: SimError) -> Lost {
        Lost::Simulation(error)
    }
}

/// Runs to an instant, s, and freezes the simulation there.
///
/// # Errors
/// [`Lost`].
pub fn at(schedule: &Arc<Schedule>, t: f64) -> Result<Frozen, Lost> {
    let mut simulation = Simulation::new(Arc::clone(schedule))?;
    match simulation.run_until(t, &mut Patient)? {
        Ended::Finished => Ok(Frozen::new(simulation, Vec::new())?),
        Ended::Interrupted => Err(Lost::Interrupted),
    }
}

/// Looks at nothing, but heeds Ctrl-C.
struct Patient;

impl Observer for Patient {
    fn row(&mut self, _t: f64, _values: &[f64]) {}

    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        if interrupt::is_requested() { Control::Stop } else { Control::Go }
    }
}

/// States near those of the instant at which all derivatives are zero, by Newton's method with the least change of states
/// (the system may leave some free, as the place of a wheel). Blocks choose their modes anew after each step. States on
/// which nothing depends, such as the angle of a shaft that turns, may move on; returns their names.
///
/// # Errors
/// [`Lost`]; the states that keep moving.
pub fn steady(mut frozen: Frozen) -> Result<(Frozen, Vec<String>), Lost> {
    let n = frozen.states().len();
    let mut x = frozen.states().to_vec();
    let mut dx = vec![0.0; n];
    let mut matters = vec![true; n];
    for _ in 0..STEPS {
        if interrupt::is_requested() {
            return Err(Lost::Interrupted);
        }
        let slopes = jacobian(&x, n, |x, dx| frozen.evaluate(x, &[], dx))?.value;
        matters = slopes.column_iter().map(|column| column.amax() > 0.0).collect();
        frozen.evaluate(&x, &[], &mut dx)?;
        let now = unrest(&x, &dx, &matters);
        if now <= REST {
            if !frozen.settle(&x)? {
                let names = state_names(frozen.simulation().schedule());
                let moves = |i: &usize| !matters[*i] && dx[*i].abs() > REST * x[*i].abs().max(1.0);
                return Ok((frozen, (0..n).filter(moves).map(|i| names[i].clone()).collect()));
            }
            continue;
        }
        let Some(step) = newton(&slopes, &x, &dx, &matters) else { break };
        // No state by more than its size, or 1, at once: beyond there may be another rest than the near one.
        let longest = step.iter().zip(&x).map(|(step, x)| step.abs() / x.abs().max(1.0)).fold(1.0, f64::max);
        // The longest part of the step that helps.
        let mut tried = vec![0.0; n];
        let better = (0..30).map(|k| 0.5_f64.powi(k) / longest).find_map(|part| {
            let next: Vec<f64> = x.iter().zip(&step).map(|(x, step)| x + part * step).collect();
            frozen.evaluate(&next, &[], &mut tried).ok()?;
            (unrest(&next, &tried, &matters) < (1.0 - 0.01 * part) * now).then_some(next)
        });
        let Some(next) = better else { break };
        x = next;
        frozen.settle(&x)?;
    }
    frozen.evaluate(&x, &[], &mut dx)?;
    Err(Lost::Said(restless(&frozen, &x, &dx, &matters)))
}

/// The largest derivative relative to the size of its state, of those that matter.
fn unrest(x: &[f64], dx: &[f64], matters: &[bool]) -> f64 {
    let all = x.iter().zip(dx).zip(matters).filter(|(_, matters)| **matters);
    all.map(|((x, dx), _)| dx.abs() / x.abs().max(1.0)).fold(0.0, f64::max)
}

/// The shortest step that Newton's method may take, sizes of states taken into account.
fn newton(slopes: &DMatrix<f64>, x: &[f64], dx: &[f64], matters: &[bool]) -> Option<Vec<f64>> {
    let n = x.len();
    let size = |i: usize| x[i].abs().max(1.0);
    let mut scaled = DMatrix::from_fn(n, n, |i, j| slopes[(i, j)] * size(j));
    let mut right = DMatrix::from_fn(n, 1, |i, _| -dx[i]);
    // Equations of like size, so that the fast states do not hide the slow ones.
    for i in 0..n {
        let largest = scaled.row(i).amax();
        if !matters[i] {
            scaled.row_mut(i).fill(0.0);
            right[(i, 0)] = 0.0;
        } else if largest > 0.0 {
            scaled.row_mut(i).scale_mut(1.0 / largest);
            right[(i, 0)] /= largest;
        }
    }
    let parts = scaled.try_svd(true, true, f64::EPSILON, 10_000)?;
    let border = RANK * parts.singular_values.max();
    let step = parts.solve(&right, border).ok()?;
    let step: Vec<f64> = step.iter().enumerate().map(|(i, step)| step * size(i)).collect();
    step.iter().all(|step| step.is_finite()).then_some(step)
}

/// That there is no rest, and what keeps moving.
fn restless(frozen: &Frozen, x: &[f64], dx: &[f64], matters: &[bool]) -> String {
    let schedule = frozen.simulation().schedule();
    let names = state_names(schedule);
    let mut moving: Vec<usize> =
        (0..x.len()).filter(|&i| matters[i] && dx[i].abs() > REST * x[i].abs().max(1.0)).collect();
    moving.sort_by(|&a, &b| dx[b].abs().total_cmp(&dx[a].abs()));
    let told: Vec<String> = moving
        .iter()
        .take(NAMED)
        .map(|&i| format!("`{}` by {} a second", names[i], short_time(dx[i])))
        .collect();
    let more = moving.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!(
        "no states were found at which nothing moves; what keeps moving: {}{more}\n  = help: integrators that nothing feeds \
         back and sources that go on have no rest; take an instant with --at, or begin elsewhere",
        told.join(", ")
    )
}
