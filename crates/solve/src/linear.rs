//! Small dense systems of linear equations, in place and without allocation. Matrices are square and row-major: entry
//! (i, j) of an n by n matrix is `a[i * n + j]`.

/// The matrix has no factorisation: elimination met a pivot that is zero, negative where it must be positive, or not
/// finite, in this column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Singular {
    /// Index of the column.
    pub column: usize,
}

impl std::fmt::Display for Singular {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(out, "no pivot in column {}", self.column)
    }
}

impl std::error::Error for Singular {}

/// Runs a kernel whose last argument is a size. Small sizes are told to the compiler, which unrolls their loops and drops
/// their checks: that halves the time of the systems that robots have.
macro_rules! sized {
    ($kernel:ident($($argument:expr),*; $n:expr)) => {
        match $n {
            1 => $kernel($($argument,)* 1),
            2 => $kernel($($argument,)* 2),
            3 => $kernel($($argument,)* 3),
            4 => $kernel($($argument,)* 4),
            5 => $kernel($($argument,)* 5),
            6 => $kernel($($argument,)* 6),
            7 => $kernel($($argument,)* 7),
            8 => $kernel($($argument,)* 8),
            n => $kernel($($argument,)* n),
        }
    };
}

/// Overwrites `a` with L and U such that P a = L U (L has ones on its diagonal) by Gaussian elimination with partial
/// pivoting; row i was exchanged with row `pivots[i]`. n is the length of `pivots`.
///
/// # Errors
/// [`Singular`] when all candidates for a pivot are zero or one is not finite; `a` is then half done.
pub fn lu_factor(a: &mut [f64], pivots: &mut [usize]) -> Result<(), Singular> {
    sized!(eliminate(a, pivots, 1.0; pivots.len()))
}

/// The part of the largest candidate from which on what stands on the diagonal is the pivot of [`lu_factor_diagonal`].
const PREFERRED: f64 = 1e-8;

/// The same for I - g J, with pivots on the diagonal unless these are lost. A state then gets nothing of those that it does not depend on,
/// not even their rounding: what rests at zero beside others that move stays there. Pivots of rows that are large because of their units
/// are no better, and for the others the matrix of an iteration has digits to spare.
///
/// # Errors
/// As [`lu_factor`].
pub fn lu_factor_diagonal(a: &mut [f64], pivots: &mut [usize]) -> Result<(), Singular> {
    sized!(eliminate(a, pivots, PREFERRED; pivots.len()))
}

#[inline(always)]
fn eliminate(a: &mut [f64], pivots: &mut [usize], preferred: f64, n: usize) -> Result<(), Singular> {
    let (a, pivots) = (&mut a[..n * n], &mut pivots[..n]);
    for k in 0..n {
        let mut p = k;
        for i in k + 1..n {
            if a[i * n + k].abs() > a[p * n + k].abs() {
                p = i;
            }
        }
        if a[k * n + k].abs() >= preferred * a[p * n + k].abs() {
            p = k;
        }
        pivots[k] = p;
        if p != k {
            for j in 0..n {
                a.swap(k * n + j, p * n + j);
            }
        }
        let pivot = a[k * n + k];
        if pivot == 0.0 || !pivot.is_finite() {
            return Err(Singular { column: k });
        }
        let (above, below) = a.split_at_mut((k + 1) * n);
        let row = &above[k * n + k + 1..];
        for other in below.chunks_exact_mut(n) {
            let factor = other[k] / pivot;
            other[k] = factor;
            // Jacobians of networks are sparse; a zero row costs nothing.
            if factor != 0.0 {
                for (o, r) in other[k + 1..].iter_mut().zip(row) {
                    *o -= factor * r;
                }
            }
        }
    }
    Ok(())
}

/// Overwrites `b` with the solution x of a x = b, from the factors of [`lu_factor`].
pub fn lu_solve(lu: &[f64], pivots: &[usize], b: &mut [f64]) {
    sized!(substitute(lu, pivots, b; pivots.len()));
}

#[inline(always)]
fn substitute(lu: &[f64], pivots: &[usize], b: &mut [f64], n: usize) {
    let (lu, pivots, b) = (&lu[..n * n], &pivots[..n], &mut b[..n]);
    for (i, &p) in pivots.iter().enumerate() {
        b.swap(i, p);
    }
    for i in 1..n {
        b[i] -= dot(&lu[i * n..i * n + i], &b[..i]);
    }
    for i in (0..n).rev() {
        b[i] = (b[i] - dot(&lu[i * n + i + 1..(i + 1) * n], &b[i + 1..n])) / lu[i * n + i];
    }
}

/// Overwrites the lower triangle of the symmetric positive definite n by n matrix `a` with L such that a = L L^T; on its
/// diagonal stand the reciprocals of that of L. The strict upper triangle is neither read nor written.
///
/// # Errors
/// [`Singular`] when `a` is not positive definite; it is then half done.
pub fn cholesky_factor(a: &mut [f64], n: usize) -> Result<(), Singular> {
    sized!(factor(a; n))
}

#[inline(always)]
fn factor(a: &mut [f64], n: usize) -> Result<(), Singular> {
    let a = &mut a[..n * n];
    for i in 0..n {
        let (above, rest) = a.split_at_mut(i * n);
        let row = &mut rest[..n];
        for j in 0..i {
            let other = &above[j * n..j * n + j + 1];
            row[j] = (row[j] - dot(&row[..j], &other[..j])) * other[j];
        }
        let square = row[i] - dot(&row[..i], &row[..i]);
        if square.is_nan() || square <= 0.0 || square == f64::INFINITY {
            return Err(Singular { column: i });
        }
        row[i] = 1.0 / square.sqrt();
    }
    Ok(())
}

/// Overwrites `b` with the solution x of a x = b, from the factor of [`cholesky_factor`]. n is the length of `b`.
pub fn cholesky_solve(l: &[f64], b: &mut [f64]) {
    sized!(solve(l, b; b.len()));
}

#[inline(always)]
fn solve(l: &[f64], b: &mut [f64], n: usize) {
    let (l, b) = (&l[..n * n], &mut b[..n]);
    for i in 0..n {
        b[i] = (b[i] - dot(&l[i * n..i * n + i], &b[..i])) * l[i * n + i];
    }
    for i in (0..n).rev() {
        let mut sum = b[i];
        for j in i + 1..n {
            sum -= l[j * n + i] * b[j];
        }
        b[i] = sum * l[i * n + i];
    }
}

/// Overwrites the n by m matrix `b` with the solution X of a X = b, from the factor of [`cholesky_factor`]; cheaper than
/// column by column.
pub fn cholesky_solve_matrix(l: &[f64], n: usize, b: &mut [f64]) {
    if b.len() == n * n {
        return sized!(solve_square(l, b; n));
    }
    sized!(solve_wide(l, b; n));
}

/// As many columns as rows: their number is known to the compiler as well.
#[inline(always)]
fn solve_square(l: &[f64], b: &mut [f64], n: usize) {
    solve_matrix(l, b, n, n);
}

#[inline(always)]
fn solve_wide(l: &[f64], b: &mut [f64], n: usize) {
    if n > 0 {
        solve_matrix(l, b, n, b.len() / n);
    }
}

#[inline(always)]
fn solve_matrix(l: &[f64], b: &mut [f64], n: usize, m: usize) {
    let (l, b) = (&l[..n * n], &mut b[..n * m]);
    for i in 0..n {
        let (above, rest) = b.split_at_mut(i * m);
        let row = &mut rest[..m];
        for j in 0..i {
            let factor = l[i * n + j];
            row.iter_mut().zip(&above[j * m..(j + 1) * m]).for_each(|(to, from)| *to -= factor * from);
        }
        row.iter_mut().for_each(|to| *to *= l[i * n + i]);
    }
    for i in (0..n).rev() {
        let (rest, below) = b.split_at_mut((i + 1) * m);
        let row = &mut rest[i * m..];
        for j in i + 1..n {
            let factor = l[j * n + i];
            let from = &below[(j - i - 1) * m..(j - i) * m];
            row.iter_mut().zip(from).for_each(|(to, from)| *to -= factor * from);
        }
        row.iter_mut().for_each(|to| *to *= l[i * n + i]);
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in -1..1 that look random (Weyl's sequence).
    fn scattered(count: usize) -> Vec<f64> {
        (1..=count)
            .map(|i| 2.0 * (i as f64 * 0.618_033_988_749_894_9).fract() - 1.0)
            .map(|v| v * v * v)
            .collect()
    }

    fn times(a: &[f64], x: &[f64]) -> Vec<f64> {
        a.chunks_exact(x.len()).map(|row| dot(row, x)).collect()
    }

    #[test]
    fn what_depends_on_nothing_else_gets_no_rounding_of_it() {
        // The first two depend on each other alone, the third on all.
        let start = [1.9, -2.7, 0.0, 2.5, 2.3, 0.0, 700.3, -31.1, 1.5];
        for (factor, is_exact) in
            [(lu_factor_diagonal as fn(&mut [f64], &mut [usize]) -> _, true), (lu_factor, false)]
        {
            let (mut lu, mut pivots, mut b) = (start, [0; 3], [0.0, 0.0, 0.1]);
            factor(&mut lu, &mut pivots).unwrap();
            lu_solve(&lu, &pivots, &mut b);
            assert!((b[2] - 0.1 / 1.5).abs() < 1e-15, "{b:?}");
            assert_eq!(b[..2] == [0.0, 0.0], is_exact, "{b:?}");
        }
        // A zero on the diagonal cannot be a pivot.
        let (mut lu, mut pivots, mut b) = ([0.0, 1.0, 1.0, 0.0], [0; 2], [2.0, 3.0]);
        lu_factor_diagonal(&mut lu, &mut pivots).unwrap();
        lu_solve(&lu, &pivots, &mut b);
        assert_eq!(b, [3.0, 2.0]);
    }

    #[test]
    fn elimination_solves_what_multiplication_made() {
        for n in [1, 2, 3, 7, 20] {
            let a = scattered(n * n);
            let x: Vec<f64> = (0..n).map(|i| i as f64 - 2.5).collect();
            let (mut lu, mut b, mut pivots) = (a.clone(), times(&a, &x), vec![0; n]);
            lu_factor(&mut lu, &mut pivots).unwrap();
            lu_solve(&lu, &pivots, &mut b);
            for (b, x) in b.iter().zip(&x) {
                assert!((b - x).abs() < 1e-10, "n = {n}: {b} instead of {x}");
            }
        }
    }

    #[test]
    fn pivoting_copes_with_a_zero_on_the_diagonal() {
        let (mut a, mut pivots, mut b) = ([0.0, 2.0, 3.0, 4.0], [0; 2], [2.0, 7.0]);
        lu_factor(&mut a, &mut pivots).unwrap();
        lu_solve(&a, &pivots, &mut b);
        assert_eq!(b, [1.0, 1.0]);
    }

    #[test]
    fn a_singular_matrix_names_the_column() {
        let mut pivots = [0; 2];
        assert_eq!(lu_factor(&mut [1.0, 2.0, 2.0, 4.0], &mut pivots), Err(Singular { column: 1 }));
        assert_eq!(lu_factor(&mut [f64::NAN, 2.0, 2.0, 4.0], &mut pivots), Err(Singular { column: 0 }));
        assert_eq!(cholesky_factor(&mut [1.0, 0.0, 2.0, 4.0], 2), Err(Singular { column: 1 }));
        assert_eq!(cholesky_factor(&mut [f64::NAN], 1), Err(Singular { column: 0 }));
    }

    #[test]
    fn cholesky_solves_and_leaves_the_upper_triangle_alone() {
        for n in [1, 2, 5, 12] {
            let m = scattered(n * n);
            // m m^T + 1 is positive definite.
            let mut a = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..n {
                    a[i * n + j] = dot(&m[i * n..(i + 1) * n], &m[j * n..(j + 1) * n]) + f64::from(i == j);
                }
            }
            let x: Vec<f64> = (0..n).map(|i| 1.0 - i as f64).collect();
            let mut b = times(&a, &x);
            // The same, three times beside each other.
            let mut matrix: Vec<f64> = b.iter().flat_map(|b| [*b, 2.0 * b, -b]).collect();
            let upper: Vec<f64> = (1..n).map(|j| a[j]).collect();
            cholesky_factor(&mut a, n).unwrap();
            cholesky_solve(&a, &mut b);
            cholesky_solve_matrix(&a, n, &mut matrix);
            assert_eq!(upper, a[1..n]);
            for ((b, row), x) in b.iter().zip(matrix.chunks_exact(3)).zip(&x) {
                assert!((b - x).abs() < 1e-12, "n = {n}: {b} instead of {x}");
                for (found, factor) in row.iter().zip([1.0, 2.0, -1.0]) {
                    assert!((found - factor * x).abs() < 2e-12, "n = {n}: {row:?} instead of {x}");
                }
            }
        }
    }

    #[test]
    fn nothing_to_solve_is_no_error() {
        assert_eq!(lu_factor(&mut [], &mut []), Ok(()));
        lu_solve(&[], &[], &mut []);
        assert_eq!(cholesky_factor(&mut [], 0), Ok(()));
        cholesky_solve(&[], &mut []);
        cholesky_solve_matrix(&[], 0, &mut []);
    }
}
