//! Linear constraints on speeds with a mass matrix.
//!
//! Under `D dv = b` the accelerations follow from `M dv = f + D' lambda`: with the Cholesky factor of `M`, the
//! multipliers solve `S lambda = b - D M^-1 f`, `S = D M^-1 D'` (the Schur complement). The same `S` takes speeds onto
//! `D v = c` by impulses, `M (v+ - v-) = D' p`: of all speeds that obey, those nearest in kinetic energy.
//!
//! Rows may say the same twice. `S` is scaled to a unit diagonal and factored with complete pivoting; rows whose rest
//! is below [`DEPENDENT`] add nothing. The accelerations are unique all the same. Of the multipliers, those are taken
//! for which `sum sqrt(S_ii) lambda_i^2 / weight_i` is smallest: of parallel rows, whatever their sizes, each bears the
//! same part of its weight.

use blocksim_solve::linear::{cholesky_factor, cholesky_solve};

use crate::mechanics::bounded::Bounded;
use crate::mechanics::envelope::Envelope;

/// A row counts as dependent when less than this is left of its square (in the metric of `M^-1`) after the part that
/// the others explain: an angle of 3e-6 rad. Rounding leaves about 1e-15.
pub(crate) const DEPENDENT: f64 = 1e-11;

/// The rows of `D dv = b`.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rows {
    width: usize,
    d: Vec<f64>,
    /// What `D dv` has to be.
    pub b: Vec<f64>,
    /// Weight of each multiplier in the share among dependent rows; above zero.
    pub weight: Vec<f64>,
    /// Where the rows begin that give way to those before, and those that bear only what none of those can.
    pub yielding: usize,
    pub last: usize,
}

impl Rows {
    /// Room for `capacity` rows over `width` speeds.
    pub(crate) fn new(width: usize, capacity: usize) -> Self {
        Self {
            width,
            d: Vec::with_capacity(width * capacity),
            b: Vec::with_capacity(capacity),
            weight: Vec::with_capacity(capacity),
            yielding: usize::MAX,
            last: usize::MAX,
        }
    }

    pub(crate) fn clear(&mut self) {
        self.d.clear();
        self.b.clear();
        self.weight.clear();
        (self.yielding, self.last) = (usize::MAX, usize::MAX);
    }

    /// Becomes what `other` is, within its own memory.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.clear();
        self.d.extend_from_slice(&other.d);
        self.b.extend_from_slice(&other.b);
        self.weight.extend_from_slice(&other.weight);
        (self.yielding, self.last) = (other.yielding, other.last);
    }

    pub(crate) fn len(&self) -> usize {
        self.b.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.b.is_empty()
    }

    /// Adds a row of zeros, to be filled in.
    pub(crate) fn push(&mut self, b: f64, weight: f64) -> &mut [f64] {
        let start = self.d.len();
        self.d.resize(start + self.width, 0.0);
        self.b.push(b);
        self.weight.push(weight);
        &mut self.d[start..]
    }

    pub(crate) fn row(&self, i: usize) -> &[f64] {
        &self.d[i * self.width..(i + 1) * self.width]
    }

    /// `D v` of one row.
    pub(crate) fn of(&self, i: usize, v: &[f64]) -> f64 {
        dot(self.row(i), v)
    }
}

/// The factored Schur complement of some rows, and space to work in.
#[derive(Debug, Clone, Default)]
pub(crate) struct Schur {
    /// `M^-1 D'`, constraint by constraint.
    columns: Vec<f64>,
    s: Vec<f64>,
    /// `sqrt(S_ii)`.
    scale: Vec<f64>,
    /// Lower triangular when its rows are taken in `order`: the scaled `S` is `G G'`.
    g: Vec<f64>,
    order: Vec<usize>,
    rest: Vec<f64>,
    rank: usize,
    /// Rows that others explain, and those of them that bear nothing.
    dependent: Vec<bool>,
    idle: Vec<bool>,
    /// `H = W E G` and the factor of `H'H`, with `E` the scale and `W^2 = weight / scale`; for dependent rows only.
    h: Vec<f64>,
    gram: Vec<f64>,
    shared: bool,
    y: Vec<f64>,
    gap: Vec<f64>,
    /// Multipliers of the last [`impose`](Self::impose).
    pub lambda: Vec<f64>,
}

impl Schur {
    /// Room for `capacity` rows over `width` speeds.
    pub(crate) fn new(width: usize, capacity: usize) -> Self {
        let square = || vec![0.0; capacity * capacity];
        let line = || vec![0.0; capacity];
        Self {
            columns: vec![0.0; capacity * width],
            s: square(),
            scale: line(),
            g: square(),
            order: vec![0; capacity],
            rest: line(),
            rank: 0,
            dependent: vec![false; capacity],
            idle: vec![false; capacity],
            h: square(),
            gram: square(),
            shared: false,
            y: line(),
            gap: line(),
            lambda: line(),
        }
    }

    /// Number of rows that say something of their own.
    #[cfg(test)]
    pub(crate) fn rank(&self) -> usize {
        self.rank
    }

    /// Whether a row follows from others, so that no force of its own could make it hold.
    pub(crate) fn is_dependent(&self, row: usize) -> bool {
        self.dependent[row]
    }

    /// Whether some rows follow from others.
    pub(crate) fn has_dependent_rows(&self, rows: &Rows) -> bool {
        self.rank < rows.len()
    }

    /// Writes the problem of multipliers within bounds for the gaps that `lambda` closes: unknowns are the multipliers
    /// times their scale. Returns the rank.
    pub(crate) fn within_bounds(&self, rows: &Rows, lambda: &[f64], to: &mut Bounded) -> usize {
        let (m, r) = (rows.len(), self.rank);
        to.y[..r].fill(0.0);
        for (i, (lambda, scale)) in lambda.iter().zip(&self.scale).enumerate() {
            let column = &self.g[i * m..i * m + r];
            to.columns[i * r..(i + 1) * r].copy_from_slice(column);
            let z = lambda * scale;
            to.y[..r].iter_mut().zip(column).for_each(|(y, a)| *y += z * a);
        }
        r
    }

    /// `sqrt(D M^-1 D')` of a row.
    pub(crate) fn scale(&self, row: usize) -> f64 {
        self.scale[row]
    }

    /// The sum of what all rows change about the accelerations, in the metric of `M`.
    pub(crate) fn pulled(&self, lambda: &[f64]) -> f64 {
        lambda.iter().zip(&self.scale).map(|(lambda, scale)| (lambda * scale).abs()).sum()
    }

    /// Factors `D M^-1 D'`; `l` is the Cholesky factor of `M`, with its shape.
    pub(crate) fn factor(&mut self, rows: &Rows, l: &[f64], envelope: &Envelope) {
        let (m, n) = (rows.len(), rows.width);
        for i in 0..m {
            let column = &mut self.columns[i * n..(i + 1) * n];
            column.copy_from_slice(rows.row(i));
            envelope.solve(l, column);
            for j in 0..=i {
                let value = rows.of(j, column);
                self.s[i * m + j] = value;
                self.s[j * m + i] = value;
            }
            self.scale[i] = self.s[i * m + i].max(0.0).sqrt();
            // A row of zeros constrains nothing.
            self.rest[i] = if self.scale[i] > 0.0 { 1.0 } else { 0.0 };
        }
        self.rank = 0;
        self.idle.fill(false);
        for end in [rows.yielding.min(m), rows.last.min(m), m] {
            self.pivot(m, end);
            if end == rows.last {
                let explained = self.rest[end..m].iter().map(|rest| *rest <= DEPENDENT);
                self.idle[end..m].iter_mut().zip(explained).for_each(|(idle, explained)| *idle = explained);
            }
        }
        self.dependent[..m].fill(true);
        self.order[..self.rank].iter().for_each(|p| self.dependent[*p] = false);
        self.shared = false;
        if self.rank < m {
            self.share(rows);
        }
    }

    /// Goes on with the Cholesky factorisation of the scaled `S`, with complete pivoting among the rows before `end`; of
    /// equals, the first.
    fn pivot(&mut self, m: usize, end: usize) {
        while self.rank < end {
            let k = self.rank;
            let mut p = 0;
            for i in 1..end {
                if self.rest[i] > self.rest[p] {
                    p = i;
                }
            }
            if self.rest[p].is_nan() || self.rest[p] <= DEPENDENT {
                return;
            }
            let root = self.rest[p].sqrt();
            for i in 0..m {
                if self.order[..k].contains(&i) {
                    self.g[i * m + k] = 0.0;
                } else if i == p {
                    self.g[i * m + k] = root;
                } else {
                    let known = dot(&self.g[i * m..i * m + k], &self.g[p * m..p * m + k]);
                    let scale = self.scale[i] * self.scale[p];
                    let scaled = if scale > 0.0 { self.s[i * m + p] / scale } else { 0.0 };
                    let value = (scaled - known) / root;
                    self.g[i * m + k] = value;
                    self.rest[i] -= value * value;
                }
            }
            self.rest[p] = f64::NEG_INFINITY;
            self.order[k] = p;
            self.rank += 1;
        }
    }

    /// Prepares the share among dependent rows: `H = W E G`, `H'H` factored.
    fn share(&mut self, rows: &Rows) {
        let (m, r) = (rows.len(), self.rank);
        for i in 0..m {
            for k in 0..r {
                let weight = if self.idle[i] { 0.0 } else { rows.weight[i] };
                self.h[i * r + k] = (weight * self.scale[i]).sqrt() * self.g[i * m + k];
            }
        }
        for a in 0..r {
            for b in 0..r {
                self.gram[a * r + b] = (0..m).map(|i| self.h[i * r + a] * self.h[i * r + b]).sum();
            }
        }
        // With weights that say nothing of a direction, the chosen rows carry everything.
        self.shared = cholesky_factor(&mut self.gram[..r * r], r).is_ok();
    }

    /// Changes `value` by `M^-1 D' lambda` such that `D value` is `target(row)`, and leaves the multipliers behind.
    /// Where dependent rows contradict each other, those that were
    /// chosen as pivots count.
    pub(crate) fn impose(&mut self, rows: &Rows, value: &mut [f64], target: impl Fn(usize) -> f64) {
        self.impose_first(rows, rows.len(), value, target);
    }

    /// The same for the first rows alone; the others keep what they have.
    pub(crate) fn impose_first(
        &mut self,
        rows: &Rows,
        count: usize,
        value: &mut [f64],
        target: impl Fn(usize) -> f64,
    ) {
        let (m, n) = (rows.len(), rows.width);
        for i in 0..m {
            self.lambda[i] = if i < count { target(i) - rows.of(i, value) } else { 0.0 };
        }
        self.multipliers(rows);
        for (lambda, column) in self.lambda[..m].iter().zip(self.columns.chunks_exact(n.max(1))) {
            value.iter_mut().zip(column).for_each(|(value, column)| *value += lambda * column);
        }
    }

    /// Overwrites the gaps in `lambda` with the multipliers that close them.
    fn multipliers(&mut self, rows: &Rows) {
        let (m, r) = (rows.len(), self.rank);
        self.gap[..m].copy_from_slice(&self.lambda[..m]);
        self.lambda[..m].fill(0.0);
        self.down(m);
        if self.shared {
            // G' E lambda = y, with lambda = W mu: H' mu = y, of smallest norm for mu = H (H'H)^-1 y.
            cholesky_solve(&self.gram[..r * r], &mut self.y[..r]);
            for i in (0..m).filter(|i| self.scale[*i] > 0.0 && !self.idle[*i]) {
                self.lambda[i] =
                    (rows.weight[i] / self.scale[i]).sqrt() * dot(&self.h[i * r..(i + 1) * r], &self.y[..r]);
            }
            // Weights of very different sizes leave gaps, which the chosen rows close.
            for p in &self.order[..r] {
                self.gap[*p] -= dot(&self.s[p * m..(p + 1) * m], &self.lambda[..m]);
            }
            self.down(m);
        }
        self.up(m);
    }

    /// `G y = E^-1 gap`, by the rows that were chosen.
    fn down(&mut self, m: usize) {
        for k in 0..self.rank {
            let p = self.order[k];
            let known = dot(&self.g[p * m..p * m + k], &self.y[..k]);
            self.y[k] = (self.gap[p] / self.scale[p] - known) / self.g[p * m + k];
        }
    }

    /// Adds the solution of `G' E lambda = y` by the rows that were chosen.
    fn up(&mut self, m: usize) {
        for k in (0..self.rank).rev() {
            let p = self.order[k];
            let later = self.order[k + 1..self.rank].iter().zip(&self.y[k + 1..self.rank]);
            let known: f64 = later.map(|(q, more)| self.g[q * m + k] * more * self.scale[*q]).sum();
            self.y[k] = (self.y[k] - known) / (self.g[p * m + k] * self.scale[p]);
            self.lambda[p] += self.y[k];
        }
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in -1..1 that look random (Weyl's sequence).
    fn scattered(count: usize) -> Vec<f64> {
        (1..=count).map(|i| 2.0 * (i as f64 * 0.618_033_988_749_894_9).fract() - 1.0).collect()
    }

    /// A positive definite matrix and its Cholesky factor.
    fn mass(n: usize) -> (Vec<f64>, Vec<f64>) {
        let a = scattered(n * n);
        let mut m = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                m[i * n + j] = dot(&a[i * n..(i + 1) * n], &a[j * n..(j + 1) * n]) + f64::from(i == j);
            }
        }
        let mut l = m.clone();
        cholesky_factor(&mut l, n).unwrap();
        (m, l)
    }

    fn rows(width: usize, list: &[(&[f64], f64, f64)]) -> Rows {
        let mut rows = Rows::new(width, list.len());
        for (row, b, weight) in list {
            rows.push(*b, *weight).copy_from_slice(row);
        }
        rows
    }

    /// Accelerations and multipliers under constraints, with the defect of `M dv = f + D' lambda`.
    fn solve(rows: &Rows, m: &[f64], l: &[f64], f: &[f64]) -> (Vec<f64>, Vec<f64>, usize) {
        let n = f.len();
        let mut schur = Schur::new(n, rows.len());
        schur.factor(rows, l, &Envelope::full(n));
        let mut dv = f.to_vec();
        cholesky_solve(l, &mut dv);
        schur.impose(rows, &mut dv, |i| rows.b[i]);
        for i in 0..n {
            let pulled: f64 = (0..rows.len()).map(|k| rows.row(k)[i] * schur.lambda[k]).sum();
            let defect = dot(&m[i * n..(i + 1) * n], &dv) - f[i] - pulled;
            assert!(defect.abs() < 1e-11, "row {i} of the balance is off by {defect:e}");
        }
        (dv, schur.lambda.clone(), schur.rank())
    }

    #[test]
    fn accelerations_obey_the_rows_and_the_balance_of_torques() {
        let (m, l) = mass(5);
        let f = [1.0, -2.0, 3.0, 0.5, -0.25];
        let rows = rows(
            5,
            &[
                (&[1.0, -1.0, 0.0, 0.0, 0.0], 0.0, 1.0),
                (&[0.0, 0.0, 50.0, 1.0, 0.0], 0.25, 1.0),
                (&[0.3, 0.0, 0.0, -0.2, 1e-3], -1.0, 1.0),
            ],
        );
        let (dv, _, rank) = solve(&rows, &m, &l, &f);
        assert_eq!(rank, 3);
        for i in 0..3 {
            assert!((rows.of(i, &dv) - rows.b[i]).abs() < 1e-12, "row {i}: {}", rows.of(i, &dv));
        }
    }

    #[test]
    fn equal_rows_share_in_proportion_to_their_weights() {
        let (m, l) = mass(3);
        let f = [4.0, 1.0, -2.0];
        let held: &[f64] = &[0.0, 1.0, 0.0];
        let (alone, whole, _) = solve(&rows(3, &[(held, 0.0, 1.0)]), &m, &l, &f);
        let (dv, shares, rank) = solve(&rows(3, &[(held, 0.0, 30.0), (held, 0.0, 10.0)]), &m, &l, &f);
        assert_eq!(rank, 1);
        dv.iter().zip(&alone).for_each(|(a, b)| assert!((a - b).abs() < 1e-13));
        assert!((shares[0] - 0.75 * whole[0]).abs() < 1e-12 && (shares[1] - 0.25 * whole[0]).abs() < 1e-12);

        // Behind a gear of 50 the second brake bears the same part of what it can.
        let behind: &[f64] = &[0.0, 50.0, 0.0];
        let (_, shares, _) = solve(&rows(3, &[(held, 0.0, 30.0), (behind, 0.0, 10.0)]), &m, &l, &f);
        assert!((shares[0] / 30.0 - shares[1] / 10.0).abs() < 1e-12, "{shares:?}");
    }

    #[test]
    fn a_row_that_follows_from_others_of_any_size_changes_no_acceleration() {
        let (m, l) = mass(4);
        let f = [1.0, 2.0, 3.0, 4.0];
        let (a, b): (&[f64], &[f64]) = (&[1.0, 2.0, 0.0, -1.0], &[0.0, 1e3, 1e3, 0.0]);
        let sum = [1e-3, 2e-3 + 1.0, 1.0, -1e-3]; // 1e-3 a + 1e-3 b
        let two = solve(&rows(4, &[(a, 0.0, 1.0), (b, 0.0, 1.0)]), &m, &l, &f).0;
        let three = solve(&rows(4, &[(a, 0.0, 1.0), (b, 0.0, 1.0), (&sum, 0.0, 1.0)]), &m, &l, &f);
        assert_eq!(three.2, 2);
        three.0.iter().zip(&two).for_each(|(a, b)| assert!((a - b).abs() < 1e-11, "{a} != {b}"));
    }

    #[test]
    fn of_rows_that_contradict_each_other_the_later_ones_give_way() {
        let (m, l) = mass(3);
        let f = [4.0, 1.0, -2.0];
        let (loose, firm): (&[f64], &[f64]) = (&[0.0, 1.0, 0.0], &[0.0, 50.0, 0.0]);
        for list in [[(loose, 0.0, 1.0), (firm, 9.0, 1.0)], [(firm, 9.0, 1.0), (loose, 0.0, 1.0)]] {
            let mut rows = rows(3, &list);
            rows.yielding = 1;
            let (dv, ..) = solve(&rows, &m, &l, &f);
            assert!((rows.of(0, &dv) - list[0].1).abs() < 1e-12, "{dv:?}");
        }
    }

    #[test]
    fn the_last_rows_bear_nothing_of_what_others_hold_and_all_of_what_none_does() {
        let (m, l) = mass(3);
        let f = [4.0, 1.0, -2.0];
        let (held, other): (&[f64], &[f64]) = (&[0.0, 1.0, 0.0], &[1.0, 1.0, 0.0]);
        let mut rows = rows(3, &[(held, 0.0, 12.0), (held, 0.0, 1e-9), (other, 0.0, 1e-9)]);
        (rows.yielding, rows.last) = (0, 1);
        let (dv, lambda, rank) = solve(&rows, &m, &l, &f);
        assert_eq!((rank, lambda[1]), (2, 0.0));
        assert!(lambda[2].abs() > 0.1 && rows.of(2, &dv).abs() < 1e-12, "{lambda:?}");
    }

    #[test]
    fn a_row_of_zeros_constrains_nothing_and_bears_nothing() {
        let (m, l) = mass(2);
        let (dv, lambda, rank) = solve(&rows(2, &[(&[0.0, 0.0], 0.0, 1.0)]), &m, &l, &[1.0, 2.0]);
        assert_eq!((lambda[0], rank), (0.0, 0));
        let mut free = vec![1.0, 2.0];
        cholesky_solve(&l, &mut free);
        assert_eq!(dv, free);
    }

    #[test]
    fn impulses_take_speeds_to_the_nearest_that_obey_in_kinetic_energy() {
        let (m, l) = mass(3);
        let rows = rows(3, &[(&[1.0, -2.0, 0.0], 0.0, 1.0)]);
        let mut schur = Schur::new(3, 1);
        schur.factor(&rows, &l, &Envelope::full(3));
        let before = [1.0, 0.5, -2.0];
        let mut after = before;
        schur.impose(&rows, &mut after, |_| 0.75);
        assert!((rows.of(0, &after) - 0.75).abs() < 1e-14);
        // The change is at right angles, by M, to every direction that keeps D v.
        for along in [[2.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let change: Vec<f64> = after.iter().zip(&before).map(|(a, b)| a - b).collect();
            let energy: f64 = (0..3).map(|i| along[i] * dot(&m[i * 3..(i + 1) * 3], &change)).sum();
            assert!(energy.abs() < 1e-14, "{energy:e}");
        }
    }

    #[test]
    fn what_is_rigid_beside_what_is_weak_takes_no_digit_from_the_multipliers() {
        let n = 4;
        let (m, l) = mass(n);
        // A row and its double bear without bound, and a third one little.
        let rows = rows(
            n,
            &[
                (&[1.0, -1.0, 0.0, 0.0], 0.0, 1e12),
                (&[0.0, 1.0, 0.0, 0.0], 0.0, 0.3),
                (&[1.0, 0.0, 0.0, 0.0], 0.0, 0.1),
                (&[0.0, 1.0, -1.0, 0.0], 0.0, 1e12),
                (&[1.0, 0.0, -1.0, 0.0], 0.0, 0.2),
            ],
        );
        let (dv, lambda, rank) = solve(&rows, &m, &l, &[0.7, -0.4, 1.3, 0.2]);
        assert_eq!(rank, 3);
        for i in 0..5 {
            assert!(rows.of(i, &dv).abs() < 1e-13, "{i}: {dv:?}, {lambda:?}");
        }
    }
}
