//! The Jacobian df/dx by forward differences, and the factors of I - g J.
//!
//! Small systems, and those in which most states act on most others, have a dense one. Columns that share no row are varied
//! together. Which rows a column has follows from what the system says of its states ([`System::influence`](crate::System::influence)).
//! Where it says nothing, or too little to vary many at a time, all columns are looked at once, which shows the entries that differ
//! from zero. Such an entry may be zero at first and not later: so a difference in one more direction is compared with what J says
//! of it, and where the two do not agree the entries that are missing are looked for.

use crate::System;
use std::ops::Range;

use crate::adaptive::{Fault, Work};
use crate::linear::{Singular, lu_factor, lu_solve};
use crate::sparse::{Pattern, SparseLu};
use crate::weights::Weights;

/// Up to this many states a dense matrix is quicker.
const SMALL: usize = 24;
/// Part of the entries that differ from zero above which a matrix counts as dense.
const CROWDED: f64 = 0.25;
/// Sets of columns above which it is worth a look which of the entries that the system speaks of differ from zero.
const MANY: usize = 24;
/// Pairs of states that act on one derivative above which nearly all of them do, and finding sets would take longer than a look.
const MOST_PAIRS: usize = 1 << 24;
/// Part of the columns in evaluations after which a search for missing entries gives up.
const LONG: f64 = 0.25;
/// By how much of its size a slope in a direction may differ from what J says.
const DOUBT: f64 = 1e-2;

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

enum Factors {
    None,
    Dense { lu: Vec<f64>, pivots: Vec<usize> },
    Sparse(Box<SparseLu>),
}

/// What a Jacobian is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Age {
    Unknown,
    Old,
    Current,
}

/// Factors of the pair of equations [I - g J, c I; -c I, I - g J].
pub(crate) struct Twice {
    n: usize,
    factors: Factors,
    /// Entries of a sparse matrix, of which `factors` know the pattern `of`.
    values: Vec<f64>,
    of: Option<Pattern>,
}

impl Twice {
    pub fn new(n: usize) -> Self {
        let mut twice = Self { n, factors: Factors::None, values: Vec::new(), of: None };
        if n <= SMALL {
            twice.take(None);
        }
        twice
    }

    /// Overwrites `b` with the solution; the first half belongs to the first equation.
    pub fn solve(&mut self, b: &mut [f64]) {
        self.factors.solve(b);
    }

    /// Takes the places for a Jacobian of another shape.
    fn take(&mut self, pattern: Option<&Pattern>) {
        let n = self.n;
        if self.of.as_ref() == pattern && !matches!(self.factors, Factors::None) {
            return;
        }
        self.of = pattern.cloned();
        let Some(pattern) = pattern else {
            self.factors = Factors::Dense { lu: vec![0.0; 4 * n * n], pivots: vec![0; 2 * n] };
            return;
        };
        let mut both = Pattern::diagonal(2 * n);
        for (j, rows) in pattern.columns().iter().enumerate() {
            for &i in rows {
                both.add(i, j);
                both.add(n + i, n + j);
            }
            both.add(n + j, j);
            both.add(j, n + j);
        }
        self.values = vec![0.0; both.len()];
        self.factors = Factors::Sparse(Box::new(SparseLu::new(&both)));
    }

    fn eliminate(&mut self, g: f64, c: f64, jacobian: &[f64]) -> Result<(), Singular> {
        let n = self.n;
        match &mut self.factors {
            Factors::None => Ok(()),
            Factors::Dense { lu, pivots } => {
                lu.fill(0.0);
                for i in 0..n {
                    for j in 0..n {
                        let value = f64::from(i == j) - g * jacobian[i * n + j];
                        lu[i * 2 * n + j] = value;
                        lu[(n + i) * 2 * n + n + j] = value;
                    }
                    lu[i * 2 * n + n + i] = c;
                    lu[(n + i) * 2 * n + i] = -c;
                }
                lu_factor(lu, pivots)
            }
            Factors::Sparse(lu) => {
                // Columns of the first half end with the entry of the other equation, those of the second begin with it.
                let (mut at, mut from) = (0, 0);
                let Some(of) = &self.of else { return Ok(()) };
                for half in 0..2 {
                    from = if half == 0 { from } else { 0 };
                    for rows in of.columns() {
                        if half == 1 {
                            self.values[at] = -c;
                            at += 1;
                        }
                        for _ in rows {
                            self.values[at] = g * jacobian[from];
                            (at, from) = (at + 1, from + 1);
                        }
                        if half == 0 {
                            self.values[at] = c;
                            at += 1;
                        }
                    }
                }
                lu.factor(1.0, &self.values)
            }
        }
    }
}

impl Factors {
    fn solve(&mut self, b: &mut [f64]) {
        match self {
            Factors::None => {}
            Factors::Dense { lu, pivots } => lu_solve(lu, pivots, b),
            Factors::Sparse(lu) => lu.solve(b),
        }
    }
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
                _ => self.look(influence, work, t, f0, h)?,
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

    /// Varies these states and evaluates; `direction` says by how much. Those at the edge of the domain are varied inwards.
    fn vary(&mut self, work: &mut Work, t: f64, f0: &[f64], h: f64, states: &[usize]) -> Result<(), Fault> {
        let Self { x, f, direction, .. } = self;
        let mut varied = Ok(());
        for side in [1.0, -1.0] {
            for &j in states {
                direction[j] = x[j];
                x[j] += side * work.weights.increment(j, x[j], h * f0[j]);
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
            self.vary(work, t, f0, h, group)?;
            let Self { f, values, direction, .. } = self;
            for &j in group {
                let mut set = |i: usize| {
                    values[i * n + j] = work.weights.difference(i, f[i], f0[i]) / direction[j];
                };
                match &influence.rows {
                    Some(pattern) => pattern.columns()[j].iter().for_each(|&i| set(i)),
                    None => (0..n).for_each(&mut set),
                }
            }
        }
        Ok(())
    }

    /// Adds to the pattern what columns show.
    fn look(
        &mut self,
        influence: &Influence,
        work: &mut Work,
        t: f64,
        f0: &[f64],
        h: f64,
    ) -> Result<(), Fault> {
        let mut pattern = self.pattern.clone().unwrap_or_else(|| Pattern::diagonal(self.n));
        for group in &influence.groups {
            self.vary(work, t, f0, h, group)?;
            for &j in group {
                let mut see = |i: usize| {
                    if work.weights.difference(i, self.f[i], f0[i]) != 0.0 {
                        pattern.add(i, j);
                    }
                };
                match &influence.rows {
                    Some(known) => known.columns()[j].iter().for_each(|&i| see(i)),
                    None => (0..self.n).for_each(&mut see),
                }
            }
        }
        self.take(pattern);
        Ok(())
    }

    /// The columns of each group at once.
    fn grouped(&mut self, work: &mut Work, t: f64, f0: &[f64], h: f64) -> Result<(), Fault> {
        let groups = std::mem::take(&mut self.groups);
        let evaluated = groups.iter().try_for_each(|group| {
            self.vary(work, t, f0, h, group)?;
            let Self { pattern, f, values, direction, starts, .. } = self;
            for &j in group {
                let rows = pattern.iter().flat_map(|pattern| &pattern.columns()[j]);
                for (value, &i) in values[starts[j]..].iter_mut().zip(rows) {
                    *value = work.weights.difference(i, f[i], f0[i]) / direction[j];
                }
            }
            Ok(())
        });
        self.groups = groups;
        evaluated
    }

    /// Adds the entries to the pattern that made J disagree, by halving the set of columns: a few entries take some evaluations for each
    /// halving, not one for each column. Returns `false` where that does not find them, or would take too long.
    fn find_missing(
        &mut self,
        work: &mut Work,
        t: f64,
        x: &[f64],
        f0: &[f64],
        h: f64,
    ) -> Result<bool, Fault> {
        let Some(mut pattern) = self.pattern.clone() else { return Ok(false) };
        let mut found = false;
        let mut sets = Vec::from([Range { start: 0, end: self.n }]);
        let mut left = (LONG * self.n as f64) as usize;
        while let Some(columns) = sets.pop() {
            if left == 0 {
                return Ok(false);
            }
            left -= 1;
            if columns.len() == 1 {
                let j = columns.start;
                self.vary(work, t, f0, h, &[j])?;
                let differs = |i: &usize| work.weights.difference(*i, self.f[*i], f0[*i]) != 0.0;
                (0..self.n).filter(differs).for_each(|i| found |= pattern.add(i, j));
            } else if !self.agrees(work, t, x, f0, h, columns.clone())? {
                let middle = columns.start + columns.len() / 2;
                sets.extend([columns.start..middle, middle..columns.end]);
            }
        }
        if found {
            self.take(pattern);
        }
        Ok(found && self.pattern.is_some())
    }

    /// Whether J tells the difference in a direction of no meaning, along these columns.
    fn agrees(
        &mut self,
        work: &mut Work,
        t: f64,
        x0: &[f64],
        f0: &[f64],
        h: f64,
        columns: Range<usize>,
    ) -> Result<bool, Fault> {
        let Some(pattern) = &self.pattern else { return Ok(true) };
        let Self { x, f, values, direction, starts, said, size, .. } = self;
        direction.fill(0.0);
        for j in columns.clone() {
            let bits = (j as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let part = 0.5 + (bits >> 33) as f64 / (1_u64 << 31) as f64;
            direction[j] = part * work.weights.increment(j, x[j], h * f0[j]);
        }
        x.iter_mut().zip(&*direction).for_each(|(x, v)| *x += v);
        let evaluated = work.derivatives(t, x, f);
        x.copy_from_slice(x0);
        if evaluated.is_err() {
            // All states at the edge of the domain at once are no state of interest.
            return Ok(true);
        }
        said.fill(0.0);
        size.fill(0.0);
        for (j, rows) in pattern.columns().iter().enumerate().take(columns.end).skip(columns.start) {
            for (&i, value) in rows.iter().zip(&values[starts[j]..]) {
                said[i] += value * direction[j];
                size[i] += (value * direction[j]).abs();
            }
        }
        let differs = |i: usize| {
            let found = work.weights.difference(i, f[i], f0[i]);
            let rounding = 64.0 * f64::EPSILON * f[i].abs().max(f0[i].abs());
            (found - said[i]).abs() > DOUBT * size[i].max(found.abs()) + rounding
        };
        Ok(!(0..x.len()).any(differs))
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
                lu_factor(lu, pivots)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::function;
    use crate::{Counts, System, Tolerances};

    /// Evaluates f and J.
    fn evaluate(jacobian: &mut Jacobian, system: &mut dyn System, x: &[f64]) -> u64 {
        let (mut counts, n) = (Counts::default(), x.len());
        let mut weights = Weights::new(Tolerances::automatic(n, 1e-6));
        weights.note(0.0, x);
        let mut work = Work { system, counts: &mut counts, weights: &weights };
        let mut f0 = vec![0.0; n];
        assert!(work.derivatives(0.0, x, &mut f0).is_ok());
        assert!(jacobian.evaluate(&mut work, 0.0, x, &f0, 1e-3).is_ok());
        counts.evaluations - 1
    }

    fn chain(n: usize) -> impl System {
        function(n, move |_, x, dx| {
            for i in 0..n {
                let left = if i > 0 { x[i - 1] } else { 1.0 };
                let right = if i + 1 < n { x[i + 1] } else { 0.0 };
                // The last cell feels the first one by a product.
                let far = if i + 1 == n { x[0] * x[i] } else { 0.0 };
                dx[i] = left - 2.0 * x[i] + right + far;
            }
        })
    }

    #[test]
    fn a_chain_takes_as_many_evaluations_as_it_has_groups() {
        let mut jacobian = Jacobian::new(100);
        let mut x: Vec<f64> = (0..100).map(|i| 1.0 / (1.0 + i as f64)).collect();
        // Once to see which entries there are; three groups and one for the entry far off; one to compare.
        assert_eq!(evaluate(&mut jacobian, &mut chain(100), &x), 100 + 4 + 1);
        x[0] = 0.5;
        assert_eq!(evaluate(&mut jacobian, &mut chain(100), &x), 4 + 1);
        assert!(matches!(jacobian.factors, Factors::Sparse(_)));
    }

    #[test]
    fn an_entry_that_was_zero_at_first_is_found_when_it_matters() {
        let mut jacobian = Jacobian::new(100);
        // At x = 0 the product has no slope.
        let mut x = vec![0.0; 100];
        evaluate(&mut jacobian, &mut chain(100), &x);
        let seen = jacobian.pattern.as_ref().unwrap().len();
        assert!(seen < 299);
        x.fill(0.5);
        assert!(evaluate(&mut jacobian, &mut chain(100), &x) > 100);
        assert_eq!(jacobian.pattern.as_ref().unwrap().len(), 299);
    }

    #[test]
    fn a_few_entries_that_are_missing_are_found_by_halving() {
        let n = 400;
        let mut system = function(n, move |_, x, dx| {
            (0..n).for_each(|i| dx[i] = -x[i]);
            dx[n - 1] += x[7] * x[300];
        });
        let mut jacobian = Jacobian::new(n);
        let mut x = vec![1.0; n];
        (x[7], x[300]) = (0.0, 0.0);
        evaluate(&mut jacobian, &mut system, &x);
        assert_eq!(jacobian.pattern.as_ref().unwrap().len(), n);
        (x[7], x[300]) = (1.0, 1.0);
        // Two of 400 columns, by nine halvings each, of which each looks at both halves.
        let spent = evaluate(&mut jacobian, &mut system, &x);
        assert!(spent < 2 * 3 * 9 + 10, "{spent}");
        assert_eq!(jacobian.pattern.as_ref().unwrap().len(), n + 2);
    }

    /// A system that says of its states what they act on.
    struct Known<S: System>(S, Vec<Vec<usize>>);

    impl<S: System> System for Known<S> {
        fn dimension(&self) -> usize {
            self.0.dimension()
        }

        fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), crate::Failed> {
            self.0.derivatives(t, x, dx)
        }

        fn influence(&self) -> Option<Vec<Vec<usize>>> {
            Some(self.1.clone())
        }
    }

    fn neighbours(n: usize) -> Vec<Vec<usize>> {
        let around = |j: usize| (j.saturating_sub(1)..=(j + 1).min(n - 1)).collect::<Vec<_>>();
        let mut columns: Vec<Vec<usize>> = (0..n).map(around).collect();
        columns[0].push(n - 1);
        columns
    }

    #[test]
    fn what_a_system_says_of_its_states_is_not_looked_for() {
        for n in [10, 100] {
            let (mut plain, mut told) = (Jacobian::new(n), Jacobian::new(n));
            // At x = 0 the product has no slope, and its entry is there all the same.
            for x in [vec![0.0; n], vec![0.5; n]] {
                evaluate(&mut plain, &mut chain(n), &x);
                assert_eq!(evaluate(&mut told, &mut Known(chain(n), neighbours(n)), &x), 4, "{n}");
                let (mut b, mut c) = (vec![1.0; n], vec![1.0; n]);
                let (mut counts, weights) = (Counts::default(), Weights::new(Tolerances::automatic(n, 1e-6)));
                let mut work = Work { system: &mut chain(n), counts: &mut counts, weights: &weights };
                assert!(plain.factor(&mut work, 0.1).is_ok() && told.factor(&mut work, 0.1).is_ok());
                plain.solve(&mut b);
                told.solve(&mut c);
                assert!(b.iter().zip(&c).all(|(b, c)| (b - c).abs() < 1e-7 * b.abs()), "{n}: {b:?} {c:?}");
            }
        }
    }

    #[test]
    fn where_that_allows_few_states_at_a_time_it_is_looked_once() {
        // Each of the first 30 states may act on all of the last 100, but does so on one.
        let n = 130;
        let mut columns: Vec<Vec<usize>> = (0..30).map(|_| (30..n).collect()).collect();
        columns.extend((30..n).map(|j| vec![j]));
        let mut system = Known(
            function(n, |_, x, dx| {
                (0..30).for_each(|i| dx[i] = -x[i]);
                (30..130).for_each(|i| dx[i] = x[i % 30] - 2.0 * x[i]);
            }),
            columns,
        );
        let mut jacobian = Jacobian::new(n);
        let x = vec![1.0; n];
        // 31 sets show it; one is varied with all that acts elsewhere.
        assert_eq!(evaluate(&mut jacobian, &mut system, &x), 31 + 2 + 1);
        assert_eq!(evaluate(&mut jacobian, &mut system, &x), 2 + 1);
    }

    #[test]
    fn a_look_that_fails_leaves_what_is_known() {
        let (mut jacobian, left) = (Jacobian::new(100), std::cell::Cell::new(u32::MAX));
        let mut plain = chain(100);
        let mut system = function(100, |t, x, dx| {
            left.set(left.get().saturating_sub(1));
            if left.get() == 0 {
                dx.fill(f64::NAN);
            } else {
                plain.derivatives(t, x, dx).unwrap();
            }
        });
        evaluate(&mut jacobian, &mut system, &[0.0; 100]);
        // The product is found to be missing, and the domain ends amid the look for it.
        left.set(20);
        let (mut counts, mut weights) = (Counts::default(), Weights::new(Tolerances::automatic(100, 1e-6)));
        weights.note(0.0, &[0.5; 100]);
        let mut work = Work { system: &mut system, counts: &mut counts, weights: &weights };
        let mut f0 = vec![0.0; 100];
        assert!(work.derivatives(0.0, &[0.5; 100], &mut f0).is_ok());
        assert!(jacobian.evaluate(&mut work, 0.0, &[0.5; 100], &f0, 1e-3).is_err());
        left.set(u32::MAX);
        evaluate(&mut jacobian, &mut system, &[0.5; 100]);
        assert_eq!(jacobian.pattern.as_ref().unwrap().len(), 299);
    }

    #[test]
    fn what_is_crowded_is_dense_and_solves_as_well() {
        for n in [10, 40] {
            let mut jacobian = Jacobian::new(n);
            let mut system = function(n, move |_, x, dx| {
                let sum: f64 = x.iter().sum();
                dx.iter_mut().zip(x).for_each(|(dx, x)| *dx = sum - 100.0 * x);
            });
            evaluate(&mut jacobian, &mut system, &vec![1.0; n]);
            assert!(matches!(jacobian.factors, Factors::Dense { .. }));
            let (mut counts, weights) = (Counts::default(), Weights::new(Tolerances::automatic(n, 1e-6)));
            let mut work = Work { system: &mut system, counts: &mut counts, weights: &weights };
            assert!(jacobian.factor(&mut work, 0.1).is_ok());
            let mut b = vec![1.0; n];
            jacobian.solve(&mut b);
            // All alike: (1 + 10 - 0.1 n) x = 1.
            assert!(b.iter().all(|b| (b * (11.0 - 0.1 * n as f64) - 1.0).abs() < 1e-6), "{b:?}");
        }
    }
}
