//! Least squares within bounds: `min |A z - y|` for `lower <= z <= upper`.
//!
//! With `S = A'A` the Schur complement of some constraints this is the problem of dry friction: torques within what is
//! held, of which each that is at its bound slides (J. J. Moreau). The residual is unique, also where columns depend on
//! each other, and the columns that are free never do, as each enters with a slope of its own. Active sets after
//! P. B. Stark and R. L. Parker, Bounded-variable least-squares: an algorithm and applications, Computational
//! Statistics 10 (1995).

use blocksim_solve::linear::{cholesky_factor, cholesky_solve};

use crate::mechanics::schur::dot;

/// Slopes below this part of what is to be reached are rounding.
const ROUNDING: f64 = 1e-12;

/// Columns of which less than this part (of the square) does not follow from others are dependent.
const DEPENDENT: f64 = 1e-10;

/// Space to work in.
#[derive(Debug, Clone, Default)]
pub(crate) struct Bounded {
    /// `A'`: a row for each unknown.
    pub columns: Vec<f64>,
    /// The right-hand side, and what of it is not reached in the end.
    pub y: Vec<f64>,
    pub residual: Vec<f64>,
    /// Bounds with zero between them, which may be infinite, and the solution.
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    pub z: Vec<f64>,
    free: Vec<usize>,
    gram: Vec<f64>,
    aim: Vec<f64>,
    barred: Vec<bool>,
}

impl Bounded {
    /// Room for this many unknowns.
    pub(crate) fn new(unknowns: usize) -> Self {
        let line = || vec![0.0; unknowns];
        Self {
            columns: vec![0.0; unknowns * unknowns],
            y: line(),
            residual: line(),
            lower: line(),
            upper: line(),
            z: line(),
            free: Vec::with_capacity(unknowns),
            gram: vec![0.0; unknowns * unknowns],
            aim: line(),
            barred: vec![false; unknowns],
        }
    }

    /// Solves for `m` unknowns and `r` rows. Returns what slope is rounding: the right-hand side is reached where no
    /// slope is larger.
    pub(crate) fn solve(&mut self, m: usize, r: usize) -> f64 {
        self.free.clear();
        self.z[..m].fill(0.0);
        self.barred[..m].fill(false);
        let small = ROUNDING * dot(&self.y[..r], &self.y[..r]).sqrt();
        for _ in 0..20 + 10 * m {
            self.miss(m, r);
            let Some(enters) = self.entering(m, r, small) else { break };
            self.free.push(enters);
            while !self.free.is_empty() {
                if !self.aim(m, r) {
                    // Rounding makes it follow from the others.
                    self.free.retain(|i| *i != enters);
                    self.barred[enters] = true;
                    continue;
                }
                if self.go(m) {
                    break;
                }
            }
            if !self.barred[enters] {
                self.barred[..m].fill(false);
            }
        }
        self.miss(m, r);
        small
    }

    /// Slope of what is missed over one unknown: above zero if it should grow.
    pub(crate) fn slope(&self, i: usize, r: usize) -> f64 {
        dot(&self.columns[i * r..(i + 1) * r], &self.residual[..r])
    }

    fn miss(&mut self, m: usize, r: usize) {
        self.residual[..r].copy_from_slice(&self.y[..r]);
        for i in (0..m).filter(|i| self.z[*i] != 0.0) {
            let column = &self.columns[i * r..(i + 1) * r];
            self.residual[..r].iter_mut().zip(column).for_each(|(to, a)| *to -= a * self.z[i]);
        }
    }

    /// The unknown that gains most if it leaves its place.
    fn entering(&self, m: usize, r: usize, small: f64) -> Option<usize> {
        let mut best = (None, small);
        for i in (0..m).filter(|i| !self.barred[*i] && !self.free.contains(i)) {
            let slope = self.slope(i, r);
            let may = if slope > 0.0 { self.z[i] < self.upper[i] } else { self.z[i] > self.lower[i] };
            if may && slope.abs() > best.1 {
                best = (Some(i), slope.abs());
            }
        }
        best.0
    }

    /// Where the free unknowns would be without bounds, in `aim`; false if they depend on each other.
    fn aim(&mut self, m: usize, r: usize) -> bool {
        let k = self.free.len();
        self.residual[..r].copy_from_slice(&self.y[..r]);
        for i in (0..m).filter(|i| self.z[*i] != 0.0 && !self.free.contains(i)) {
            let column = &self.columns[i * r..(i + 1) * r];
            self.residual[..r].iter_mut().zip(column).for_each(|(to, a)| *to -= a * self.z[i]);
        }
        for (a, i) in self.free.iter().enumerate() {
            let column = &self.columns[i * r..(i + 1) * r];
            self.aim[a] = dot(column, &self.residual[..r]);
            for (b, j) in self.free.iter().enumerate() {
                self.gram[a * k + b] = dot(column, &self.columns[j * r..(j + 1) * r]);
            }
        }
        if cholesky_factor(&mut self.gram[..k * k], k).is_err()
            || (0..k).any(|a| self.gram[a * k + a].powi(2) > 1.0 / DEPENDENT)
        {
            return false;
        }
        cholesky_solve(&self.gram[..k * k], &mut self.aim[..k]);
        true
    }

    /// Goes towards the aim up to the first bound, where that unknown stays. Returns whether the aim was reached.
    fn go(&mut self, m: usize) -> bool {
        let mut part = 1.0;
        let mut stops = m;
        for (a, i) in self.free.iter().enumerate() {
            let (z, aim) = (self.z[*i], self.aim[a]);
            let bound = if aim > z { self.upper[*i] } else { self.lower[*i] };
            let beyond = if aim > z { aim > bound } else { aim < bound };
            if beyond && (bound - z) / (aim - z) <= part {
                part = (bound - z) / (aim - z);
                stops = *i;
            }
        }
        for (a, i) in self.free.iter().enumerate() {
            let z = self.z[*i] + part * (self.aim[a] - self.z[*i]);
            self.z[*i] = z.max(self.lower[*i]).min(self.upper[*i]);
        }
        if stops == m {
            return true;
        }
        let bound = if self.aim_of(stops) > self.z[stops] { self.upper[stops] } else { self.lower[stops] };
        // It is there already but for rounding.
        self.z[stops] = bound;
        self.free.retain(|i| *i != stops);
        false
    }

    fn aim_of(&self, unknown: usize) -> f64 {
        self.free.iter().position(|i| *i == unknown).map_or(0.0, |a| self.aim[a])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(columns: &[&[f64]], y: &[f64], bounds: &[(f64, f64)]) -> (bool, Vec<f64>, Bounded) {
        let (m, r) = (columns.len(), y.len());
        let mut b = Bounded::new(m.max(r));
        for (i, column) in columns.iter().enumerate() {
            b.columns[i * r..(i + 1) * r].copy_from_slice(column);
        }
        b.y[..r].copy_from_slice(y);
        for (i, (lower, upper)) in bounds.iter().enumerate() {
            (b.lower[i], b.upper[i]) = (*lower, *upper);
        }
        let small = b.solve(m, r);
        let reached = (0..m).all(|i| b.slope(i, r).abs() <= small);
        (reached, b.z[..m].to_vec(), b)
    }

    #[test]
    fn what_three_bear_together_is_found_although_an_even_share_is_too_much_for_one() {
        // Columns of a triangle of clutches; only the first two directions are independent.
        let (a, b, c): (&[f64], &[f64], &[f64]) = (&[1.0, 0.0], &[0.0, 1.0], &[0.6, 0.8]);
        let (reached, z, _) = solve(&[a, b, c], &[1.0, 1.0], &[(-0.6, 0.6), (-0.4, 0.4), (-9.0, 9.0)]);
        assert!(reached);
        assert!(z[0].abs() <= 0.6 && z[1].abs() <= 0.4, "{z:?}");
        assert!((z[0] + 0.6 * z[2] - 1.0).abs() < 1e-14 && (z[1] + 0.8 * z[2] - 1.0).abs() < 1e-14, "{z:?}");
        let (reached, z, rest) = solve(&[a, b, c], &[1.0, 1.0], &[(-0.1, 0.1), (-0.1, 0.1), (-0.2, 0.2)]);
        assert!(!reached);
        assert_eq!(z, [0.1, 0.1, 0.2]);
        assert!((0..3).all(|i| rest.slope(i, 2) > 0.0));
    }

    #[test]
    fn the_solution_obeys_the_conditions_of_the_optimum_for_columns_of_any_kind() {
        let number = |i: usize| 2.0 * (i as f64 * 0.618_033_988_749_894_9).fract() - 1.0;
        for case in 0..200 {
            let (m, r) = (2 + case % 7, 2 + case % 3);
            let columns: Vec<Vec<f64>> =
                (0..m).map(|i| (0..r).map(|k| number(97 * case + 7 * i + k + 1)).collect()).collect();
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            let y: Vec<f64> = (0..r).map(|k| 2.0 * number(31 * case + k + 1)).collect();
            let bounds: Vec<(f64, f64)> =
                (0..m).map(|i| (-number(5 * case + i + 1).abs(), number(11 * case + i + 3).abs())).collect();
            let (_, z, b) = solve(&columns, &y, &bounds);
            for i in 0..m {
                let slope = b.slope(i, r);
                assert!(z[i] >= bounds[i].0 && z[i] <= bounds[i].1);
                assert!(slope <= 1e-9 || z[i] == bounds[i].1, "case {case}: {i} should grow");
                assert!(slope >= -1e-9 || z[i] == bounds[i].0, "case {case}: {i} should fall");
            }
        }
    }
}
