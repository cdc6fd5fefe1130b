//! Newton's method for the unknowns of a loop.

use blocksim_solve::linear::{lu_factor, lu_solve};

use super::Why;
use super::elimination::LOST;
use crate::diagnose::number;

/// Corrections, as a share of a value, that count as none.
const CLOSE: f64 = 1e-12;
/// The same of what constraints seek, where they do not get smaller.
const ROUNDING: f64 = 1e-9;
/// Shares of the value of before that a value is at least taken for, of what is guessed and of what constraints seek: what becomes zero
/// has no digits of its own.
const VANISHED: [f64; 2] = [1e-12, 1e-6];
/// Share of a correction that does not serve, from which on it is found out whether anything but rounding is left.
const STUCK: f64 = 1.0 / 16.0;
/// Share by which signals are changed to see what their rounding does, and how many roundings count as none.
pub(super) const NUDGE: f64 = 1e-6;
const ROUNDINGS: f64 = 8.0;
/// Slopes are taken over a distance that changes something by this many roundings of the largest signal, if possible.
const CLEAR: f64 = 1e4;
/// Distance, as a part of the largest signal, over which the slope by an unknown that is zero is tried first.
const SMALLEST: f64 = 1e-24;
/// Most corrections.
const CORRECTIONS: usize = 50;
/// Distance, as a part of a value or from zero, at which another side is looked for first, by how much each is farther than the one before,
/// and how many there are.
const FIRST: f64 = 1e-3;
const LITTLE: f64 = 1e-30;
const FARTHER: f64 = 4.0;
const FAR: usize = 100;
/// Most halvings of an interval with a solution.
const HALVINGS: usize = 200;
/// Most times round a loop where no correction leads on.
const TIMES_ROUND: usize = 1000;
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

    /// Whether a solution that is known stays as it is, to the last digit.
    fn stays(&self) -> bool;

    /// Writes to `noise` what a change of each signal of the loop, one after the other, by its rounding makes of F, which is `f` at z;
    /// `next` is room. Returns whether F is defined there.
    fn noise(&mut self, z: &[f64], f: &mut [f64], next: &mut [f64], noise: &mut [f64]) -> bool;

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
        // What is left over.
        let rest = |i: usize, z: f64, f: f64| if i < guessed { z - f } else { -f };
        let mut largest = about.evaluate(z, f).ok_or(Why::Block)?;
        let mut keeps = false;
        let (mut side, mut passes) = (Side::Exact, 0);
        'corrections: for count in 0..CORRECTIONS {
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
            let is_known = count == 0 && sought == 0 && about.stays();
            if is_known && (0..n).all(|i| step[i].abs() <= CLOSE * z[i].abs()) {
                about.evaluate(z, f).ok_or(Why::Block)?;
                return if is_lost(slopes, sought) { Err(Why::Singular) } else { Ok(()) };
            }
            let mut share = 1.0;
            let left = loop {
                (0..n).for_each(|i| trial[i] = z[i] + share * step[i]);
                if let Some(found) = about.evaluate(trial, given) {
                    largest = found;
                    // The correction that would come next, by the slopes that are known.
                    (0..n).for_each(|i| next[i] = rest(i, trial[i], given[i]));
                    lu_solve(slopes, pivots, next);
                    let least = |i: usize| VANISHED[usize::from(i >= guessed)] * start[i].abs();
                    // By the unknowns alone: what they give may be astronomical.
                    let ahead = |i: usize| if i < guessed { (trial[i] + next[i]).abs() } else { 0.0 };
                    let left = greatest(n, |i| next[i] / trial[i].abs().max(ahead(i)).max(least(i)));
                    let within = |i: usize| trial[i].abs().max(z[i].abs());
                    let (before, after) =
                        (greatest(n, |i| step[i] / within(i)), greatest(n, |i| next[i] / within(i)));
                    let tiny = |step: &[f64]| (0..n).all(|i| step[i].abs() <= ROUNDING * within(i));
                    if left <= CLOSE || after <= (1.0 - 0.5 * share) * before {
                        keeps = share == 1.0 && after <= QUICK * before;
                        break left;
                    } else if sought > 0 && tiny(step) && tiny(next) {
                        // Nothing but rounding is left.
                        break 0.0;
                    }
                }
                // Signals of a loop have many units: what is small beside the largest may be all there is of another.
                if sought == 0 && !keeps && share == STUCK && is_rounding(guessed, z, f, next, given, about) {
                    return Ok(());
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
    /// What is tried when a search has led nowhere. If nothing serves, it is told as it was.
    #[cold]
    pub fn is_nearly_solved(&mut self, n: usize, sought: usize, about: &mut impl Given) -> bool {
        if self.is_rounding(n, sought, about) || sought == 0 && self.go_round(n, about) {
            return true;
        }
        if n != 1 || sought > 0 {
            return false;
        }
        let (z, f, tried) = (self.z[0], self.f[0], self.tried.clone());
        let is_solved = self.enclose(about) && self.search(n, sought, about).is_ok();
        if !is_solved {
            (self.z[0], self.f[0], self.tried) = (z, f, tried);
        }
        is_solved
    }

    /// Encloses a solution for a single unknown, from where a search for it began on, and goes to it by halving: corrections of
    /// what grows by powers are too short. Returns whether there is one, or a jump that looks like one.
    #[cold]
    pub fn enclose(&mut self, about: &mut impl Given) -> bool {
        let (start, mut f) = (self.start[0], [0.0]);
        let mut rest = |z: f64| about.evaluate(&[z], &mut f).map(|_| f[0] - z);
        let Some(here) = rest(start) else { return false };
        let mut ends = [Some((start, here)); 2];
        let mut distance = if start == 0.0 { LITTLE } else { FIRST * start.abs() };
        for _ in 0..FAR {
            for (end, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
                let Some((mut a, at_a)) = *end else { continue };
                let mut b = start + sign * distance;
                // Beyond where the loop is not defined there is nothing to be found. Nor where what is left over grows on the way: a solution behind
                // that is another one than the one that was followed, which has ended.
                let is_nearer = |at_b: &f64| at_b.abs() <= at_a.abs() || (*at_b > 0.0) != (at_a > 0.0);
                *end = rest(b).filter(is_nearer).map(|at_b| (b, at_b));
                if end.is_none_or(|(_, at_b)| (at_b > 0.0) == (at_a > 0.0)) {
                    continue;
                }
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (a + b);
                    if middle == a || middle == b {
                        break;
                    }
                    let Some(at) = rest(middle) else { return false };
                    if (at > 0.0) == (at_a > 0.0) { a = middle } else { b = middle }
                }
                self.z[0] = 0.5 * (a + b);
                return true;
            }
            distance *= FARTHER;
        }
        false
    }

    /// Goes round the loop, from where a search for its `n` unknowns began, until it comes back unchanged: at kinks of several unknowns no
    /// slope of one side may lead on, where a loop that contracts has its one solution all the same (S. Banach).
    #[cold]
    pub fn go_round(&mut self, n: usize, about: &mut impl Given) -> bool {
        // The search is told as it was if this fails as well.
        let Self { z: found, start, next: z, step: f, trial, given, .. } = self;
        let (z, f, trial, given) = (&mut z[..n], &mut f[..n], &mut trial[..n], &mut given[..n]);
        z.copy_from_slice(&start[..n]);
        let mut before = f64::INFINITY;
        for _ in 0..TIMES_ROUND {
            if about.evaluate(z, f).is_none() {
                return false;
            }
            let way = greatest(n, |i| f[i] - z[i]);
            let is_found = greatest(n, |i| (f[i] - z[i]) / z[i].abs().max(f[i].abs())) <= CLOSE;
            // What does not come nearer at each time contracts nowhere, and may end at another solution than the one that was followed; or
            // nothing but rounding is left.
            if is_found || way >= before {
                let is_solved = is_found || is_rounding(n, z, f, trial, given, about);
                if is_solved {
                    found[..n].copy_from_slice(z);
                }
                return is_solved;
            }
            before = way;
            z.copy_from_slice(f);
        }
        false
    }

    /// Whether what is left over at `z` is no more than rounding makes of the signals of the loop.
    pub fn is_rounding(&mut self, n: usize, sought: usize, about: &mut impl Given) -> bool {
        let Self { z, f, step: noise, next, .. } = self;
        is_rounding(n - sought, &z[..n], &mut f[..n], &mut next[..n], &mut noise[..n], about)
    }
}

/// Whether what is left over at `z`, where F is to be `f`, is no more than rounding makes of the signals of the loop; `next` and `noise` are room. If
/// so, all blocks are left with the solution.
#[cold]
fn is_rounding(
    guessed: usize,
    z: &[f64],
    f: &mut [f64],
    next: &mut [f64],
    noise: &mut [f64],
    about: &mut impl Given,
) -> bool {
    let rest = |i: usize, f: &[f64]| if i < guessed { f[i] - z[i] } else { f[i] };
    about.noise(z, f, next, noise)
        && (0..z.len()).all(|i| rest(i, f).abs() <= ROUNDINGS * noise[i])
        && about.evaluate(z, f).is_some()
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
