//! Factors of I - g J, and of the pair of such equations that complex eigenvalues of a method make.

use super::SMALL;
use crate::linear::{Singular, lu_factor_diagonal, lu_solve};
use crate::sparse::{Pattern, SparseLu};

/// Factors of a matrix of either kind.
pub(super) enum Factors {
    None,
    Dense { lu: Vec<f64>, pivots: Vec<usize> },
    Sparse(Box<SparseLu>),
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
    pub(super) fn take(&mut self, pattern: Option<&Pattern>) {
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

    pub(super) fn eliminate(&mut self, g: f64, c: f64, jacobian: &[f64]) -> Result<(), Singular> {
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
                lu_factor_diagonal(lu, pivots)
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
    pub(super) fn solve(&mut self, b: &mut [f64]) {
        match self {
            Factors::None => {}
            Factors::Dense { lu, pivots } => lu_solve(lu, pivots, b),
            Factors::Sparse(lu) => lu.solve(b),
        }
    }
}
