//! Which entries of the Jacobian differ from zero, seen from outside.

use std::ops::Range;

use super::{Influence, Jacobian};
use crate::adaptive::{Fault, Work};
use crate::sparse::Pattern;

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
}
