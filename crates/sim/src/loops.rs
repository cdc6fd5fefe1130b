//! Algebraic loops: blocks that need each other's outputs at the same instant.
//!
//! Some outputs are cut: their values z are guessed, the blocks of the loop are evaluated one after the other, and what they
//! give at the cuts is F(z). F(z) = z is solved by Newton's method with slopes by differences and a natural criterion for its
//! damping (P. Deuflhard: Newton Methods for Nonlinear Problems, section 3.3). The guess is the solution of the last major
//! step, so that an evaluation is a function of time and states alone. Branches of blocks, which are chosen at major steps, are
//! held while z is sought; then all choose anew, until none changes any more.

use std::ops::Range;

use blocksim_block::schedule::Schedule;
use blocksim_solve::Failed;
use blocksim_solve::linear::{lu_factor, lu_solve};

use crate::evaluate::{Diagram, outputs};
use crate::plan::Call;

/// Corrections, as a share of a value, that count as none.
const CLOSE: f64 = 1e-12;
/// The same where they do not get smaller: a share of the largest signal of the loop.
const ROUNDING: f64 = 1e-9;
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
    anchors: Range<usize>,
    /// Whether any of its blocks has branches.
    settles: bool,
}

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
    fn reason(self) -> &'static str {
        match self {
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
            Ring {
                first: found.first,
                count: found.count,
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
        let Ring { count, cells, anchors: range, .. } = &rings[ring];
        let calls: &[Call] = match pass {
            Pass::Major => &plan.major[first..first + count],
            Pass::Continuous => &plan.continuous[first..first + count],
            Pass::Minor => &plan.minor[first..first + count],
        };
        let n = cells.len();
        work.z[..n].copy_from_slice(&anchors[range.clone()]);
        let mut failed = None;
        let solved = work.solve(n, |z, f| {
            // What blocks have in their scratch space belongs to other values of the loop.
            now.evaluation += 1;
            cells.iter().zip(z).for_each(|(&cell, z)| signals[cell] = *z);
            let mut largest: f64 = 0.0;
            for (k, call) in calls.iter().enumerate() {
                outputs(call, now, signals, d, scratch);
                if now.fault.is_raised() {
                    failed = now.fault.take().map(|reason| (call.block as usize, reason));
                    return None;
                }
                touch(first + k, signals);
                largest = signals[call.unit.y.range()].iter().fold(largest, |size, y| size.max(y.abs()));
            }
            f.iter_mut().zip(cells).for_each(|(f, &cell)| *f = signals[cell]);
            f.iter().all(|f| f.is_finite()).then_some(largest)
        });
        match (solved, failed) {
            (Ok(()), _) => {
                // What the blocks give differs from it by rounding, which a large gain has made larger.
                cells.iter().zip(&work.z).for_each(|(&cell, z)| signals[cell] = *z);
                Ok(())
            }
            (Err(Why::Block), Some((block, reason))) => Err(self.blame(block, reason)),
            (Err(why), _) => Err(self.unsolved(ring, why.reason())),
        }
    }

    #[cold]
    fn unsolved(&mut self, ring: usize, reason: &str) -> Failed {
        let first = self.loops.rings[ring].first;
        let block = self.plan.major[first].block as usize;
        let failed = self.blame(block, reason.to_owned());
        self.failure.iter_mut().for_each(|failure| failure.ring = Some(ring));
        failed
    }
}

impl Work {
    /// Solves F(z) = z from `z` on; `evaluate` writes F and returns the size of the largest signal that had a part in it, or
    /// nothing if there is no value.
    fn solve(
        &mut self,
        n: usize,
        mut evaluate: impl FnMut(&[f64], &mut [f64]) -> Option<f64>,
    ) -> Result<(), Why> {
        let Self { z, f, step, next, trial, given, slopes, pivots } = self;
        let (z, f, step, next) = (&mut z[..n], &mut f[..n], &mut step[..n], &mut next[..n]);
        let (trial, given, slopes, pivots) =
            (&mut trial[..n], &mut given[..n], &mut slopes[..n * n], &mut pivots[..n]);
        let mut largest = evaluate(z, f).ok_or(Why::Block)?;
        let mut keeps = false;
        'corrections: for _ in 0..CORRECTIONS {
            if !keeps {
                differentiate(z, f, largest, trial, next, slopes, &mut evaluate)?;
                lu_factor(slopes, pivots).map_err(|_| Why::Singular)?;
                (0..n).for_each(|i| step[i] = z[i] - f[i]);
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
                    (0..n).for_each(|i| next[i] = trial[i] - given[i]);
                    lu_solve(slopes, pivots, next);
                    let size = |i: usize| trial[i].abs().max(given[i].abs());
                    let left = greatest(n, |i| next[i] / size(i));
                    let within = |i: usize| size(i).max(z[i].abs()).max(f[i].abs());
                    let (before, after) =
                        (greatest(n, |i| step[i] / within(i)), greatest(n, |i| next[i] / within(i)));
                    let tiny = |step: &[f64]| step.iter().all(|step| step.abs() <= ROUNDING * largest);
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

/// The greatest magnitude; 0/0 counts as none.
fn greatest(n: usize, part: impl Fn(usize) -> f64) -> f64 {
    (0..n)
        .map(part)
        .fold(0.0, |greatest: f64, part| if part.is_nan() { greatest } else { greatest.max(part.abs()) })
}

/// Slopes of F(z) - z, row by row.
fn differentiate(
    z: &[f64],
    f: &[f64],
    largest: f64,
    trial: &mut [f64],
    next: &mut [f64],
    slopes: &mut [f64],
    evaluate: &mut impl FnMut(&[f64], &mut [f64]) -> Option<f64>,
) -> Result<(), Why> {
    let n = z.len();
    for j in 0..n {
        let own = z[j].abs().max(f[j].abs());
        let size = if own > 0.0 {
            own
        } else if largest > 0.0 {
            largest
        } else {
            1.0
        };
        trial.copy_from_slice(z);
        trial[j] = z[j] + f64::EPSILON.sqrt() * size;
        if evaluate(trial, next).is_none() {
            trial[j] = z[j] - f64::EPSILON.sqrt() * size;
            evaluate(trial, next).ok_or(Why::Block)?;
        }
        let h = trial[j] - z[j];
        for i in 0..n {
            slopes[i * n + j] = (next[i] - f[i]) / h - f64::from(i == j);
        }
    }
    Ok(())
}
