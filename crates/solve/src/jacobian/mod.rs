//! The Jacobian df/dx, exact where the system knows it ([`System::along`](crate::System::along)), else by forward differences; and the
//! factors of I - g J.
//!
//! Small systems, and those in which most states act on most others, have a dense one. Columns that share no row are varied
//! together. Which rows a column has follows from what the system says of its states ([`System::influence`](crate::System::influence)).
//! Where it says nothing, or too little to vary many at a time, all columns are looked at once, which shows the entries that differ
//! from zero: many columns together and then halves of them where there are many and few act on the same rows, else one by one. Such
//! an entry may be zero at first and not later: so a difference in one more direction is compared with what J says of it, and where
//! the two do not agree the entries that are missing are looked for.

use crate::System;
use crate::adaptive::{Fault, Work};
use crate::linear::{Singular, lu_factor_diagonal};
use crate::sparse::{Pattern, SparseLu};
use crate::weights::Weights;

use factors::Factors;
pub(crate) use factors::Twice;

mod factors;
mod look;
#[cfg(test)]
mod tests;

/// Up to this many states a dense matrix is quicker.
const SMALL: usize = 24;
/// Part of the entries that differ from zero above which a matrix counts as dense.
const CROWDED: f64 = 0.25;
/// Sets of columns above which it is worth a look which of the entries that the system speaks of differ from zero.
const MANY: usize = 24;
/// Pairs of states that act on one derivative above which nearly all of them do, and finding sets would take longer than a look.
const MOST_PAIRS: usize = 1 << 24;

/// The Jacobian of a system and the factors that belong to it.
pub(crate) struct Jacobian {
    n: usize,
    /// The entries that are known to differ from zero, of a sparse matrix.
    pattern: Option<Pattern>,
    /// df_i/dx_j at i * n + j if dense; else in the order of the pattern.
    values: Vec<f64>,
    groups: Vec<Vec<usize>>,
    /// Whether no other entry can differ from zero.
    certain: bool,
    /// What the system says of its states, once it has been asked.
    influence: Option<Influence>,
    factors: Factors,
    /// A varied state, its derivative, and a direction.
    x: Vec<f64>,
    f: Vec<f64>,
    direction: Vec<f64>,
    /// First value of each column of the pattern.
    starts: Vec<usize>,
    /// What J says of the direction, and the size of its terms.
    said: Vec<f64>,
    size: Vec<f64>,
}

/// The entries that may differ from zero, as the system says, and the columns that can be varied together.
#[derive(Debug, Default)]
struct Influence {
    /// Rows of each column; all of them where the system says nothing.
    rows: Option<Pattern>,
    groups: Vec<Vec<usize>>,
}

impl Influence {
    fn of(system: &dyn System, n: usize) -> Self {
        match system.influence().map(Pattern::of).filter(|pattern| pattern.pairs() <= MOST_PAIRS) {
            Some(pattern) => Self { groups: pattern.groups(), rows: Some(pattern) },
            None => Self { rows: None, groups: (0..n).map(|j| vec![j]).collect() },
        }
    }
}

/// What a Jacobian is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Age {
    Unknown,
    Old,
    Current,
}

/// What a Jacobian is to those who go on with it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Slopes {
    pattern: Option<Pattern>,
    certain: bool,
    values: Vec<f64>,
}

impl Jacobian {
    pub fn new(n: usize) -> Self {
        let mut jacobian = Self {
            n,
            pattern: None,
            values: Vec::new(),
            groups: Vec::new(),
            certain: false,
            influence: None,
            factors: Factors::None,
            x: vec![0.0; n],
            f: vec![0.0; n],
            direction: vec![0.0; n],
            starts: Vec::new(),
            said: vec![0.0; n],
            size: vec![0.0; n],
        };
        if n <= SMALL {
            jacobian.take_dense();
        }
        jacobian
    }

    fn take_dense(&mut self) {
        let n = self.n;
        self.pattern = None;
        self.values = vec![0.0; n * n];
        self.groups = Vec::new();
        self.factors = Factors::Dense { lu: vec![0.0; n * n], pivots: vec![0; n] };
    }

    fn take(&mut self, pattern: Pattern) {
        if pattern.len() as f64 > CROWDED * (self.n * self.n) as f64 {
            self.take_dense();
        } else {
            self.values = vec![0.0; pattern.len()];
            self.groups = pattern.groups();
            let mut start = 0;
            self.starts = Vec::with_capacity(self.n);
            for rows in pattern.columns() {
                self.starts.push(start);
                start += rows.len();
            }
            self.factors = Factors::Sparse(Box::new(SparseLu::new(&pattern)));
            self.pattern = Some(pattern);
        }
    }

    /// Asks the system for what it says of its states, and takes the memory for that.
    pub fn reserve(&mut self, system: &dyn System) {
        self.influence = Some(Influence::of(system, self.n));
    }

    /// Evaluates at (`t`, `x`), where f is `f0`. `h` is the step that is to be made from there.
    pub fn evaluate(&mut self, work: &mut Work, t: f64, x: &[f64], f0: &[f64], h: f64) -> Result<(), Fault> {
        work.counts.jacobians += 1;
        self.x.copy_from_slice(x);
        let influence = self.influence.take().unwrap_or_else(|| Influence::of(&*work.system, self.n));
        let evaluated = self.evaluate_by(&influence, work, t, x, f0, h);
        self.influence = Some(influence);
        evaluated
    }

    fn evaluate_by(
        &mut self,
        influence: &Influence,
        work: &mut Work,
        t: f64,
        x: &[f64],
        f0: &[f64],
        h: f64,
    ) -> Result<(), Fault> {
        if matches!(self.factors, Factors::None) {
            match &influence.rows {
                Some(pattern) if influence.groups.len() <= MANY => {
                    self.certain = true;
                    self.take(pattern.clone());
                }
                _ => match self.look_by_halves(influence, work, t, f0, h) {
                    Some(pattern) => self.take(pattern),
                    None => self.look(influence, work, t, f0, h)?,
                },
            }
        }
        if self.pattern.is_none() {
            return self.dense(influence, work, t, f0, h);
        }
        self.grouped(work, t, f0, h)?;
        if self.certain || self.agrees(work, t, x, f0, h, 0..self.n)? {
            return Ok(());
        }
        if self.find_missing(work, t, x, f0, h)? {
            self.grouped(work, t, f0, h)?;
            if self.agrees(work, t, x, f0, h, 0..self.n)? {
                return Ok(());
            }
        }
        self.look(influence, work, t, f0, h)?;
        if self.pattern.is_none() {
            self.dense(influence, work, t, f0, h)
        } else {
            self.grouped(work, t, f0, h)
        }
    }

    /// The exact slopes over these states together, in `f`. Returns whether the system knows them.
    fn exact(&mut self, work: &mut Work, t: f64, states: &[usize]) -> bool {
        let Self { x, f, direction, .. } = self;
        direction.fill(0.0);
        states.iter().for_each(|&j| direction[j] = 1.0);
        work.system.along(t, x, direction, f) && f.iter().all(|slope| slope.is_finite())
    }

    /// Varies these states and evaluates; `direction` says by how much. Those at the edge of the domain are varied inwards.
    fn vary(&mut self, work: &mut Work, t: f64, f0: &[f64], h: f64, states: &[usize]) -> Result<(), Fault> {
        self.vary_by(work, t, f0, h, states, |_| 1.0)
    }

    /// Varies each of these states by a part of its increment.
    fn vary_by(
        &mut self,
        work: &mut Work,
        t: f64,
        f0: &[f64],
        h: f64,
        states: &[usize],
        part: impl Fn(usize) -> f64,
    ) -> Result<(), Fault> {
        let Self { x, f, direction, .. } = self;
        let mut varied = Ok(());
        for side in [1.0, -1.0] {
            for &j in states {
                direction[j] = x[j];
                x[j] += side * part(j) * work.weights.increment(j, x[j], h * f0[j]);
            }
            varied = work.derivatives(t, x, f);
            // What was varied by, in the place of what was there.
            for &j in states {
                let before = direction[j];
                direction[j] = x[j] - before;
                x[j] = before;
            }
            if varied.is_ok() {
                break;
            }
        }
        varied
    }

    /// All columns of a dense matrix.
    fn dense(
        &mut self,
        influence: &Influence,
        work: &mut Work,
        t: f64,
        f0: &[f64],
        h: f64,
    ) -> Result<(), Fault> {
        let n = self.n;
        self.values.fill(0.0);
        for group in &influence.groups {
            let exact = self.exact(work, t, group);
            if !exact {
                self.vary(work, t, f0, h, group)?;
            }
            let Self { f, values, direction, .. } = self;
            for &j in group {
                let mut set = |i: usize| {
                    values[i * n + j] = match exact {
                        true => f[i],
                        false => work.weights.difference(i, f[i], f0[i]) / direction[j],
                    };
                };
                match &influence.rows {
                    Some(pattern) => pattern.columns()[j].iter().for_each(|&i| set(i)),
                    None => (0..n).for_each(&mut set),
                }
            }
        }
        Ok(())
    }

    /// The columns of each group at once.
    fn grouped(&mut self, work: &mut Work, t: f64, f0: &[f64], h: f64) -> Result<(), Fault> {
        let groups = std::mem::take(&mut self.groups);
        let evaluated = groups.iter().try_for_each(|group| {
            let exact = self.exact(work, t, group);
            if !exact {
                self.vary(work, t, f0, h, group)?;
            }
            let Self { pattern, f, values, direction, starts, .. } = self;
            for &j in group {
                let rows = pattern.iter().flat_map(|pattern| &pattern.columns()[j]);
                for (value, &i) in values[starts[j]..].iter_mut().zip(rows) {
                    *value = match exact {
                        true => f[i],
                        false => work.weights.difference(i, f[i], f0[i]) / direction[j],
                    };
                }
            }
            Ok(())
        });
        self.groups = groups;
        evaluated
    }

    /// Factors I - g J.
    pub fn factor(&mut self, work: &mut Work, g: f64) -> Result<(), Fault> {
        work.counts.factorisations += 1;
        // A pivot is lost only by accident of g, so another one will do.
        self.eliminate(g).map_err(|singular| Fault::NotFinite(singular.column))
    }

    /// Factors I - g J as it was factored before; returns whether that went well.
    pub fn refactor(&mut self, g: f64) -> bool {
        self.eliminate(g).is_ok()
    }

    fn eliminate(&mut self, g: f64) -> Result<(), Singular> {
        let n = self.n;
        match &mut self.factors {
            Factors::None => Ok(()),
            Factors::Sparse(lu) => lu.factor(g, &self.values),
            Factors::Dense { lu, pivots } => {
                lu.iter_mut().zip(&self.values).for_each(|(a, j)| *a = -g * j);
                (0..n).for_each(|i| lu[i * n + i] += 1.0);
                lu_factor_diagonal(lu, pivots)
            }
        }
    }

    /// Overwrites `b` with (I - g J)^-1 b.
    pub fn solve(&mut self, b: &mut [f64]) {
        self.factors.solve(b);
    }

    /// Factors [I - g J, c I; -c I, I - g J].
    pub fn factor_pair(&self, work: &mut Work, pair: &mut Twice, g: f64, c: f64) -> Result<(), Fault> {
        work.counts.factorisations += 1;
        pair.take(self.pattern.as_ref());
        pair.eliminate(g, c, &self.values)
            .map_err(|singular| Fault::NotFinite(singular.column % self.n.max(1)))
    }

    /// A bound of the magnitudes of the eigenvalues of J, 1/s: its norm where states count by the weights at `x`.
    pub fn radius(&mut self, weights: &Weights, x: &[f64]) -> f64 {
        let Self { n, pattern, values, starts, said, size, .. } = self;
        size.iter_mut().zip(x).enumerate().for_each(|(i, (size, x))| *size = weights.unit(i, x.abs()));
        said.fill(0.0);
        match pattern {
            Some(pattern) => {
                for (j, rows) in pattern.columns().iter().enumerate() {
                    for (&i, value) in rows.iter().zip(&values[starts[j]..]) {
                        said[i] += value.abs() * size[j];
                    }
                }
            }
            None => {
                for (sum, row) in said.iter_mut().zip(values.chunks_exact((*n).max(1))) {
                    *sum = row.iter().zip(&*size).map(|(value, size)| value.abs() * size).sum();
                }
            }
        }
        said.iter().zip(&*size).map(|(sum, size)| sum / size).fold(0.0, f64::max)
    }

    /// Forgets all but what it takes.
    pub fn forget(&mut self) {
        if self.n > SMALL {
            (self.pattern, self.factors, self.certain) = (None, Factors::None, false);
            self.values.clear();
        }
    }

    /// What another needs to go on from here.
    pub fn slopes(&self) -> Slopes {
        Slopes { pattern: self.pattern.clone(), certain: self.certain, values: self.values.clone() }
    }

    /// Takes over the slopes of another.
    pub fn recall(&mut self, slopes: &Slopes) {
        self.certain = slopes.certain;
        match &slopes.pattern {
            Some(pattern) => self.take(pattern.clone()),
            None if slopes.values.len() == self.n * self.n && self.n > 0 => self.take_dense(),
            None => return,
        }
        self.values.clone_from(&slopes.values);
    }
}
