//! Which entries of the mass matrix, and of what implicit steps add to it, may differ from zero.
//!
//! Shafts that springs, dampers and frictions join hardly share inertia: the matrix has few entries beside its diagonal.
//! Its Cholesky factor has nonzeros only within the envelope, from the first entry of each row to the diagonal, so that a
//! chain costs in proportion to its length. With bodies, and for few speeds, all of it counts as full.

use blocksim_solve::linear::{Singular, cholesky_factor, cholesky_solve};

use crate::assembly::eliminate::Form;
use crate::mechanics::rotation::Rotation;
use crate::mechanics::schur::dot;

/// Up to so many speeds the kernels for full matrices are quicker.
const FEW: usize = 12;

/// The first column of each row of the lower triangle that may differ from zero.
#[derive(Debug, Clone, Default)]
pub(crate) struct Envelope {
    first: Vec<usize>,
    full: bool,
}

impl Envelope {
    /// All entries.
    pub(crate) fn full(n: usize) -> Self {
        Self { first: vec![0; n], full: true }
    }

    /// What inertias and branches fill.
    pub(crate) fn of(rotation: &Rotation, has_bodies: bool) -> Self {
        let n = rotation.free;
        if has_bodies || n <= FEW {
            return Self::full(n);
        }
        let entry = |i: usize| (0..i).find(|j| rotation.reflected[i * n + j] != 0.0).unwrap_or(i);
        let mut first: Vec<usize> = (0..n).map(entry).collect();
        let branches = rotation.branches.iter().map(|pin| &rotation.pins[*pin].speed);
        for form in branches.chain(rotation.gears.iter().map(|gear| &gear.base)) {
            let least = form.terms().iter().map(|(i, _)| *i as usize).min().unwrap_or(n);
            form.terms().iter().for_each(|(i, _)| first[*i as usize] = first[*i as usize].min(least));
        }
        Self { first, full: false }
    }

    /// Overwrites the lower triangle of `a` with its factor, as [`cholesky_factor`] does.
    pub(crate) fn factor(&self, a: &mut [f64]) -> Result<(), Singular> {
        let n = self.first.len();
        if self.full {
            return cholesky_factor(a, n);
        }
        for i in 0..n {
            let (above, rest) = a.split_at_mut(i * n);
            let row = &mut rest[..n];
            let first = self.first[i];
            for j in first..i {
                let other = &above[j * n..(j + 1) * n];
                let from = first.max(self.first[j]).min(j);
                row[j] = (row[j] - dot(&row[from..j], &other[from..j])) * other[j];
            }
            let square = row[i] - dot(&row[first..i], &row[first..i]);
            if square.is_nan() || square <= 0.0 || square == f64::INFINITY {
                return Err(Singular { column: i });
            }
            row[i] = 1.0 / square.sqrt();
        }
        Ok(())
    }

    /// Solves with the factor.
    pub(crate) fn solve(&self, l: &[f64], b: &mut [f64]) {
        if self.full {
            return cholesky_solve(l, b);
        }
        let n = b.len();
        for i in 0..n {
            let first = self.first[i];
            b[i] = (b[i] - dot(&l[i * n + first..i * n + i], &b[first..i])) * l[i * n + i];
        }
        for i in (0..n).rev() {
            let first = self.first[i];
            b[i] *= l[i * n + i];
            let (before, rest) = b.split_at_mut(i);
            let row = &l[i * n + first..i * n + i];
            before[first..].iter_mut().zip(row).for_each(|(to, l)| *to -= l * rest[0]);
        }
    }

    /// `out = a v` for a symmetric matrix.
    pub(crate) fn product(&self, a: &[f64], v: &[f64], out: &mut [f64]) {
        let n = v.len();
        if self.full {
            for (row, to) in out.iter_mut().enumerate() {
                *to = a[row * n..(row + 1) * n].iter().zip(v).map(|(m, v)| m * v).sum();
            }
            return;
        }
        for i in 0..n {
            let first = self.first[i];
            let row = &a[i * n + first..i * n + i];
            out[i] = a[i * n + i] * v[i] + dot(row, &v[first..i]);
            out[first..i].iter_mut().zip(row).for_each(|(to, a)| *to += a * v[i]);
        }
    }

    /// Makes the matrix zero.
    pub(crate) fn clear(&self, a: &mut [f64]) {
        let n = self.first.len();
        if self.full {
            return a.fill(0.0);
        }
        (0..n).for_each(|i| a[i * n + self.first[i]..=i * n + i].fill(0.0));
    }

    /// `to = a + factor * b`.
    pub(crate) fn sum(&self, to: &mut [f64], a: &[f64], factor: f64, b: &[f64]) {
        let n = self.first.len();
        for (i, first) in self.first.iter().enumerate() {
            let range = if self.full { i * n..(i + 1) * n } else { i * n + first..i * n + i + 1 };
            let ends = a[range.clone()].iter().zip(&b[range.clone()]);
            to[range].iter_mut().zip(ends).for_each(|(to, (a, b))| *to = a + factor * b);
        }
    }

    /// `matrix += factor * form' form`.
    pub(crate) fn square(&self, form: &Form, factor: f64, matrix: &mut [f64]) {
        let n = self.first.len();
        if self.full {
            return form.square_to(factor, matrix, n);
        }
        for (i, a) in form.terms() {
            for (j, b) in form.terms().iter().filter(|(j, _)| j <= i) {
                matrix[*i as usize * n + *j as usize] += factor * a * b;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_envelope_gives_what_the_full_matrix_gives() {
        let n = 40_usize;
        let number = |i: usize| (i as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
        let first: Vec<usize> = (0..n).map(|i| i.saturating_sub(i * 7 % 5)).collect();
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            for j in first[i]..i {
                a[i * n + j] = number(i * n + j);
                a[j * n + i] = a[i * n + j];
            }
            a[i * n + i] = 4.0;
        }
        let (thin, full) = (Envelope { first, full: false }, Envelope::full(n));
        let b: Vec<f64> = (0..n).map(number).collect();
        let mut products = [vec![0.0; n], vec![0.0; n]];
        let mut solutions = [b.clone(), b.clone()];
        for ((envelope, product), solution) in
            [&thin, &full].into_iter().zip(&mut products).zip(&mut solutions)
        {
            let mut l = a.clone();
            envelope.factor(&mut l).unwrap();
            envelope.solve(&l, solution);
            envelope.product(&a, &b, product);
        }
        for [x, y] in [&products, &solutions] {
            assert!(x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-13));
        }
        let mut indefinite = a.clone();
        indefinite[n * n - 1] = -1.0;
        assert!(thin.factor(&mut indefinite).is_err());
    }
}
