//! One damped step of least squares between bounds.

use crate::kinematics::range::JointRange;
use crate::kinematics::residual::Rows;
use blocksim_solve::linear::{cholesky_factor, cholesky_solve};

/// `(JᵀJ + λ 1) δ = -Jᵀ r` with joints held that stand at a bound and would leave it.
#[derive(Debug, Clone, Default)]
pub(crate) struct NormalEquations {
    n: usize,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
    factor: Vec<f64>,
    step: Vec<f64>,
}

impl NormalEquations {
    pub fn new(n: usize) -> Self {
        let (square, line) = (vec![0.0; n * n], vec![0.0; n]);
        NormalEquations { n, matrix: square.clone(), gradient: line.clone(), factor: square, step: line }
    }

    /// Takes in residuals and Jacobian at q.
    pub fn fill(&mut self, rows: &Rows, q: &[f64], ranges: &[JointRange]) {
        let n = self.n;
        self.matrix.fill(0.0);
        self.gradient.fill(0.0);
        for (row, r) in rows.j.chunks_exact(n).zip(&rows.r) {
            for i in 0..n {
                self.gradient[i] += row[i] * r;
                for j in 0..=i {
                    self.matrix[i * n + j] += row[i] * row[j];
                }
            }
        }
        for i in 0..n {
            let (range, down) = (&ranges[i], self.gradient[i] > 0.0);
            let held = if down { q[i] <= range.lower } else { q[i] >= range.upper };
            if held {
                self.gradient[i] = 0.0;
                (0..n).for_each(|j| self.matrix[i.max(j) * n + i.min(j)] = 0.0);
            }
        }
    }

    /// Largest entry of the gradient.
    pub fn slope(&self) -> f64 {
        self.gradient.iter().fold(0.0, |m, g| m.max(g.abs()))
    }

    /// The step for a damping above zero, `None` where rounding leaves none.
    pub fn step(&mut self, damping: f64) -> Option<&[f64]> {
        let n = self.n;
        self.factor.copy_from_slice(&self.matrix);
        for i in 0..n {
            self.factor[i * n + i] += damping;
            self.step[i] = -self.gradient[i];
        }
        cholesky_factor(&mut self.factor, n).ok()?;
        cholesky_solve(&self.factor, &mut self.step);
        Some(&self.step)
    }
}
