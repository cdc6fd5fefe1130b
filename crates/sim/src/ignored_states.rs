//! States that the error control never looks at, because all of their course lies below their absolute tolerance.
//!
//! What such a state does is left to chance: steps are chosen for the others. A state that is zero but for rounding has nothing to
//! lose, and one that is still arriving, as the far end of a chain through which something diffuses, has no size yet.

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{Instance, Schedule, Solver};
use blocksim_solve::least_absolute;

use crate::Simulation;
use crate::diagnose::number;
use crate::evaluation::evaluate::Diagram;

/// Most states that are named.
const NAMED: usize = 3;
/// Weights of a fourth difference.
const FOURTH: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
/// Distances of its points, as parts of the last step. Rounding that is a few units of one size may be alike at five points by accident;
/// hardly so at all of these.
const APART: [f64; 4] = [1.0 / 1024.0, 1.0 / 1337.0, 1.0 / 1777.0, 1.0 / 2311.0];
/// Part of a derivative that rounding may make up.
const ROUNDING: f64 = 1e-3;
/// A state that grows at least as this power of time at its largest is only arriving. Diffusion through a chain, where it is below
/// 1e-18 of what diffuses, grows as the 40th; what starts from rest under a steady load as the second to the fourth.
const ARRIVING: f64 = 10.0;

/// How large states have become.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sizes {
    /// Largest magnitude of each.
    largest: Vec<f64>,
    /// Where each began.
    first: Vec<f64>,
    /// Whether it has moved at all.
    moved: Vec<bool>,
}

impl Sizes {
    pub fn new(x: &[f64]) -> Self {
        Self { largest: x.iter().map(|x| x.abs()).collect(), first: x.to_vec(), moved: vec![false; x.len()] }
    }

    /// Begins anew where a run begins.
    pub fn begin(&mut self, x: &[f64]) {
        self.largest.iter_mut().zip(x).for_each(|(largest, x)| *largest = x.abs());
        self.first.copy_from_slice(x);
        self.moved.fill(false);
    }

    /// Takes note of an accepted step.
    pub fn note(&mut self, x: &[f64]) {
        let states = self.largest.iter_mut().zip(&self.first).zip(&mut self.moved).zip(x);
        for (((largest, first), moved), x) in states {
            *largest = largest.max(x.abs());
            *moved |= x != first;
        }
    }
}

/// A state that was never seen.
struct Ignored {
    state: usize,
    atol: f64,
    /// Whether the tolerance is its own.
    own: bool,
}

impl Simulation {
    /// A warning for states whose course lies below their absolute tolerances and is more than rounding.
    pub(crate) fn ignored_states(&mut self) -> Option<Problem> {
        let ignored = self.below_tolerance();
        if ignored.is_empty() {
            return None;
        }
        let signals = self.diagram.signals.clone();
        let mut slopes = vec![0.0; self.x.len()];
        let derived = self.diagram.minor(self.t, &self.x).and_then(|()| self.diagram.derive(&mut slopes));
        let found = self.split(ignored);
        self.diagram.failure = None;
        self.diagram.signals = signals;
        self.diagram.place(self.t, &self.x);
        let (Ok(()), Some(mut ignored)) = (derived, found) else { return None };
        ignored.retain(|ignored| {
            let (x, slope) = (self.x[ignored.state], slopes[ignored.state]);
            let arrives = x * slope > 0.0 && slope.abs() * self.t > ARRIVING * x.abs();
            !(arrives && x.abs() >= self.sizes.largest[ignored.state])
        });
        self.told(&ignored)
    }

    /// Those that have more than rounding to show: they did not begin at zero, or something moves them from there, be it one of
    /// them. `None` where the diagram cannot be evaluated.
    fn split(&mut self, ignored: Vec<Ignored>) -> Option<Vec<Ignored>> {
        let (mut real, mut zero): (Vec<Ignored>, Vec<Ignored>) =
            ignored.into_iter().partition(|ignored| self.sizes.first[ignored.state] != 0.0);
        let h = self.stepper.as_ref().map_or(0.0, |stepper| {
            let (begin, end) = stepper.last_step();
            end - begin
        });
        while !zero.is_empty() {
            let driven = driven(&mut self.diagram, (self.t, h), &self.x, &zero)?;
            let (moved, still): (Vec<Ignored>, Vec<Ignored>) =
                zero.into_iter().partition(|ignored| driven[ignored.state] != 0.0);
            if moved.is_empty() {
                break;
            }
            (real, zero) = (real.into_iter().chain(moved).collect(), still);
        }
        real.sort_by_key(|ignored| ignored.state);
        Some(real)
    }

    /// States that have moved and never been larger than what counts as nothing.
    fn below_tolerance(&self) -> Vec<Ignored> {
        let Solver::Variable { rtol, atol, .. } = self.schedule.settings.solver else { return Vec::new() };
        let Sizes { largest, moved, .. } = &self.sizes;
        let of_all = atol.unwrap_or_else(|| {
            least_absolute(rtol, largest.iter().fold(0.0, |most: f64, size| most.max(*size)))
        });
        let mut tolerances = vec![(of_all, atol.is_some()); largest.len()];
        if let Some(stepper) = self.stepper.as_ref().filter(|_| atol.is_none()) {
            let arrived = (0..largest.len()).filter(|&state| stepper.has_arrived(state));
            arrived.for_each(|state| tolerances[state] = (least_absolute(rtol, 0.0), false));
        }
        for given in &self.schedule.settings.atol {
            given.states.iter().for_each(|&state| tolerances[state] = (given.value, true));
        }
        let states = tolerances.into_iter().zip(largest).zip(moved).enumerate();
        states
            .filter(|(_, (((atol, _), size), moved))| **moved && **size > 0.0 && **size <= *atol)
            .map(|(state, (((atol, own), _), _))| Ignored { state, atol, own })
            .collect()
    }

    fn told(&self, ignored: &[Ignored]) -> Option<Problem> {
        let first = ignored.first()?;
        let names: Vec<String> =
            ignored.iter().take(NAMED).map(|ignored| name(&self.schedule, ignored.state)).collect();
        let more = match ignored.len() - names.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let listed = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let (size, atol) = (self.sizes.largest[first.state], first.atol);
        let (are, whose) = if ignored.len() > 1 { ("are", "of the first") } else { ("is", "of the state") };
        let message = format!(
            "no step was chosen for {listed}{more}, which {are} never larger than the absolute tolerance: the largest magnitude \
             {whose} was {}, its tolerance is {}",
            short(size),
            short(atol)
        );
        let smaller = short(size * 1e-6);
        let example = format!("`simulation: (atol: {{\"{}\": {smaller}}})`", names[0]);
        Some(Problem::warning("ignored_state", message).help(if first.own {
            format!("give a smaller tolerance, such as {example}, or leave it out")
        } else {
            format!("if its course matters, give it a tolerance of its own: {example}")
        }))
    }
}

/// Derivatives of the states at the end of a step of the size `h`, with the states `zero` at zero; those that are rounding are
/// zero, too. `None` where they cannot be evaluated.
///
/// Of what is smooth the fourth difference vanishes over a 256th of a step, where states differ by their last bits; what it does
/// not vanish of is rounding.
fn driven(diagram: &mut Diagram, (t, h): (f64, f64), x: &[f64], zero: &[Ignored]) -> Option<Vec<f64>> {
    let (mut at, mut dx) = (x.to_vec(), vec![0.0; x.len()]);
    let mut slopes = Vec::new();
    for (series, apart) in APART.into_iter().enumerate() {
        let (mut sum, mut difference) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        for (look, weight) in FOURTH.into_iter().enumerate() {
            blocksim_solve::shake(x, series * FOURTH.len() + look, &mut at);
            zero.iter().for_each(|zero| at[zero.state] = 0.0);
            let evaluated = diagram.minor(t - look as f64 * h * apart, &at);
            evaluated.and_then(|()| diagram.derive(&mut dx)).ok()?;
            sum.iter_mut().zip(&dx).for_each(|(sum, dx)| *sum += dx);
            difference.iter_mut().zip(&dx).for_each(|(difference, dx)| *difference += weight * dx);
        }
        let means: Vec<f64> = sum.into_iter().map(|sum| sum / FOURTH.len() as f64).collect();
        if series == 0 {
            slopes.clone_from(&means);
        }
        for ((slope, mean), difference) in slopes.iter_mut().zip(means).zip(difference) {
            if difference.abs() > ROUNDING * mean.abs() {
                *slope = 0.0;
            }
        }
    }
    Some(slopes)
}

/// Path and name of a state.
fn name(schedule: &Schedule, state: usize) -> String {
    let of_block = |block: &Instance| {
        let found = block.interface.states.get(state.checked_sub(block.x)?)?;
        Some(crate::diagnose::state_name(block, &found.name))
    };
    schedule.blocks.iter().find_map(of_block).unwrap_or_default()
}

/// Two digits are enough.
fn short(value: f64) -> String {
    if (0.01..1e4).contains(&value) {
        number((value * 100.0).round() / 100.0)
    } else {
        format!("{value:.0e}")
    }
}
