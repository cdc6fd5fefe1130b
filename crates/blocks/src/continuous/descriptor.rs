//! From `E x' = f`, with a constant `E` that may be singular, to as many differential equations as `E` has independent rows,
//! and constraints.

use blocksim_block::ParamError;
use nalgebra::DMatrix;

/// Least size of a pivot, beside the greatest, that is not zero but for rounding, and greatest of one that is, for each row.
const CLEAR: f64 = 1e-10;
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// How often rows and columns are brought to like sizes.
const SWEEPS: usize = 4;

/// With `x` sorted into `p`, first the differential part `x1`, then the algebraic one `z`:
///
/// `w = x1 + T z` are the states, `w' = F f` and `0 = G f`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reduction {
    /// Which of `x` is which: those of the differential part in the order of the states, then the others.
    pub order: Vec<usize>,
    pub t: DMatrix<f64>,
    pub f: DMatrix<f64>,
    pub g: DMatrix<f64>,
}

/// How near to singular a matrix is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rank {
    /// So many independent rows.
    Of(usize),
    /// A pivot of this size, beside the greatest, is neither zero nor clearly not.
    Unclear(f64),
}

/// Rows and columns brought to like sizes by powers of two: `rows A columns`.
pub(crate) struct Scaled {
    pub matrix: DMatrix<f64>,
    pub rows: Vec<f64>,
    pub columns: Vec<f64>,
}

impl Scaled {
    pub fn new(mut matrix: DMatrix<f64>) -> Self {
        let (mut rows, mut columns) = (vec![1.0; matrix.nrows()], vec![1.0; matrix.ncols()]);
        for _ in 0..SWEEPS {
            for (mut row, scale) in matrix.row_iter_mut().zip(&mut rows) {
                let factor = inverse(row.amax());
                row.scale_mut(factor);
                *scale *= factor;
            }
            for (mut column, scale) in matrix.column_iter_mut().zip(&mut columns) {
                let factor = inverse(column.amax());
                column.scale_mut(factor);
                *scale *= factor;
            }
        }
        Self { matrix, rows, columns }
    }

    /// The rank, by the diagonal of a factorisation with exchange of columns.
    pub fn rank(&self) -> Rank {
        if self.matrix.is_empty() {
            return Rank::Of(0);
        }
        let n = self.matrix.nrows().max(self.matrix.ncols()) as f64;
        let diagonal = self.matrix.clone().col_piv_qr().r().diagonal();
        let greatest = diagonal.amax();
        let shares = diagonal.iter().map(|pivot| if greatest > 0.0 { pivot.abs() / greatest } else { 0.0 });
        let shares: Vec<f64> = shares.collect();
        match shares.iter().find(|share| (n * ROUNDING..CLEAR).contains(*share)) {
            Some(share) => Rank::Unclear(*share),
            None => Rank::Of(shares.iter().filter(|share| **share >= CLEAR).count()),
        }
    }
}

/// The power of two that brings a number to a size of about one.
fn inverse(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() { (-size.log2().round()).clamp(-500.0, 500.0).exp2() } else { 1.0 }
}

impl Reduction {
    /// # Errors
    /// The size of a pivot that is neither zero nor clearly not.
    pub fn new(e: DMatrix<f64>) -> Result<Self, f64> {
        let n = e.nrows();
        let scaled = Scaled::new(e);
        let r = match scaled.rank() {
            Rank::Of(r) => r,
            Rank::Unclear(share) => return Err(share),
        };
        let Scaled { matrix, rows, columns } = scaled;
        let parts = matrix.col_piv_qr();
        let mut places = DMatrix::from_fn(1, n, |_, j| j as f64);
        parts.p().permute_columns(&mut places);
        let order: Vec<usize> = places.iter().map(|place| *place as usize).collect();
        let (mut q, upper) = (parts.q().transpose(), parts.r());
        for (mut column, scale) in q.column_iter_mut().zip(&rows) {
            column.scale_mut(*scale);
        }
        let r11 = upper.view((0, 0), (r, r)).clone_owned();
        let solved = |right: DMatrix<f64>| r11.solve_upper_triangular(&right).unwrap_or(right);
        let mut t = solved(upper.view((0, r), (r, n - r)).clone_owned());
        let mut f = solved(q.view((0, 0), (r, n)).clone_owned());
        for i in 0..r {
            let own = columns[order[i]];
            f.row_mut(i).scale_mut(own);
            for j in 0..n - r {
                t[(i, j)] *= own / columns[order[r + j]];
            }
        }
        let g = q.view((r, 0), (n - r, n)).clone_owned();
        Ok(Self { order, t, f, g })
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        self.f.nrows()
    }

    /// Number of constraints.
    pub fn constraints(&self) -> usize {
        self.g.nrows()
    }

    /// Which of `x` are found from the constraints.
    pub fn algebraic(&self) -> &[usize] {
        &self.order[self.states()..]
    }

    /// States that belong to an `x`.
    pub fn states_of(&self, x: &[f64]) -> Vec<f64> {
        let algebraic = self.algebraic();
        let state = |i: usize| {
            let moved: f64 = algebraic.iter().enumerate().map(|(j, &place)| self.t[(i, j)] * x[place]).sum();
            x[self.order[i]] + moved
        };
        (0..self.states()).map(state).collect()
    }

    /// What a state is called: as the `x` that it is, if it is one.
    pub fn name(&self, state: usize) -> String {
        let is_one = self.t.row(state).iter().all(|share| *share == 0.0);
        format!("{}{}", if is_one { "x" } else { "w" }, self.order[state] + 1)
    }
}

/// A product in which sums of nothing but rounding are zero.
pub(crate) fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(a.nrows(), b.ncols(), |i, j| {
        let terms = || a.row(i).transpose().component_mul(&b.column(j));
        let (sum, size) = (terms().sum(), terms().abs().sum());
        if sum.abs() <= 16.0 * f64::EPSILON * size { 0.0 } else { sum }
    })
}

/// The matrix of a list of rows.
pub(crate) fn matrix(rows: &[Vec<f64>], columns: usize) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j])
}

/// A matrix of which nobody can say whether it is singular.
pub(crate) fn undecided(name: &str, share: f64) -> ParamError {
    let message = format!(
        "`{name}` is neither regular nor singular by a clear margin: with rows and columns scaled to like sizes, a pivot is {share:.1e} of \
         the largest"
    );
    ParamError::new(name, message)
        .help("write dependent rows with all their digits, or make the small difference larger")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagonal_matrix_keeps_its_states_and_their_names() {
        let e = DMatrix::from_row_slice(3, 3, &[2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1e-12]);
        let found = Reduction::new(e).unwrap();
        assert_eq!((found.states(), found.algebraic()), (2, &[1][..]));
        let mut names = [found.name(0), found.name(1)];
        names.sort();
        assert_eq!(names, ["x1", "x3"]);
        // w' = F f: f0 / 2 and f2 / 1e-12, wherever they stand.
        for i in 0..2 {
            let (own, scale) = if found.order[i] == 0 { (0, 0.5) } else { (2, 1e12) };
            for j in 0..3 {
                let expected = if j == own { scale } else { 0.0 };
                assert!((found.f[(i, j)] - expected).abs() <= 1e-15 * scale, "{}", found.f);
            }
        }
    }

    #[test]
    fn dependent_rows_become_constraints_whatever_their_units() {
        // Capacitors between two nodes: C (v0 - v1)' = f0 = -f1.
        for (row, column) in [(1.0, 1.0), (1e-9, 1.0), (1.0, 1e9)] {
            let c = 1e-6;
            let e = DMatrix::from_row_slice(2, 2, &[c, -c * column, -c * row, c * row * column]);
            let found = Reduction::new(e).unwrap();
            assert_eq!(found.states(), 1);
            // 0 = row f0 + f1.
            assert!((found.g[(0, 0)] / found.g[(0, 1)] - row).abs() < 1e-12 * row, "{}", found.g);
        }
    }

    #[test]
    fn a_matrix_that_is_hardly_singular_is_not_decided() {
        let e = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0 + 1e-12]);
        let share = Reduction::new(e).unwrap_err();
        assert!((1e-13..1e-11).contains(&share), "{share}");
    }
}
