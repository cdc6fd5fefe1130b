//! What of the tool is prescribed along a path, and the joint motion that does it.
//!
//! With the rows A = T J of the Jacobian that are prescribed and the derivatives x', x'' of what they prescribe by the
//! length of the path, least motion of the axes is
//!
//! $$ q' = A^\top\lambda, \quad A A^\top \lambda = x', \qquad
//!    q'' = A'^\top\lambda + A^\top (A A^\top)^{-1} (x'' - A' q' - A A'^\top \lambda) $$
//!
//! the second being the derivative of the first; where as much is prescribed as there are axes, $q' = A^{-1} x'$ and
//! $q'' = A^{-1}(x'' - A' q')$, and where more is prescribed, which the axes can do or not, the pseudoinverse takes the
//! place of the inverse.

use crate::motion::PathPoint;
use blocksim_multibody::{Placement, rotation_vector};
use nalgebra::{DMatrix, DVector, Vector3};

use crate::planner::arm::Arm;

/// What is prescribed.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Task {
    /// Position.
    Point,
    /// Position and direction of z; two unit vectors across it.
    Axis(Vector3<f64>, [Vector3<f64>; 2]),
    /// Position and orientation.
    Pose,
}

/// Singular values below this, in m and rad, count as none where a singular pose is passed.
const CUT: f64 = 1e-7;

/// How well the axes must be able to follow, relative.
const FOLLOWS: f64 = 1e-6;

impl Task {
    /// Position and the direction of z as in `start`.
    pub fn axis(start: &Placement) -> Task {
        let column = |i: usize| start.rotation.column(i).into_owned();
        Task::Axis(column(2), [column(0), column(1)])
    }

    /// The rows of a matrix of six that are prescribed.
    fn rows(&self, full: &DMatrix<f64>) -> DMatrix<f64> {
        match self {
            Task::Pose => full.clone(),
            Task::Point => full.rows(3, 3).into_owned(),
            Task::Axis(_, across) => {
                let n = full.ncols();
                DMatrix::from_fn(5, n, |row, column| match row {
                    0 | 1 => (0..3).map(|k| across[row][k] * full[(k, column)]).sum(),
                    _ => full[(row + 1, column)],
                })
            }
        }
    }

    fn vector(&self, angular: &Vector3<f64>, linear: &Vector3<f64>) -> DVector<f64> {
        let linear = linear.iter().copied();
        match self {
            Task::Pose => DVector::from_iterator(6, angular.iter().copied().chain(linear)),
            Task::Point => DVector::from_iterator(3, linear),
            Task::Axis(_, across) => {
                DVector::from_iterator(5, across.iter().map(|u| u.dot(angular)).chain(linear))
            }
        }
    }

    /// How far the tool is from where it shall be.
    fn miss(&self, at: &Placement, shall: &Placement) -> DVector<f64> {
        let linear = shall.translation - at.translation;
        let angular = match self {
            Task::Point => Vector3::zeros(),
            Task::Pose => rotation_vector(&(shall.rotation * at.rotation.transpose())),
            Task::Axis(z, _) => Vector3::from(at.rotation.column(2)).cross(z),
        };
        self.vector(&angular, &linear)
    }

    /// How far the tool is from where it shall be at `q`, m and rad.
    pub fn deviation(&self, arm: &mut Arm, shall: &Placement, q: &[f64]) -> f64 {
        arm.look(q);
        self.miss(&arm.tool, shall).amax()
    }

    /// Puts the tool where it shall be, by Newton's method from `q`; the largest deviation that is left, or `None`
    /// where this does not converge or leads far away.
    pub fn settle(&self, arm: &mut Arm, shall: &Placement, q: &mut [f64]) -> Option<f64> {
        const GOOD: f64 = 1e-13;
        const ENOUGH: f64 = 1e-10;
        const STRIDE: f64 = 0.5;
        let mut last = f64::INFINITY;
        for _ in 0..12 {
            arm.look(q);
            let miss = self.miss(&arm.tool, shall);
            let size = miss.amax();
            if size <= GOOD || (size <= ENOUGH && size >= 0.5 * last) {
                return Some(size);
            }
            last = size;
            let a = self.rows(&arm.jacobian);
            let step = solve(&a, &miss)?;
            // not so for NaN
            let near = step.amax() < STRIDE;
            if !near {
                return None;
            }
            q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q += step);
        }
        (last <= ENOUGH).then_some(last)
    }

    /// q' and q'' along the path at `q`, which is on it.
    pub fn derivatives(
        &self,
        arm: &mut Arm,
        point: &PathPoint,
        q: &[f64],
    ) -> Option<(DVector<f64>, DVector<f64>)> {
        arm.look(q);
        let a = self.rows(&arm.jacobian);
        let first = self.vector(&point.turn, &point.tangent);
        let (m, n) = a.shape();
        if m == n {
            let lu = a.clone().lu();
            let by_lu = |b: &DVector<f64>| lu.solve(b).filter(|x| follows(&a, x, b) && x.amax() < 1e6);
            let invert = |b: &DVector<f64>| by_lu(b).or_else(|| by_singular_values(&a, b));
            let dq = invert(&first)?;
            arm.look_moving(q, dq.as_slice());
            let second = self.vector(&Vector3::zeros(), &point.curvature) - self.rows(&arm.slope) * &dq;
            return Some((dq, invert(&second)?));
        }
        if m > n {
            let dq = by_singular_values(&a, &first)?;
            arm.look_moving(q, dq.as_slice());
            let second = self.vector(&Vector3::zeros(), &point.curvature) - self.rows(&arm.slope) * &dq;
            return Some((dq, by_singular_values(&a, &second)?));
        }
        let gram = (&a * a.transpose()).cholesky()?;
        let lambda = gram.solve(&first);
        let dq = a.transpose() * &lambda;
        if !follows(&a, &dq, &first) {
            return None;
        }
        arm.look_moving(q, dq.as_slice());
        let slope = self.rows(&arm.slope);
        let across = slope.transpose() * &lambda;
        let second = self.vector(&Vector3::zeros(), &point.curvature) - slope * &dq - &a * &across;
        Some((dq, across + a.transpose() * gram.solve(&second)))
    }

    /// The smallest singular value of what is prescribed, m and rad: 0 where the arm is singular.
    pub fn margin(&self, arm: &Arm) -> f64 {
        let a = self.rows(&arm.jacobian);
        let gram = if a.nrows() > a.ncols() { a.tr_mul(&a) } else { &a * a.transpose() };
        let least = gram.symmetric_eigenvalues().iter().fold(f64::INFINITY, |m, e| m.min(*e));
        least.max(0.0).sqrt()
    }
}

/// The least x with A x = b. Where there are more rows than axes it is that of least squares: nearer to its end Newton's
/// method tells whether the axes can do it.
fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let (m, n) = a.shape();
    if m == n {
        return match a.clone().lu().solve(b) {
            Some(x) if x.amax() < 1.0 && follows(a, &x, b) => Some(x),
            _ => by_singular_values(a, b),
        };
    }
    if m > n {
        return a.clone().svd(true, true).solve(b, CUT).ok();
    }
    match (a * a.transpose()).cholesky() {
        Some(gram) => Some(a.transpose() * gram.solve(b)),
        None => by_singular_values(a, b),
    }
}

/// As [`solve`], in singular poses too, where b is something that the axes can do.
fn by_singular_values(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let x = a.clone().svd(true, true).solve(b, CUT).ok()?;
    follows(a, &x, b).then_some(x)
}

fn follows(a: &DMatrix<f64>, x: &DVector<f64>, b: &DVector<f64>) -> bool {
    (a * x - b).amax() <= FOLLOWS * b.amax().max(1e-6)
}
