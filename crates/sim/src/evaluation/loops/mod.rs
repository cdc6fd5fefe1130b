//! Algebraic loops: blocks that need each other's outputs at the same instant.
//!
//! Some outputs are cut: their values z are guessed, the blocks of the loop are evaluated one after the other, and what they
//! give at the cuts is F(z). Where the blocks record their laws, F is a program with exact slopes (`tapes.rs`). If it is affine, F(z) = z
//! is solved by elimination (`elimination.rs`), otherwise by Newton's method with a natural criterion for its damping
//! (`newton.rs`; P. Deuflhard: Newton Methods for Nonlinear Problems, section 3.3), with slopes by differences where laws do not
//! tell them. It begins with the solution of the last major step, so that an evaluation is a function of time and states alone.
//! Branches of blocks, which are chosen at major steps, are held while z is sought, as are truth values and whole numbers that are
//! cut; then all are chosen anew, until none changes any more.
//!
//! Signals of a loop may have any units, so nothing is concluded from the size of another one: either z is found to so many digits, or
//! what is left over is no more than rounding makes of the numbers that the loop reads, which is measured by changing one after the
//! other. Constraints are part of this: what their blocks write at the cuts is to become zero, instead of z.

mod elimination;
mod newton;
mod tapes;

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use blocksim_block::Scratch;
use blocksim_block::schedule::{Loop, Schedule, Step};
use blocksim_solve::Failed;

use crate::diagnose::signal_name;
use crate::evaluation::evaluate::{Diagram, Now, outputs};
use crate::program::fused::{Fused, LoopTapes};
use crate::program::plan::{Call, Settles};
use crate::program::spread::written;
use elimination::Factors;
use newton::{Given, Work};

pub(crate) use tapes::{Drafts, Form};

/// How often branches are chosen at one instant.
const ROUNDS: usize = 32;
/// Share of the largest signal of a loop below which a guard may be rounding.
const LOST: f64 = 1e-9;
/// After how many of them it is found out whether those of the last one matter.
const WAVERING: usize = 8;

/// Loops of a diagram and what their solution takes.
#[derive(Default)]
pub(crate) struct Loops {
    pub rings: Vec<Ring>,
    /// Solutions at the last major step, loop by loop.
    pub anchors: Vec<f64>,
    /// Whether this is the instant of the last major step, with its states, so that its solutions stay to the last digit. Were they to move by
    /// rounding, a guard that was just below zero where branches were chosen could begin a step just above it, and would not be seen to
    /// cross. At other times what depends on a solution must follow the smallest changes.
    pub stays: bool,
    /// Of loops that are affine.
    factors: Vec<Factors>,
    work: Work,
}

/// One loop.
pub(crate) struct Ring {
    /// First call of it in a major pass, and how many it has in any pass.
    first: usize,
    pub count: usize,
    cells: Vec<usize>,
    /// Cells of truth values and whole numbers that are cut as well.
    chosen: Vec<usize>,
    /// How many of the unknowns, the last ones, belong to constraints.
    sought: usize,
    /// Cells that its steps write.
    written: Vec<usize>,
    /// Calls, counted from the first, of groups that make outputs of what constraints have found.
    owners: Vec<usize>,
    /// All numbers that its blocks read.
    seen: Vec<Seen>,
    /// Where the last solution is, and behind it what was chosen.
    anchors: Range<usize>,
    /// Whether any of its blocks has branches.
    settles: bool,
    /// Whether the branches of the last major pass are right but for rounding, as others would be.
    wavers: bool,
}

/// A number that a loop depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    /// A cell of the signals, and behind which call of the loop it is written if within it.
    Signal(usize, Option<usize>),
    /// A continuous state.
    State(usize),
    /// A discrete state.
    Held(usize),
}

/// Most discrete states of a block that are seen: more are the memory of a delay.
const MEMORY: usize = 64;

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
    NotFinite,
    Unsettled,
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
            Why::NotFinite => "has no finite solution",
            Why::Unsettled => "does not settle: its conditions change each other without end",
        }
    }
}

impl Loops {
    pub fn new(schedule: &Schedule, fused: &Fused) -> Self {
        let mut end = 0;
        let rings = schedule.loops.iter().map(|found| {
            let start = end;
            end += found.cells.len() + found.chosen.len();
            let steps = &schedule.steps[found.first..found.first + found.count];
            let settles =
                |step: &Step| schedule.blocks[step.block as usize].interface.settles_in(step.group as usize);
            let owns = |step: &Step| {
                let constraint = &schedule.blocks[step.block as usize].interface.constraint;
                constraint.as_ref().is_some_and(|constraint| constraint.group == step.group as usize)
            };
            Ring {
                first: found.first,
                count: found.count,
                sought: found.sought,
                owners: (0..found.count).filter(|&k| owns(&steps[k])).collect(),
                seen: seen(schedule, found),
                cells: found.cells.clone(),
                chosen: found.chosen.clone(),
                written: steps.iter().flat_map(|step| written(schedule, step)).collect(),
                anchors: start..end,
                settles: steps.iter().any(settles),
                wavers: false,
            }
        });
        let rings: Vec<Ring> = rings.collect();
        let n = rings.iter().map(|ring| ring.cells.len()).max().unwrap_or(0);
        let cells = rings.iter().flat_map(|ring| ring.cells.iter().chain(&ring.chosen));
        let anchors = cells.map(|&cell| schedule.initial_signals[cell]).collect();
        let forms = fused.loops.iter().map(|tapes| tapes.as_ref().map(|tapes| tapes.form));
        let factors = forms.zip(&rings).map(|(form, ring)| match form {
            None | Some(Form::Nonlinear) => Factors::default(),
            Some(form) => Factors::new(ring.cells.len(), form == Form::Constant),
        });
        Self { factors: factors.collect(), anchors, work: Work::new(n), rings, stays: false }
    }
}

impl Diagram {
    /// Solves a loop in a major pass: its blocks choose their branches, too.
    pub(crate) fn settle_loop(&mut self, ring: usize) -> Result<(), Failed> {
        let first = self.loops.rings[ring].first;
        let most = ROUNDS + self.loops.rings[ring].chosen.len();
        self.loops.rings[ring].wavers = false;
        for round in 0..most {
            self.solve_loop(ring, Pass::Major, first, None::<fn(usize, &mut [f64])>)?;
            // Where a condition is met but for rounding, either branch leads to the other, and both to one solution.
            if round >= WAVERING && self.is_solved_by_the_last(ring) {
                self.loops.rings[ring].wavers = true;
                return self.solve_loop(ring, Pass::Major, first, None::<fn(usize, &mut [f64])>);
            }
            let Self { signals, loops: Loops { rings, anchors, work, .. }, .. } = self;
            let Ring { cells, chosen, anchors: range, settles, .. } = &rings[ring];
            let (found, held) = anchors[range.clone()].split_at_mut(cells.len());
            found.copy_from_slice(&work.z[..found.len()]);
            let mut changed = false;
            for (held, &cell) in held.iter_mut().zip(chosen) {
                changed |= *held != signals[cell];
                *held = signals[cell];
            }
            if *settles {
                changed |= self.settle_all(ring)?;
            }
            if !changed {
                return Ok(());
            }
        }
        Err(self.unsolved(ring, Why::Unsettled))
    }

    /// Whether the solution with the branches of before is one with those of now, too, but for rounding.
    #[cold]
    fn is_solved_by_the_last(&mut self, ring: usize) -> bool {
        let Self { plan, now, signals, d, scratch, loops, .. } = self;
        let Loops { rings, anchors, work, .. } = loops;
        let ring = &rings[ring];
        let n = ring.cells.len();
        let (before, held) = anchors[ring.anchors.clone()].split_at(n);
        let calls = &plan.major[ring.first..ring.first + ring.count];
        let (first, touch) = (ring.first, None::<fn(usize, &mut [f64])>);
        let chosen = ring.chosen.iter().zip(held).all(|(&cell, held)| signals[cell] == *held);
        let mut round = Round {
            ring,
            calls,
            first,
            now,
            signals,
            d,
            scratch,
            tapes: None,
            held,
            stays: false,
            touch,
            failed: None,
        };
        work.start[..n].copy_from_slice(&work.z[..n]);
        work.z[..n].copy_from_slice(before);
        let is_solved = chosen && work.is_rounding(n, ring.sought, &mut round);
        work.z[..n].copy_from_slice(&work.start[..n]);
        is_solved
    }

    /// Makes guards zero that are nothing but rounding, in loops whose branches hang on it: which branch is right is found out where they
    /// leave it.
    pub(crate) fn steady_guards(&self, guards: &mut [f64]) {
        for ring in self.loops.rings.iter().filter(|ring| ring.wavers) {
            let seen = ring.seen.iter().filter_map(|seen| match seen {
                Seen::Signal(cell, _) => Some(cell),
                _ => None,
            });
            let size = |largest: f64, cell: &usize| largest.max(self.signals[*cell].abs());
            let largest = ring.written.iter().chain(seen).fold(0.0, size);
            for call in &self.plan.major[ring.first..ring.first + ring.count] {
                let instance = &self.schedule.blocks[call.block as usize];
                let own = &mut guards[instance.g..instance.g + instance.interface.guards.len()];
                own.iter_mut().filter(|guard| guard.abs() <= LOST * largest).for_each(|guard| *guard = 0.0);
            }
        }
    }

    /// Lets the blocks of a loop choose their branches; returns whether any did anew.
    fn settle_all(&mut self, ring: usize) -> Result<bool, Failed> {
        let Ring { first, count, .. } = self.loops.rings[ring];
        let changed_before = std::mem::take(&mut self.settle.changed);
        for call in first..first + count {
            let Self { plan, now, signals, d, settle, .. } = self;
            let call = &plan.major[call];
            if call.settles != Settles::Nothing {
                let block = call.block as usize;
                settle.before(call, now, signals, d);
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
        touch: Option<impl FnMut(usize, &mut [f64])>,
    ) -> Result<(), Failed> {
        let number = ring;
        let Self { plan, now, signals, d, scratch, loops, .. } = self;
        let Loops { rings, anchors, factors, work, stays } = loops;
        let ring = &rings[number];
        let calls: &[Call] = match pass {
            Pass::Major => &plan.major[first..first + ring.count],
            Pass::Continuous => &plan.continuous[first..first + ring.count],
            Pass::Minor => &plan.minor[first..first + ring.count],
        };
        let (n, sought) = (ring.cells.len(), ring.sought);
        let (before, held) = anchors[ring.anchors.clone()].split_at(n);
        let tapes = plan.fused.loops[number].as_ref().filter(|_| touch.is_none());
        let chooses = pass == Pass::Major && touch.is_none();
        let mut round = Round {
            ring,
            calls,
            first,
            now,
            signals,
            d,
            scratch,
            tapes,
            held,
            stays: *stays,
            touch,
            failed: None,
        };
        work.z[..n].copy_from_slice(before);
        let mut solved = match tapes.map(|tapes| tapes.form) {
            Some(Form::Affine | Form::Constant) => work.eliminate(n, &mut factors[number], &mut round),
            _ => work.search(n, sought, &mut round),
        };
        if matches!(solved, Err(Why::Nowhere)) && work.is_nearly_solved(n, sought, &mut round) {
            solved = Ok(());
        }
        match (solved, round.failed.take()) {
            (Ok(()), _) => {
                // What the blocks give differs from it by rounding, which a large gain has made larger.
                ring.cells.iter().zip(&work.z).for_each(|(&cell, z)| round.signals[cell] = *z);
                if !chooses {
                    ring.chosen.iter().zip(held).for_each(|(&cell, held)| round.signals[cell] = *held);
                }
                for &k in &ring.owners {
                    outputs(&calls[k], round.now, round.signals, round.d, round.scratch);
                    round.touch.iter_mut().for_each(|touch| touch(first + k, round.signals));
                }
                Ok(())
            }
            (Err(Why::Block), Some((block, reason))) => Err(self.blame(block, reason)),
            (Err(Why::Block), None) => Err(self.unsolved(number, Why::NotFinite)),
            (Err(why), _) => Err(self.unsolved(number, why)),
        }
    }

    #[cold]
    fn unsolved(&mut self, ring: usize, why: Why) -> Failed {
        let Ring { first, cells, sought, chosen, .. } = &self.loops.rings[ring];
        let Work { z, f, .. } = &self.loops.work;
        let found = (cells.len() - sought..cells.len()).take(FEW);
        let found: Vec<String> = found.map(|i| format!("{:.4e} with f = {:.1e}", z[i], f[i])).collect();
        let nearest = if found.is_empty() {
            String::new()
        } else {
            format!(" (nearest found: z = {})", found.join(", "))
        };
        let name = |cell: usize| format!("`{}`", signal_name(&self.schedule, cell));
        let form = self.plan.fused.loops[ring].as_ref().map(|tapes| tapes.form);
        let nearest = match (&cells[..], &chosen[..]) {
            _ if *sought > 0 => nearest,
            (cells, chosen) if why == Why::Unsettled => {
                let cells = if chosen.is_empty() { cells } else { chosen };
                let names: Vec<String> = cells.iter().take(FEW).map(|cell| name(*cell)).collect();
                format!(" ({})", names.join(", "))
            }
            ([cell], _) if why == Why::Singular && matches!(form, Some(Form::Affine | Form::Constant)) => {
                self.loops.work.equation(&name(*cell)).unwrap_or_default()
            }
            ([first, ..], _) => self.loops.work.search_told(&name(*first)).unwrap_or_default(),
            ([], _) => String::new(),
        };
        let reason = why.reason(*sought > 0);
        let block = self.plan.major[*first].block as usize;
        let failed = self.blame(block, format!("{reason}{nearest}"));
        self.failure.iter_mut().for_each(|failure| failure.ring = Some(ring));
        failed
    }
}

/// One evaluation of a loop after the other.
struct Round<'a, T> {
    ring: &'a Ring,
    calls: &'a [Call],
    /// Number of the first of them in its pass.
    first: usize,
    now: &'a mut Now,
    signals: &'a mut [f64],
    d: &'a mut [f64],
    scratch: &'a mut [Scratch],
    tapes: Option<&'a LoopTapes>,
    /// What is chosen at the cuts.
    held: &'a [f64],
    stays: bool,
    touch: Option<T>,
    /// The block that could not go on, and why.
    failed: Option<(usize, String)>,
}

impl<T: FnMut(usize, &mut [f64])> Round<'_, T> {
    /// Writes unknowns, and what is chosen, where they are read.
    fn hand(&mut self, z: &[f64]) {
        let Self { ring, signals, held, .. } = self;
        let chosen = ring.chosen.iter().zip(*held);
        ring.cells.iter().zip(z).chain(chosen).for_each(|(&cell, value)| signals[cell] = *value);
    }

    /// Reads what the loop gives for its unknowns, and the size of its largest signal.
    fn read(&self, f: &mut [f64]) -> Option<f64> {
        f.iter_mut().zip(&self.ring.cells).for_each(|(f, &cell)| *f = self.signals[cell]);
        let size = |largest: f64, cell: &usize| largest.max(self.signals[*cell].abs());
        f.iter().all(|f| f.is_finite()).then(|| self.ring.written.iter().fold(0.0, size))
    }

    /// The same with one number multiplied by something close to 1.
    fn nudged(&mut self, z: &[f64], f: &mut [f64], nudged: Option<(Seen, f64)>) -> Option<f64> {
        // What blocks have in their scratch space belongs to other values of the loop.
        self.now.evaluation += 1;
        self.hand(z);
        let nudge = |behind: Option<usize>, signals: &mut [f64]| match nudged {
            Some((Seen::Signal(cell, written), by)) if written == behind && behind.is_some() => {
                signals[cell] *= by
            }
            _ => (),
        };
        let given = nudged.and_then(|(seen, by)| {
            let given = self.given(seen)?;
            // A whole discrete state may be a mode.
            let is_mode = matches!(seen, Seen::Held(_)) && given.fract() == 0.0;
            (!is_mode).then(|| (seen, std::mem::replace(given, *given * by)))
        });
        let found = self.go_round(f, nudge);
        if let Some((seen, before)) = given {
            self.given(seen).into_iter().for_each(|given| *given = before);
        }
        found
    }

    /// A number that is known before the loop is gone round.
    fn given(&mut self, seen: Seen) -> Option<&mut f64> {
        match seen {
            Seen::Signal(cell, None) => Some(&mut self.signals[cell]),
            Seen::Signal(_, Some(_)) => None,
            Seen::State(i) => Some(&mut self.now.x[i]),
            Seen::Held(i) => Some(&mut self.d[i]),
        }
    }

    /// Evaluates the blocks of the loop one after the other, with a change of signals behind each.
    fn go_round(&mut self, f: &mut [f64], change: impl Fn(Option<usize>, &mut [f64])) -> Option<f64> {
        let mut largest: f64 = 0.0;
        for (k, call) in self.calls.iter().enumerate() {
            outputs(call, self.now, self.signals, self.d, self.scratch);
            if self.now.fault.is_raised() {
                self.failed = self.now.fault.take().map(|reason| (call.block as usize, reason));
                return None;
            }
            self.touch.iter_mut().for_each(|touch| touch(self.first + k, self.signals));
            change(Some(k), self.signals);
            let written = &self.signals[call.unit.y.range()];
            largest = written.iter().fold(largest, |size, y| size.max(y.abs()));
        }
        // Of what is a program nothing is known on the way.
        let is_program = self.tapes.is_some() && self.ring.sought == 0;
        self.read(f).map(|size| if is_program { size } else { largest })
    }
}

impl<T: FnMut(usize, &mut [f64])> Given for Round<'_, T> {
    fn evaluate(&mut self, z: &[f64], f: &mut [f64]) -> Option<f64> {
        if let Some(values) = self.tapes.and_then(|tapes| tapes.values.as_ref()) {
            self.hand(z);
            if values.run(self.signals, self.d).failed.is_none() {
                // What is left over of constraints stands in the places of unknowns.
                let sought = &z[z.len() - self.ring.sought..];
                return self.read(f).map(|size| sought.iter().fold(size, |size, z| size.max(z.abs())));
            }
            // Once more, to find out which block it was.
        }
        self.nudged(z, f, None)
    }

    fn stays(&self) -> bool {
        self.stays
    }

    fn noise(&mut self, z: &[f64], f: &mut [f64], next: &mut [f64], noise: &mut [f64]) -> bool {
        let ring = self.ring;
        noise.fill(0.0);
        let share = f64::EPSILON / newton::NUDGE;
        // At a kink a change to one side alone may do nothing.
        let both = [1.0 - newton::NUDGE, 1.0 + newton::NUDGE];
        self.nudged(z, f, None).is_some()
            && ring.seen.iter().flat_map(|&seen| both.map(|by| (seen, by))).all(|nudge| {
                let is_defined = self.nudged(z, next, Some(nudge)).is_some();
                noise.iter_mut().enumerate().for_each(|(i, noise)| *noise += (next[i] - f[i]).abs() * share);
                is_defined
            })
    }

    fn slopes(&mut self, z: &[f64], rows: &mut [f64], column: &mut [f64]) -> bool {
        // Of what constraints seek the size is not known, and differences see where nothing but rounding is left.
        let Some(tapes) = self.tapes.filter(|_| self.ring.sought == 0) else { return false };
        self.hand(z);
        tapes.slopes(z.len(), self.signals, self.d, rows, column);
        true
    }
}

/// All that the blocks of a loop read. Its unknowns count as written before.
fn seen(schedule: &Schedule, found: &Loop) -> Vec<Seen> {
    let steps = &schedule.steps[found.first..found.first + found.count];
    let writer: BTreeMap<usize, usize> = steps
        .iter()
        .enumerate()
        .flat_map(|(k, step)| written(schedule, step).map(move |cell| (cell, k)))
        .filter(|(cell, _)| !found.cells.contains(cell))
        .collect();
    let read = steps.iter().flat_map(|step| schedule.blocks[step.block as usize].read(step.group as usize));
    let cells: BTreeSet<usize> = read.collect();
    let signals = cells.into_iter().map(|cell| Seen::Signal(cell, writer.get(&cell).copied()));
    let blocks: BTreeSet<usize> = steps.iter().map(|step| step.block as usize).collect();
    let states = blocks.into_iter().flat_map(|block| {
        let instance = &schedule.blocks[block];
        let (x, d) = (instance.interface.states.len(), instance.interface.discrete.len());
        let held = if d <= MEMORY { d } else { 0 };
        let states = (instance.x..instance.x + x).map(Seen::State);
        states.chain((instance.d..instance.d + held).map(Seen::Held))
    });
    signals.chain(states).collect()
}
