//! The interpreter: tiny steps of fixed length by the classical Runge-Kutta method; what jumps is bracketed by bisection.
//!
//! During a step all branches stand still, so that a step sees smooth functions, apart from kinks, whose error is of the
//! second order in the step. A model is run with one length and with half of it; the difference is what the finer run may be off by.

use super::super::dice::Dice;
use super::super::puzzle::Undecided;
use super::model::{Law, Model};
use super::run::Run;

/// What came out of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The value of every node in the end.
    pub ends: Vec<f64>,
    /// By how much it may be off.
    pub end_slack: Vec<f64>,
    /// Integral of each probe.
    pub integrals: Vec<f64>,
    /// By how much it may be off.
    pub integral_slack: Vec<f64>,
    /// Largest absolute value of each probe.
    pub integral_sizes: Vec<f64>,
    /// How often the output of each node that has steps has jumped; pulses of no length not counted, and counted.
    pub toggles: Vec<Option<(u32, u32)>>,
    /// The same if what happens at nearly the same time comes in another order.
    pub others: Vec<Vec<Option<(u32, u32)>>>,
    /// Whether two things have happened at nearly the same time.
    pub crowded: bool,
    /// Largest absolute value of each node.
    pub sizes: Vec<f64>,
}

/// Steps of the coarse run at the least effort, and by how much there are more at the next.
const STEPS: usize = 8000;
const FINER: usize = 4;
/// By which part derivatives and thresholds are changed in order to see what depends on it.
const CHANGE: f64 = 1e-5;
/// By which part thresholds are changed so that what happens at the same time comes one after the other.
const JITTER: f64 = 1e-9;
/// By how much a run with a relative tolerance of 1e-6 may be off, as part of the size of a signal.
pub(super) const SLACK: f64 = 2e-4;
/// Events of one run.
pub(super) const MOST_EVENTS: usize = 2000;
/// Two instants closer than this, s, are no two.
pub(super) const SAME: f64 = 1e-9;

/// What comes out of a model.
pub fn refer(model: &Model, effort: u32, change: f64) -> Result<Outcome, Undecided> {
    let n = model.nodes.len();
    let steps = STEPS * FINER.pow(effort);
    let none = vec![0.0; n];
    let coarse = Run::new(model, steps, &none, &none).finish()?;
    let mut fine = Run::new(model, 2 * steps, &none, &none).finish()?;
    let crowded = fine.crowded || coarse.crowded;
    if fine.toggles != coarse.toggles && !crowded {
        return Err(Undecided::Coarse);
    }
    widen(&mut fine, &coarse, 1.0);
    if !fine.is_sharp(model.stop) {
        return Err(Undecided::Coarse);
    }
    if crowded {
        reorder(model, steps, &mut fine, &coarse)?;
    }
    let exact: Vec<bool> = (0..n).map(|node| is_exact(model, node, &mut vec![false; n])).collect();
    for seed in [11, 12] {
        let mut dice = Dice::new(seed);
        let mut random = || change * CHANGE * (2.0 * dice.unit() - 1.0);
        let rates: Vec<f64> = (0..n).map(|_| random()).collect();
        let off: Vec<f64> = (0..n).map(|_| random()).collect();
        // What looks at the same signal sees it off by the same.
        let shift = |node: usize| {
            let inputs = &model.nodes[node].inputs;
            let moved = inputs.iter().filter(|u| !exact[**u]).map(|&u| coarse.sizes[u]);
            let seen = model.watched(node).filter(|&u| !model.nodes[u].boolean);
            seen.map_or(0.0, |u| off[u]) * moved.fold(0.0, f64::max)
        };
        let shifts: Vec<f64> = (0..n).map(shift).collect();
        let other = Run::new(model, steps, &rates, &shifts).finish();
        let Ok(other) = other else { return Err(Undecided::Sensitive) };
        if other.toggles != coarse.toggles && !fine.others.contains(&other.toggles) {
            return Err(Undecided::Sensitive);
        }
        let mut moved = coarse.clone();
        widen(&mut moved, &other, 3.0);
        if !moved.is_sharp(model.stop) {
            return Err(Undecided::Sensitive);
        }
        fine.end_slack.iter_mut().zip(&moved.end_slack).for_each(|(a, b)| *a = a.max(*b));
        fine.integral_slack.iter_mut().zip(&moved.integral_slack).for_each(|(a, b)| *a = a.max(*b));
    }
    Ok(fine)
}

/// Lets what happens at nearly the same time come in other orders, which may change how often something jumps, but not what comes
/// out.
fn reorder(model: &Model, steps: usize, fine: &mut Outcome, coarse: &Outcome) -> Result<(), Undecided> {
    let n = model.nodes.len();
    fine.others.push(coarse.toggles.clone());
    let mut moved = coarse.clone();
    // Each the other way round as well: what comes last may have no other side by chance.
    for (seed, sign) in [(21, 1.0), (21, -1.0), (22, 1.0), (22, -1.0)] {
        let mut dice = Dice::new(seed);
        let size =
            |node: usize| model.nodes[node].inputs.iter().map(|&u| coarse.sizes[u]).fold(1e-3, f64::max);
        let mut shift = |node: usize| {
            let is_real = model.watched(node).is_some_and(|u| !model.nodes[u].boolean);
            sign * JITTER * (2.0 * dice.unit() - 1.0) * if is_real { size(node) } else { 0.0 }
        };
        let shifts: Vec<f64> = (0..n).map(&mut shift).collect();
        let other = Run::new(model, steps, &vec![0.0; n], &shifts).finish()?;
        widen(&mut moved, &other, 3.0);
        if !moved.is_sharp(model.stop) {
            return Err(Undecided::Coincides);
        }
        fine.others.push(other.toggles);
    }
    Ok(())
}

/// Adds to the slack what two runs differ by.
fn widen(outcome: &mut Outcome, other: &Outcome, factor: f64) {
    let ends = outcome.end_slack.iter_mut().zip(&outcome.ends).zip(&other.ends);
    ends.for_each(|((slack, a), b)| *slack = slack.max(factor * (a - b).abs()));
    let integrals = outcome.integral_slack.iter_mut().zip(&outcome.integrals).zip(&other.integrals);
    integrals.for_each(|((slack, a), b)| *slack = slack.max(factor * (a - b).abs()));
}

impl Outcome {
    /// Whether all is known to some tenths of a thousandth.
    fn is_sharp(&self, stop: f64) -> bool {
        let sharp = |slack: f64, size: f64| slack <= 5.0 * SLACK * (size + 1e-3);
        let mut ends = self.end_slack.iter().zip(&self.sizes);
        let mut integrals = self.integral_slack.iter().zip(&self.integral_sizes);
        ends.all(|(slack, size)| sharp(*slack, *size))
            && integrals.all(|(slack, size)| sharp(slack / stop, *size))
    }
}

/// Whether a signal depends on time and truth alone, so that no method can be off.
fn is_exact(model: &Model, node: usize, seen: &mut Vec<bool>) -> bool {
    if std::mem::replace(&mut seen[node], true) {
        return false;
    }
    let law = &model.nodes[node].law;
    let stateful = matches!(
        law,
        Law::Integrator { .. }
            | Law::LowPass { .. }
            | Law::Transfer { .. }
            | Law::Derivative { .. }
            | Law::Pid(_)
            | Law::TransportDelay { .. }
            | Law::RateLimiter { .. }
    );
    let exact = !stateful && model.nodes[node].inputs.iter().all(|&u| is_exact(model, u, seen));
    seen[node] = false;
    exact
}
