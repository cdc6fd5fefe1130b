//! A memory of the past of a signal as exact as the method that made it, in a fixed number of cells.
//!
//! Steps are kept as polynomials of degree four between their ends. Where something jumped, in the signal or in a derivative
//! of it, there is a *break*: on each side another polynomial holds, and what reads the past must be made to stop there.

use blocksim_block::Resolution;
use blocksim_block::prelude::*;
use blocksim_block::{NODES, derivatives, through};

/// Breaks up to a jump of this derivative are stopped at. A method of order five does not feel those of higher ones.
const HIGHEST: f64 = 3.0;

/// Jumps of a signal below this share of its size come from rounding.
const ROUNDING: f64 = 1e-9;

/// A derivative jumps if it changes by more than this part of what it is or usually is within a piece, and by more than what
/// rounding of values, as a part of them, makes of it.
const CLEAR: f64 = 0.02;
const NOISE: f64 = 1e-10;

/// Discrete states before the pieces: next piece to write, number of pieces in use, time up to which breaks have been
/// passed, time of the last break.
const HEAD: usize = 0;
const COUNT: usize = 1;
const PASSED: usize = 2;
const LAST: usize = 3;
const PIECES: usize = 4;

/// Cells of a piece before its values: begin, end, and which derivative jumps at its begin (`NO_BREAK` if none).
const BEGIN: usize = 0;
const END: usize = 1;
const LEVEL: usize = 2;
const VALUES: usize = 3;
const NO_BREAK: f64 = -1.0;

/// Before any time.
const NEVER: f64 = f64::MIN;

/// Names and initial values of the discrete states of a history of `n` elements with room for so many pieces.
pub(crate) fn states(interface: Interface, n: usize, pieces: usize) -> Result<Interface, InterfaceError> {
    InterfaceError::memory_fits(pieces.checked_mul(cells(n)), &format!("{pieces} steps of {n} elements"))?;
    Ok(interface
        .discrete("head", 0.0)
        .discrete("count", 0.0)
        .discrete("passed", NEVER)
        .discrete("last", NEVER)
        .memory("past", pieces * cells(n), 0.0))
}

/// Most pieces that a block may ask for.
pub(crate) const MOST_PIECES: usize = 500_000;

/// Cells that a piece takes.
fn cells(n: usize) -> usize {
    VALUES + NODES.len() * n
}

/// Times that differ by less are the same: a time event is hit within that.
pub(crate) fn same(resolution: Resolution, t: f64) -> f64 {
    2.0 * resolution.same(t)
}

/// A view of discrete states as the past of a signal of `n` elements.
#[derive(Clone, Copy)]
pub(crate) struct History<'a> {
    d: &'a [f64],
    n: usize,
}

impl<'a> History<'a> {
    pub(crate) fn new(d: &'a [f64], n: usize) -> Self {
        Self { d, n }
    }

    fn room(&self) -> usize {
        (self.d.len() - PIECES) / cells(self.n)
    }

    fn count(&self) -> usize {
        self.d[COUNT] as usize
    }

    /// Place in `d` of the `age`-th piece, oldest first.
    fn place(&self, age: usize) -> usize {
        let room = self.room();
        PIECES + (self.d[HEAD] as usize + room - self.count() + age) % room * cells(self.n)
    }

    fn begin(&self, age: usize) -> f64 {
        self.d[self.place(age) + BEGIN]
    }

    fn end(&self, age: usize) -> f64 {
        self.d[self.place(age) + END]
    }

    fn level(&self, age: usize) -> f64 {
        self.d[self.place(age) + LEVEL]
    }

    /// Whether something jumps at the begin of a piece.
    fn is_break(&self, age: usize) -> bool {
        self.level(age) != NO_BREAK
    }

    fn passed(&self) -> f64 {
        self.d[PASSED]
    }

    /// How many pieces begin at or before `s`.
    fn begun(&self, s: f64) -> usize {
        let (mut low, mut high) = (0, self.count());
        while low < high {
            let middle = (low + high) / 2;
            if self.begin(middle) <= s { low = middle + 1 } else { high = middle }
        }
        low
    }

    /// The breaks between which the signal may be read now: the last one that has been passed and the next one.
    pub(crate) fn window(&self) -> (f64, f64) {
        let passed = self.begun(self.passed());
        let before = (0..passed).rev().find(|age| self.is_break(*age));
        (before.map_or(NEVER, |age| self.begin(age)), self.next(|_| true))
    }

    /// The first break that has not been passed of a level that is wanted; infinity without one.
    fn next(&self, wanted: impl Fn(f64) -> bool) -> f64 {
        if self.d[LAST] <= self.passed() {
            return f64::INFINITY;
        }
        let ahead = self.begun(self.passed())..self.count();
        let found = ahead.into_iter().find(|&age| self.is_break(age) && wanted(self.level(age)));
        found.map_or(f64::INFINITY, |age| self.begin(age))
    }

    /// When the signal jumps for the first time behind what has been passed, s; its start counts as a jump.
    pub(crate) fn next_jump(&self) -> f64 {
        self.next(|level| level == 0.0)
    }

    /// When a derivative of the signal jumps for the first time behind what has been passed, s.
    pub(crate) fn next_kink(&self) -> f64 {
        self.next(|level| level > 0.0)
    }

    /// The signal at `s`, on the side of breaks that has been reached; false if that is before the start.
    pub(crate) fn read(&self, s: f64, y: &mut [f64]) -> bool {
        let (count, passed) = (self.count(), self.passed());
        let mut begun = self.begun(s);
        while begun < count && self.is_break(begun) && self.begin(begun) <= passed {
            begun += 1;
        }
        while begun > 0 && self.is_break(begun - 1) && self.begin(begun - 1) > passed {
            begun -= 1;
        }
        let Some(age) = begun.checked_sub(1) else { return false };
        let place = self.place(age);
        let (begin, end) = (self.d[place + BEGIN], self.d[place + END]);
        let share = ((s - begin) / (end - begin)).clamp(0.0, 1.0);
        let values = &self.d[place + VALUES..];
        for (i, y) in y.iter_mut().enumerate() {
            *y = through(std::array::from_fn(|node| values[node * self.n + i]), share);
        }
        true
    }

    /// Which derivative jumps at the begin of a fresh piece. Why it is fresh is not known, so both pieces have to show it: it may
    /// be for something that this signal does not depend on. Were that taken for a break, each break of one history that
    /// comes out would be one of every other history, and so on for ever. But where a break came out of this history at that
    /// time, that is the reason, and what came out has been integrated once on its way, unless both pieces show that it has
    /// not: it may come back without (equations of neutral type).
    fn level_of(&self, c: &Context, piece: &Piece, told: Told) -> f64 {
        let Told { n, initial, delay, .. } = told;
        let first = &piece.node(0)[..n];
        let jumps = |(new, old): (&f64, f64)| (new - old).abs() > ROUNDING * new.abs().max(old.abs());
        let Some(newest) = self.count().checked_sub(1) else {
            return if first.iter().any(|&new| jumps((&new, initial))) { 0.0 } else { 1.0 };
        };
        let last = self.place(newest) + VALUES + (NODES.len() - 1) * self.n;
        if first.iter().zip(self.d[last..last + self.n].iter().copied()).any(jumps) {
            return 0.0;
        }
        let came = piece.begin - delay;
        let near = |&age: &usize| {
            self.is_break(age) && (self.begin(age) - came).abs() <= 2.0 * same(c.resolution, piece.begin)
        };
        let begun = self.begun(came);
        match (begun.saturating_sub(2)..self.count().min(begun + 2)).find(near) {
            None => self.jumping(piece, newest, 2.0, 0.0).unwrap_or(NO_BREAK),
            Some(age) => match self.jumping(piece, newest, self.level(age), NOISE) {
                Some(level) => level,
                None if self.level(age) < HIGHEST => self.level(age) + 1.0,
                None => NO_BREAK,
            },
        }
    }

    /// The lowest derivative, up to `highest` and the second, that differs between the end of the newest piece and the begin of
    /// a fresh one. Values are taken to be good to the part `noise` where the first derivative is concerned: pieces may be too
    /// short to show it.
    fn jumping(&self, piece: &Piece, newest: usize, highest: f64, noise: f64) -> Option<f64> {
        let place = self.place(newest);
        let lengths = [self.d[place + END] - self.d[place + BEGIN], piece.end - piece.begin];
        let jumps = |element: usize, order: usize| {
            let old = std::array::from_fn(|node| self.d[place + VALUES + node * self.n + element]);
            let new = std::array::from_fn(|node| piece.node(node)[element]);
            let sizes = [old, new].map(|values: [f64; NODES.len()]| {
                let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (v.min(a), v.max(b)));
                (high - low, low.abs().max(high.abs()))
            });
            let power = order as i32;
            let [a, b] = [derivatives(old, true), derivatives(new, false)];
            let [a, b] = [a[order - 1] / lengths[0].powi(power), b[order - 1] / lengths[1].powi(power)];
            let usual = (0..2).map(|k| sizes[k].0 / lengths[k].powi(power)).fold(0.0, f64::max);
            let noise = if order == 1 { noise } else { NOISE };
            let noise = noise * sizes[0].1.max(sizes[1].1) / lengths[0].min(lengths[1]).powi(power);
            (a - b).abs() > CLEAR * a.abs().max(b.abs()).max(usual) + noise
        };
        let orders = (1..=2).filter(|order| f64::from(*order) <= highest);
        let found =
            orders.into_iter().find(|order| (0..self.n).any(|element| jumps(element, *order as usize)));
        found.map(f64::from)
    }
}

/// How a history is told.
#[derive(Clone, Copy)]
pub(crate) struct Told {
    /// Number of elements of the signal, which is the first input.
    pub n: usize,
    /// What was before the first piece.
    pub initial: f64,
    /// How old what is read at the end of the piece is, s.
    pub delay: f64,
    /// How old anything that will be read can be, s.
    pub longest: f64,
}

/// Makes the past what it would be had the signal `u` always been what it is; nothing older than `longest`, s, will be read.
pub(crate) fn rest(t: f64, u: &[f64], longest: f64, d: &mut [f64]) {
    d[PIECES + BEGIN] = t - 2.0 * longest;
    d[PIECES + END] = t;
    d[PIECES + LEVEL] = NO_BREAK;
    let values = d[PIECES + VALUES..PIECES + cells(u.len())].chunks_exact_mut(u.len());
    values.for_each(|values| values.copy_from_slice(u));
    (d[HEAD], d[COUNT], d[PASSED], d[LAST]) = (1.0, 1.0, NEVER, NEVER);
}

/// Notes a piece.
pub(crate) fn note(c: &Context, d: &mut [f64], piece: &Piece, told: Told) {
    let Told { n, longest, .. } = told;
    let history = History::new(d, n);
    let (room, count) = (history.room(), history.count());
    // What is read may be a little older than it should be, for rounding.
    if count == room && history.end(0) > piece.end - longest - same(c.resolution, piece.end) {
        c.fail(format!(
            "its history has room for {room} steps, but there are more within its delay of {longest} s; a larger `buffer` \
             has room for them"
        ));
        return;
    }
    let level = if piece.is_fresh { history.level_of(c, piece, told) } else { NO_BREAK };
    let place = PIECES + d[HEAD] as usize * cells(n);
    d[place + BEGIN] = piece.begin;
    d[place + END] = piece.end;
    d[place + LEVEL] = level;
    for (node, values) in d[place + VALUES..place + cells(n)].chunks_exact_mut(n).enumerate() {
        values.copy_from_slice(&piece.node(node)[..n]);
    }
    d[HEAD] = ((d[HEAD] as usize + 1) % room) as f64;
    d[COUNT] = (count + 1).min(room) as f64;
    if level != NO_BREAK {
        d[LAST] = piece.begin;
    }
}

/// Notes that what is read has come to the present less the delay.
pub(crate) fn pass(c: &Context, d: &mut [f64], delay: f64) {
    d[PASSED] = c.t - delay + same(c.resolution, c.t);
}
