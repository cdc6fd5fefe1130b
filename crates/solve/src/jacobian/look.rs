//! Which entries of the Jacobian differ from zero, seen from outside.

use std::ops::Range;

use super::{Influence, Jacobian};
use crate::adaptive::{Fault, Work};
use crate::shake::part;
use crate::sparse::Pattern;

/// Columns that are looked at one by one rather than by halves of sets, at most.
const FEW: usize = 256;
/// Part of the columns in evaluations after which a search for missing entries gives up.
const LONG: f64 = 0.25;
/// By how much of its size a slope in a direction may differ from what J says.
const DOUBT: f64 = 1e-2;

impl Jacobian {
    /// Adds to the pattern what columns show.
    pub(super) fn look(
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

    /// The same, where a look at each column would take long: sets of columns are varied together, and those that act on something
    /// are halved, down to single columns; sets of which no two act on the same derivative share an evaluation. A chain takes about six
    /// evaluations for each halving. Returns nothing where too many sets act on the same for that to end early.
    pub(super) fn look_by_halves(
        &mut self,
        influence: &Influence,
        work: &mut Work,
        t: f64,
        f0: &[f64],
        h: f64,
    ) -> Option<Pattern> {
        if influence.groups.len() <= FEW {
            return None;
        }
        let mut left = (LONG * influence.groups.len() as f64) as usize;
        let mut sets = vec![Set { columns: 0..self.n, rows: (0..self.n).collect() }];
        let mut pattern = Pattern::diagonal(self.n);
        let mut together = Vec::with_capacity(self.n);
        while !sets.is_empty() {
            let mut halves = Vec::with_capacity(2 * sets.len());
            for apart in apart(&sets, left / 2)? {
                for half in [0, 1] {
                    together.clear();
                    apart.iter().for_each(|&set| together.extend(sets[set].half(half)));
                    left = left.checked_sub(1)?;
                    self.vary_by(work, t, f0, h, &together, part).ok()?;
                    let acts = |i: &usize| work.weights.difference(*i, self.f[*i], f0[*i]) != 0.0;
                    for &set in &apart {
                        let columns = sets[set].half(half);
                        let rows = sets[set].rows.iter().copied().filter(acts).collect();
                        halves.push(Set { columns, rows });
                    }
                }
            }
            // In rising order, whoever was evaluated with whom.
            halves.sort_unstable_by_key(|half| half.columns.start);
            sets.clear();
            for half in halves {
                if half.columns.len() > 1 && !half.rows.is_empty() {
                    sets.push(half);
                } else if half.columns.len() == 1 {
                    let j = half.columns.start;
                    let known = influence.rows.as_ref().map(|known| &known.columns()[j]);
                    let may = |i: &usize| known.is_none_or(|rows| rows.binary_search(i).is_ok());
                    half.rows.into_iter().filter(may).for_each(|i| {
                        pattern.add(i, j);
                    });
                }
            }
        }
        Some(pattern)
    }

    /// Adds the entries to the pattern that made J disagree, by halving the set of columns: a few entries take some evaluations for each
    /// halving, not one for each column. Returns `false` where that does not find them, or would take too long.
    pub(super) fn find_missing(
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
    pub(super) fn agrees(
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
            direction[j] = part(j) * work.weights.increment(j, x[j], h * f0[j]);
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
}

/// Columns, and rows that are all that they act on.
struct Set {
    columns: Range<usize>,
    rows: Vec<usize>,
}

impl Set {
    /// The first or the second half of the columns.
    fn half(&self, half: usize) -> Range<usize> {
        let middle = self.columns.start + self.columns.len() / 2;
        if half == 0 { self.columns.start..middle } else { middle..self.columns.end }
    }
}

/// Sorts sets into classes within which no two share a row; nothing where that takes more than `most` classes.
fn apart(sets: &[Set], most: usize) -> Option<Vec<Vec<usize>>> {
    let n = sets.iter().flat_map(|set| &set.rows).max().map_or(0, |last| last + 1);
    let mut classes: Vec<(Vec<usize>, Vec<bool>)> = Vec::new();
    for (number, set) in sets.iter().enumerate() {
        let free = classes.iter().position(|(_, taken)| set.rows.iter().all(|&i| !taken[i]));
        let class = match free {
            Some(class) => class,
            None if classes.len() >= most => return None,
            None => {
                classes.push((Vec::new(), vec![false; n]));
                classes.len() - 1
            }
        };
        let (members, taken) = &mut classes[class];
        members.push(number);
        set.rows.iter().for_each(|&i| taken[i] = true);
    }
    Some(classes.into_iter().map(|(members, _)| members).collect())
}
