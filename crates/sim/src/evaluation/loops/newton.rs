//! Newton's method for the unknowns of a loop.

use blocksim_solve::linear::{lu_factor, lu_solve};

use super::Why;
use super::elimination::LOST;
use crate::diagnose::number;

/// Corrections, as a share of a value, that count as none.
const CLOSE: f64 = 1e-12;
/// The same where they do not get smaller: a share of the largest signal of the loop.
const ROUNDING: f64 = 1e-9;
/// Share of the value of before that a value is at least taken for: what becomes zero has no digits of its own.
const VANISHED: f64 = 1e-6;
/// Share by which signals are changed to see what their rounding does, and how many roundings count as none.
pub(super) const NUDGE: f64 = 1e-6;
const ROUNDINGS: f64 = 16.0;
/// Slopes are taken over a distance that changes something by this many roundings of the largest signal, if possible.
const CLEAR: f64 = 1e4;
/// Distance, as a part of the largest signal, over which the slope by an unknown that is zero is tried first.
const SMALLEST: f64 = 1e-24;
/// Most corrections.
const CORRECTIONS: usize = 50;
/// Least share of a correction that is tried.
const LEAST: f64 = 1e-6;
/// A correction this much smaller than the one before keeps the slopes.
const QUICK: f64 = 1e-2;
/// How often a point with singular slopes is left by a step of the loop itself.
const PASSES: usize = 3;
/// Iterates that are kept for who asks how a search has failed.
const KEPT: usize = 4;

/// What a search for the unknowns of a loop asks.
pub(super) trait Given {
    /// Writes F(z); returns the size of the largest signal that had a part in it, or `None` where F is not defined.
    fn evaluate(&mut self, z: &[f64], f: &mut [f64]) -> Option<f64>;

    /// Writes the slopes of F at z, row by row; `column` is room for one of them. Returns whether they are known.
    fn slopes(&mut self, z: &[f64], rows: &mut [f64], column: &mut [f64]) -> bool;
}

/// Room for the largest loop.
#[derive(Default)]
pub(super) struct Work {
    pub z: Vec<f64>,
    pub start: Vec<f64>,
    pub f: Vec<f64>,
    pub step: Vec<f64>,
    pub next: Vec<f64>,
    trial: Vec<f64>,
    given: Vec<f64>,
    pub slopes: Vec<f64>,
    /// The last values of the first unknown.
    pub tried: Vec<f64>,
    pivots: Vec<usize>,
}

/// A number in few digits.
fn short(value: f64) -> String {
    number(format!("{value:.4e}").parse().unwrap_or(value))
}

impl Work {
    /// Room for `n` unknowns.
    pub fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            z: zeros(),
            start: zeros(),
            f: zeros(),
            step: zeros(),
            next: zeros(),
            trial: zeros(),
            given: zeros(),
            slopes: vec![0.0; n * n],
            pivots: vec![0; n],
            tried: Vec::with_capacity(KEPT),
        }
    }

    fn keep(tried: &mut Vec<f64>, z: f64) {
        if tried.last() == Some(&z) {
            return;
        }
        if tried.len() == KEPT {
            tried.rotate_left(1);
            tried.pop();
        }
        tried.push(z);
    }

    /// The equation of a single unknown, as it was found before it was to be solved.
    pub fn equation(&self, name: &str) -> Option<String> {
        let (slope, rest) = (number(*self.slopes.first()?), short(*self.f.first()?));
        Some(format!(", as it asks for {name} = {slope} * {name} + {rest}"))
    }

    /// Where a search for the first unknown has led, for messages.
    pub fn search_told(&self, name: &str) -> Option<String> {
        let tried: Vec<String> = self.tried.iter().map(|z| short(*z)).collect();
        let given = short(*self.f.first()?);
        match &tried[..] {
            [] => None,
            [only] => Some(format!("; for {name} = {only} it gives {given}")),
            [before @ .., last] => {
                let before = before.join(", ");
                Some(format!("; it was tried with {name} = {before} and {last}, for which it gives {given}"))
            }
        }
    }
}

impl Work {
    /// Solves F(z) = z from `z` on, where of the last ones, as many as are `sought`, F is to be zero.
    pub fn search(&mut self, n: usize, sought: usize, about: &mut impl Given) -> Result<(), Why> {
        let Self { z, start, f, step, next, trial, given, slopes, pivots, tried } = self;
        tried.clear();
        start[..n].copy_from_slice(&z[..n]);
        let (z, f, step, next) = (&mut z[..n], &mut f[..n], &mut step[..n], &mut next[..n]);
        let (trial, given, slopes, pivots) =
            (&mut trial[..n], &mut given[..n], &mut slopes[..n * n], &mut pivots[..n]);
        let guessed = n - sought;
        // What is left over, and how large the numbers are that it is a difference of, as far as they are of one unit.
        let rest = |i: usize, z: f64, f: f64| if i < guessed { z - f } else { -f };
        let size = |i: usize, z: f64, f: f64| if i < guessed { z.abs().max(f.abs()) } else { z.abs() };
        let mut largest = about.evaluate(z, f).ok_or(Why::Block)?;
        let mut keeps = false;
        let (mut side, mut passes) = (Side::Exact, 0);
        'corrections: for _ in 0..CORRECTIONS {
            if n > 0 {
                Self::keep(tried, z[0]);
            }
            if !keeps {
                let is_exact = side == Side::Exact
                    && about.slopes(z, slopes, next)
                    && slopes.iter().all(|slope| slope.is_finite());
                if is_exact {
                    (0..guessed).for_each(|i| slopes[i * n + i] -= 1.0);
                } else {
                    let way = |j: usize| side.way(step[j]);
                    let mut evaluate = |z: &[f64], f: &mut [f64]| about.evaluate(z, f);
                    differentiate(z, f, guessed, largest, way, trial, next, slopes, &mut evaluate)?;
                }
                if lu_factor(slopes, pivots).is_err() {
                    // One step of the loop itself leads away from there.
                    let moved = sought == 0 && (0..n).any(|i| f[i] != z[i]);
                    if !moved || passes == PASSES {
                        return Err(Why::Singular);
                    }
                    passes += 1;
                    z.copy_from_slice(f);
                    largest = about.evaluate(z, f).ok_or(Why::Block)?;
                    continue 'corrections;
                }
                (0..n).for_each(|i| step[i] = rest(i, z[i], f[i]));
                lu_solve(slopes, pivots, step);
            }
            if step.iter().any(|step| !step.is_finite()) {
                return Err(Why::Singular);
            }
            let mut share = 1.0;
            let left = loop {
                (0..n).for_each(|i| trial[i] = z[i] + share * step[i]);
                if let Some(found) = about.evaluate(trial, given) {
                    largest = found;
                    // The correction that would come next, by the slopes that are known.
                    (0..n).for_each(|i| next[i] = rest(i, trial[i], given[i]));
                    lu_solve(slopes, pivots, next);
                    let least = |i: usize| if i < guessed { 0.0 } else { VANISHED * start[i].abs() };
                    let left = greatest(n, |i| next[i] / size(i, trial[i], given[i]).max(least(i)));
                    let within = |i: usize| size(i, trial[i], given[i]).max(size(i, z[i], f[i]));
                    let (before, after) =
                        (greatest(n, |i| step[i] / within(i)), greatest(n, |i| next[i] / within(i)));
                    let scale = |i: usize| if sought == 0 { largest } else { within(i) };
                    let tiny = |step: &[f64]| (0..n).all(|i| step[i].abs() <= ROUNDING * scale(i));
                    if left <= CLOSE || after <= (1.0 - 0.5 * share) * before {
                        keeps = share == 1.0 && after <= QUICK * before;
                        break left;
                    } else if tiny(step) && tiny(next) {
                        // Nothing but rounding is left.
                        break 0.0;
                    }
                }
                share *= 0.5;
                if keeps {
                    // Slopes of before do not serve here.
                    keeps = false;
                    continue 'corrections;
                }
                if share < LEAST {
                    // At a kink the slopes of another side may lead on.
                    side = side.next().filter(|_| sought == 0).ok_or(Why::Nowhere)?;
                    continue 'corrections;
                }
            };
            side = Side::Exact;
            z.copy_from_slice(trial);
            f.copy_from_slice(given);
            if left <= CLOSE {
                return if is_lost(slopes, sought) { Err(Why::Singular) } else { Ok(()) };
            }
            if keeps {
                step.copy_from_slice(next);
            }
        }
        Err(Why::Nowhere)
    }
}

impl Work {
    /// Whether what is left over at `z` is no more than rounding makes of the signals of the loop. Changes each of them by a
    /// small share to see.
    #[cold]
    pub fn is_rounding(
        &mut self,
        n: usize,
        sought: usize,
        seen: &[(usize, Option<usize>)],
        evaluate: &mut impl FnMut(&[f64], &mut [f64], Option<(usize, Option<usize>)>) -> Option<f64>,
    ) -> bool {
        let Self { z, f, step: noise, next, .. } = self;
        let (z, f, noise, next) = (&z[..n], &mut f[..n], &mut noise[..n], &mut next[..n]);
        if evaluate(z, f, None).is_none() {
            return false;
        }
        noise.fill(0.0);
        for &cell in seen {
            if evaluate(z, next, Some(cell)).is_none() {
                return false;
            }
            (0..n).for_each(|i| noise[i] += (next[i] - f[i]).abs() * (f64::EPSILON / NUDGE));
        }
        let rest = |i: usize| if i < n - sought { f[i] - z[i] } else { f[i] };
        let found = (0..n).all(|i| rest(i).abs() <= ROUNDINGS * noise[i]);
        // All blocks are left with the solution.
        evaluate(z, f, None).is_some() && found
    }
}

/// Whether the solution of a single unknown hangs on rounding: of its slopes on both sides little is left.
fn is_lost(slopes: &[f64], sought: usize) -> bool {
    match slopes {
        [left] if sought == 0 => left.abs() * LOST < (1.0 + (1.0 + left).abs()) * f64::EPSILON,
        _ => false,
    }
}

/// The greatest magnitude; 0/0 counts as none.
fn greatest(n: usize, part: impl Fn(usize) -> f64) -> f64 {
    (0..n)
        .map(part)
        .fold(0.0, |greatest: f64, part| if part.is_nan() { greatest } else { greatest.max(part.abs()) })
}

/// Where slopes are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// At the point itself, or a little above it where they are not known.
    Exact,
    /// On the side to which the last correction was to lead.
    Along,
    /// On the other one.
    Against,
}

impl Side {
    /// The side to be tried next.
    fn next(self) -> Option<Self> {
        match self {
            Side::Exact => Some(Side::Along),
            Side::Along => Some(Side::Against),
            Side::Against => None,
        }
    }

    /// The sign of distances, where a correction was to lead by `step`.
    fn way(self, step: f64) -> f64 {
        let along = if step < 0.0 { -1.0 } else { 1.0 };
        match self {
            Side::Exact => 1.0,
            Side::Along => along,
            Side::Against => -along,
        }
    }
}

/// Slopes of what is left over, row by row: F(z) - z for those that are guessed, F(z) for the others.
#[expect(clippy::too_many_arguments, reason = "room for everything is lent")]
fn differentiate(
    z: &[f64],
    f: &[f64],
    guessed: usize,
    largest: f64,
    way: impl Fn(usize) -> f64,
    trial: &mut [f64],
    next: &mut [f64],
    slopes: &mut [f64],
    evaluate: &mut impl FnMut(&[f64], &mut [f64]) -> Option<f64>,
) -> Result<(), Why> {
    let n = z.len();
    let shortest = f64::EPSILON.sqrt();
    for j in 0..n {
        let own = if j < guessed { z[j].abs().max(f[j].abs()) } else { z[j].abs() };
        let most = if largest > 0.0 { largest } else { 1.0 };
        let mut distance = match own {
            own if own > 0.0 => shortest * own,
            _ if j < guessed => shortest * most,
            // Nothing is known of its size.
            _ => SMALLEST * most,
        };
        loop {
            trial.copy_from_slice(z);
            trial[j] = z[j] + way(j) * distance;
            if evaluate(trial, next).is_none() {
                trial[j] = z[j] - way(j) * distance;
                evaluate(trial, next).ok_or(Why::Block)?;
            }
            // Close to zero a share of a value moves nothing that could be told from rounding.
            let moved = (0..n).any(|i| (next[i] - f[i]).abs() > CLEAR * f64::EPSILON * largest);
            if j < guessed || moved || distance >= shortest * most {
                break;
            }
            distance = (1e3 * distance).min(shortest * most);
        }
        let h = trial[j] - z[j];
        for i in 0..n {
            slopes[i * n + j] = (next[i] - f[i]) / h - f64::from(i == j && i < guessed);
        }
    }
    Ok(())
}
