//! Algebraic loops: blocks that need each other's outputs at the same instant.
//!
//! Some outputs are cut: their values z are guessed, the blocks of the loop are evaluated one after the other, and what they
//! give at the cuts is F(z). F(z) = z is solved by Newton's method with slopes by differences and a natural criterion for its
//! damping (P. Deuflhard: Newton Methods for Nonlinear Problems, section 3.3). The guess is the solution of the last major
//! step, so that an evaluation is a function of time and states alone. Branches of blocks, which are chosen at major steps, are
//! held while z is sought; then all choose anew, until none changes any more.
//!
//! Constraints are part of this: what their blocks write at the cuts is to become zero, instead of z. It may have another unit
//! than z, so nothing is concluded from its size: either z is found to so many digits, or what is left over is no more than
//! rounding makes of the signals of the loop, which is measured by changing one after the other.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use blocksim_block::schedule::{Loop, Schedule, Step};
use blocksim_solve::Failed;
use blocksim_solve::linear::{lu_factor, lu_solve};

use crate::evaluate::{Diagram, outputs};
use crate::plan::Call;
use crate::spread::written;

/// Corrections, as a share of a value, that count as none.
const CLOSE: f64 = 1e-12;
/// The same where they do not get smaller: a share of the largest signal of the loop.
const ROUNDING: f64 = 1e-9;
/// Share of the value of before that a value is at least taken for: what becomes zero has no digits of its own.
const VANISHED: f64 = 1e-6;
/// Share by which signals are changed to see what their rounding does, and how many roundings count as none.
const NUDGE: f64 = 1e-6;
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
/// How often branches are chosen at one instant.
const ROUNDS: usize = 32;

/// Loops of a diagram and what their solution takes.
#[derive(Default)]
pub(crate) struct Loops {
    pub rings: Vec<Ring>,
    /// Solutions at the last major step, loop by loop.
    pub anchors: Vec<f64>,
    work: Work,
}

/// One loop.
pub(crate) struct Ring {
    /// First call of it in a major pass, and how many it has in any pass.
    first: usize,
    pub count: usize,
    cells: Vec<usize>,
    /// How many of them, the last ones, belong to constraints.
    sought: usize,
    /// Calls, counted from the first, of groups that make outputs of what constraints have found.
    owners: Vec<usize>,
    /// Cells that its blocks read, and behind which of its calls they are written if within it; for constraints alone.
    seen: Vec<(usize, Option<usize>)>,
    anchors: Range<usize>,
    /// Whether any of its blocks has branches.
    settles: bool,
}

/// Most unknowns that are told.
const FEW: usize = 4;

/// Which list of calls is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pass {
    Major,
    Continuous,
    Minor,
}

/// Why a loop has no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Why {
    /// A block cannot go on where it begins.
    Block,
    Singular,
    Nowhere,
}

impl Why {
    fn reason(self, is_constraint: bool) -> &'static str {
        match self {
            Why::Singular if is_constraint => {
                "determines no single value: what must become zero does not change with it"
            }
            Why::Block => "a block cannot go on",
            Why::Singular => "has no single solution: what goes round comes back unchanged",
            Why::Nowhere => "has no solution that could be found",
        }
    }
}

/// Room for the largest loop.
#[derive(Default)]
struct Work {
    z: Vec<f64>,
    start: Vec<f64>,
    f: Vec<f64>,
    step: Vec<f64>,
    next: Vec<f64>,
    trial: Vec<f64>,
    given: Vec<f64>,
    slopes: Vec<f64>,
    pivots: Vec<usize>,
}

impl Loops {
    pub fn new(schedule: &Schedule) -> Self {
        let mut end = 0;
        let rings = schedule.loops.iter().map(|found| {
            let start = end;
            end += found.cells.len();
            let steps = &schedule.steps[found.first..found.first + found.count];
            let settles = |block: u32| schedule.blocks[block as usize].interface.settles;
            let owns = |step: &Step| {
                let constraint = &schedule.blocks[step.block as usize].interface.constraint;
                constraint.as_ref().is_some_and(|constraint| constraint.group == step.group as usize)
            };
            Ring {
                first: found.first,
                count: found.count,
                sought: found.sought,
                owners: (0..found.count).filter(|&k| owns(&steps[k])).collect(),
                seen: if found.sought > 0 { seen(schedule, found) } else { Vec::new() },
                cells: found.cells.clone(),
                anchors: start..end,
                settles: steps.iter().any(|step| settles(step.block)),
            }
        });
        let rings: Vec<Ring> = rings.collect();
        let n = rings.iter().map(|ring| ring.cells.len()).max().unwrap_or(0);
        let zeros = || vec![0.0; n];
        let work = Work {
            z: zeros(),
            start: zeros(),
            f: zeros(),
            step: zeros(),
            next: zeros(),
            trial: zeros(),
            given: zeros(),
            slopes: vec![0.0; n * n],
            pivots: vec![0; n],
        };
        let cells = rings.iter().flat_map(|ring| &ring.cells);
        let anchors = cells.map(|&cell| schedule.initial_signals[cell]).collect();
        Self { rings, anchors, work }
    }

    /// The loop that begins with a call of a major pass.
    pub fn at(&self, call: usize) -> Option<usize> {
        self.rings.iter().position(|ring| ring.first == call)
    }
}

impl Diagram {
    /// Solves a loop in a major pass: its blocks choose their branches, too.
    pub(crate) fn settle_loop(&mut self, ring: usize) -> Result<(), Failed> {
        let first = self.loops.rings[ring].first;
        for _ in 0..ROUNDS {
            self.solve_loop(ring, Pass::Major, first, |_, _| {})?;
            let Loops { rings, anchors, work } = &mut self.loops;
            let range = rings[ring].anchors.clone();
            let n = range.len();
            anchors[range].copy_from_slice(&work.z[..n]);
            if !rings[ring].settles || !self.settle_all(ring)? {
                return Ok(());
            }
        }
        Err(self.unsolved(ring, "changes its branches for ever"))
    }

    /// Lets the blocks of a loop choose their branches; returns whether any did anew.
    fn settle_all(&mut self, ring: usize) -> Result<bool, Failed> {
        let Ring { first, count, .. } = self.loops.rings[ring];
        let changed_before = std::mem::take(&mut self.settle.changed);
        for call in first..first + count {
            let Self { plan, now, signals, d, settle, .. } = self;
            let call = &plan.major[call];
            if call.settles {
                let block = call.block as usize;
                settle.run(block, &call.unit, now, signals, d);
                self.checked(block)?;
            }
        }
        let changed = self.settle.changed;
        self.settle.changed |= changed_before;
        Ok(changed)
    }

    /// Finds the values of a loop whose first call of a pass is `first`. Someone may change signals behind each call, whose
    /// number among those of the pass he is told.
    pub(crate) fn solve_loop(
        &mut self,
        ring: usize,
        pass: Pass,
        first: usize,
        mut touch: impl FnMut(usize, &mut [f64]),
    ) -> Result<(), Failed> {
        let Self { plan, now, signals, d, scratch, loops, .. } = self;
        let Loops { rings, anchors, work } = loops;
        let Ring { count, cells, anchors: range, sought, owners, seen, .. } = &rings[ring];
        let calls: &[Call] = match pass {
            Pass::Major => &plan.major[first..first + count],
            Pass::Continuous => &plan.continuous[first..first + count],
            Pass::Minor => &plan.minor[first..first + count],
        };
        let n = cells.len();
        work.z[..n].copy_from_slice(&anchors[range.clone()]);
        let mut failed = None;
        let mut evaluate = |z: &[f64], f: &mut [f64], nudged: Option<(usize, Option<usize>)>| {
            // What blocks have in their scratch space belongs to other values of the loop.
            now.evaluation += 1;
            cells.iter().zip(z).for_each(|(&cell, z)| signals[cell] = *z);
            let mut largest: f64 = 0.0;
            let nudge = |behind: Option<usize>, signals: &mut [f64]| {
                let hit = nudged.filter(|(_, written)| *written == behind);
                hit.into_iter().for_each(|(cell, _)| signals[cell] *= 1.0 + NUDGE);
            };
            nudge(None, signals);
            for (k, call) in calls.iter().enumerate() {
                outputs(call, now, signals, d, scratch);
                if now.fault.is_raised() {
                    failed = now.fault.take().map(|reason| (call.block as usize, reason));
                    return None;
                }
                touch(first + k, signals);
                nudge(Some(k), signals);
                largest = signals[call.unit.y.range()].iter().fold(largest, |size, y| size.max(y.abs()));
            }
            f.iter_mut().zip(cells).for_each(|(f, &cell)| *f = signals[cell]);
            if let Some((cell, None)) = nudged {
                signals[cell] /= 1.0 + NUDGE;
            }
            f.iter().all(|f| f.is_finite()).then_some(largest)
        };
        let mut solved = work.solve(n, *sought, |z, f| evaluate(z, f, None));
        if *sought > 0
            && matches!(solved, Err(Why::Nowhere))
            && work.is_rounding(n, *sought, seen, &mut evaluate)
        {
            solved = Ok(());
        }
        let is_constraint = *sought > 0;
        match (solved, failed) {
            (Ok(()), _) => {
                // What the blocks give differs from it by rounding, which a large gain has made larger.
                cells.iter().zip(&work.z).for_each(|(&cell, z)| signals[cell] = *z);
                for &k in owners {
                    outputs(&calls[k], now, signals, d, scratch);
                    touch(first + k, signals);
                }
                Ok(())
            }
            (Err(Why::Block), Some((block, reason))) => Err(self.blame(block, reason)),
            (Err(why), _) => Err(self.unsolved(ring, why.reason(is_constraint))),
        }
    }

    #[cold]
    fn unsolved(&mut self, ring: usize, reason: &str) -> Failed {
        let Ring { first, cells, sought, .. } = &self.loops.rings[ring];
        let Work { z, f, .. } = &self.loops.work;
        let found = (cells.len() - sought..cells.len()).take(FEW);
        let found: Vec<String> = found.map(|i| format!("{:.4e} with f = {:.1e}", z[i], f[i])).collect();
        let nearest = if found.is_empty() {
            String::new()
        } else {
            format!(" (nearest found: z = {})", found.join(", "))
        };
        let block = self.plan.major[*first].block as usize;
        let failed = self.blame(block, format!("{reason}{nearest}"));
        self.failure.iter_mut().for_each(|failure| failure.ring = Some(ring));
        failed
    }
}

/// Cells that the blocks of a loop read, and behind which of its calls those within it are written. Its unknowns count
/// as written before.
fn seen(schedule: &Schedule, found: &Loop) -> Vec<(usize, Option<usize>)> {
    let steps = &schedule.steps[found.first..found.first + found.count];
    let writer: BTreeMap<usize, usize> = steps
        .iter()
        .enumerate()
        .flat_map(|(k, step)| written(schedule, step).map(move |cell| (cell, k)))
        .filter(|(cell, _)| !found.cells.contains(cell))
        .collect();
    let read = steps.iter().flat_map(|step| {
        let block = &schedule.blocks[step.block as usize];
        let inputs = block.gather.iter().enumerate();
        let own = inputs.filter(|(input, _)| block.interface.reads(step.group as usize, *input));
        own.flat_map(|(_, &(from, len))| from as usize..(from + len) as usize)
    });
    let cells: BTreeSet<usize> = read.collect();
    cells.into_iter().map(|cell| (cell, writer.get(&cell).copied())).collect()
}

impl Work {
    /// Solves F(z) = z from `z` on, where of the last ones, as many as are `sought`, F is to be zero; `evaluate` writes F and
    /// returns the size of the largest signal that had a part in it, or nothing if there is no value.
    fn solve(
        &mut self,
        n: usize,
        sought: usize,
        mut evaluate: impl FnMut(&[f64], &mut [f64]) -> Option<f64>,
    ) -> Result<(), Why> {
        let Self { z, start, f, step, next, trial, given, slopes, pivots } = self;
        start[..n].copy_from_slice(&z[..n]);
        let (z, f, step, next) = (&mut z[..n], &mut f[..n], &mut step[..n], &mut next[..n]);
        let (trial, given, slopes, pivots) =
            (&mut trial[..n], &mut given[..n], &mut slopes[..n * n], &mut pivots[..n]);
        let guessed = n - sought;
        // What is left over, and how large the numbers are that it is a difference of, as far as they are of one unit.
        let rest = |i: usize, z: f64, f: f64| if i < guessed { z - f } else { -f };
        let size = |i: usize, z: f64, f: f64| if i < guessed { z.abs().max(f.abs()) } else { z.abs() };
        let mut largest = evaluate(z, f).ok_or(Why::Block)?;
        let mut keeps = false;
        'corrections: for _ in 0..CORRECTIONS {
            if !keeps {
                differentiate(z, f, guessed, largest, trial, next, slopes, &mut evaluate)?;
                lu_factor(slopes, pivots).map_err(|_| Why::Singular)?;
                (0..n).for_each(|i| step[i] = rest(i, z[i], f[i]));
                lu_solve(slopes, pivots, step);
            }
            if step.iter().any(|step| !step.is_finite()) {
                return Err(Why::Singular);
            }
            let mut share = 1.0;
            let left = loop {
                (0..n).for_each(|i| trial[i] = z[i] + share * step[i]);
                if let Some(found) = evaluate(trial, given) {
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
                    return Err(Why::Nowhere);
                }
            };
            z.copy_from_slice(trial);
            f.copy_from_slice(given);
            if left <= CLOSE {
                return Ok(());
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
    fn is_rounding(
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

/// The greatest magnitude; 0/0 counts as none.
fn greatest(n: usize, part: impl Fn(usize) -> f64) -> f64 {
    (0..n)
        .map(part)
        .fold(0.0, |greatest: f64, part| if part.is_nan() { greatest } else { greatest.max(part.abs()) })
}

/// Slopes of what is left over, row by row: F(z) - z for those that are guessed, F(z) for the others.
#[expect(clippy::too_many_arguments, reason = "room for everything is lent")]
fn differentiate(
    z: &[f64],
    f: &[f64],
    guessed: usize,
    largest: f64,
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
            trial[j] = z[j] + distance;
            if evaluate(trial, next).is_none() {
                trial[j] = z[j] - distance;
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
