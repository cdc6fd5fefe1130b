//! Loops that are affine in their unknowns: z = A z + b is solved by elimination.
//!
//! b is what the loop gives for z = 0, so nothing depends on what was tried before. What z leaves over is eliminated once more
//! (iterative refinement; N. J. Higham: Accuracy and Stability of Numerical Algorithms, chapter 12), which takes out what the
//! elimination itself has lost. A loop whose solution hangs on rounding is refused: its condition is the greatest eigenvalue of
//! |(1 - A)^-1| (1 + |A|), which does not depend on units (R. D. Skeel: Scaling for numerical stability in Gaussian elimination,
//! J. ACM 26 (1979) 494-526; F. L. Bauer: Optimally scaled matrices, Numer. Math. 5 (1963) 73-87).

use blocksim_solve::linear::{lu_factor, lu_solve};

use super::Why;
use super::newton::{Given, Work};

/// Error of a solution, as a part of it, that rounding of the loop's numbers may cause.
pub(super) const LOST: f64 = 1e-6;
/// Corrections, as a part of a value, that are not worth another evaluation.
const ROUNDED: f64 = 8.0 * f64::EPSILON;
/// Most refinements.
const REFINEMENTS: usize = 4;
/// Unknowns up to which the condition of slopes that vary is looked at each time.
const FEW: usize = 8;
/// Iterations by which an eigenvalue is found well enough.
const ITERATIONS: usize = 12;

/// The factors of 1 - A.
#[derive(Default)]
pub(super) struct Factors {
    lu: Vec<f64>,
    pivots: Vec<usize>,
    inverse: Vec<f64>,
    vectors: [Vec<f64>; 2],
    /// Whether slopes never change.
    stays: bool,
    is_known: bool,
}

impl Factors {
    /// Room for `n` unknowns; `stays` tells whether slopes never change.
    pub fn new(n: usize, stays: bool) -> Self {
        let inverse = if stays || n <= FEW { n * n } else { 0 };
        let zeros = || vec![0.0; n];
        Self {
            lu: vec![0.0; n * n],
            pivots: vec![0; n],
            inverse: vec![0.0; inverse],
            vectors: [zeros(), zeros()],
            stays,
            is_known: false,
        }
    }

    /// Factors 1 - A.
    fn make(&mut self, n: usize, slopes: &[f64]) -> Result<(), Why> {
        self.is_known = false;
        if slopes.iter().any(|slope| !slope.is_finite()) {
            return Err(Why::NotFinite);
        }
        for (k, (lu, slope)) in self.lu.iter_mut().zip(slopes).enumerate() {
            *lu = f64::from(u8::from(k / n == k % n)) - slope;
        }
        lu_factor(&mut self.lu, &mut self.pivots).map_err(|_| Why::Singular)?;
        if !self.inverse.is_empty() && self.condition(n, slopes) * f64::EPSILON > LOST {
            return Err(Why::Singular);
        }
        self.is_known = self.stays;
        Ok(())
    }

    /// The greatest eigenvalue of |(1 - A)^-1| (1 + |A|), roughly.
    fn condition(&mut self, n: usize, slopes: &[f64]) -> f64 {
        let Self { lu, pivots, inverse, vectors: [v, w], .. } = self;
        // Of which the columns stand in rows.
        for (j, column) in inverse.chunks_exact_mut(n).enumerate() {
            column.fill(0.0);
            column[j] = 1.0;
            lu_solve(lu, pivots, column);
        }
        v.fill(1.0);
        let mut grown = 1.0;
        for _ in 0..ITERATIONS {
            for (i, w) in w.iter_mut().enumerate() {
                let row = slopes[i * n..(i + 1) * n].iter().zip(&*v);
                *w = v[i] + row.map(|(slope, v)| slope.abs() * v).sum::<f64>();
            }
            for (i, v) in v.iter_mut().enumerate() {
                *v = w.iter().enumerate().map(|(j, w)| inverse[j * n + i].abs() * w).sum();
            }
            let size = v.iter().fold(0.0, |size: f64, v| size.max(*v));
            if !(size > 0.0 && size.is_finite()) {
                return f64::INFINITY;
            }
            grown = size;
            v.iter_mut().for_each(|v| *v /= size);
        }
        grown
    }
}

impl Work {
    /// Solves F(z) = z, where F is affine.
    pub(super) fn eliminate(
        &mut self,
        n: usize,
        factors: &mut Factors,
        given: &mut impl Given,
    ) -> Result<(), Why> {
        let Self { z, f, step, next, slopes, tried, .. } = self;
        let (z, f, step, next) = (&mut z[..n], &mut f[..n], &mut step[..n], &mut next[..n]);
        let slopes = &mut slopes[..n * n];
        tried.clear();
        z.fill(0.0);
        given.evaluate(z, f).ok_or(Why::Block)?;
        if !factors.is_known {
            if !given.slopes(z, slopes, next) {
                return Err(Why::NotFinite);
            }
            factors.make(n, slopes)?;
        }
        z.copy_from_slice(f);
        lu_solve(&factors.lu, &factors.pivots, z);
        let mut before = f64::INFINITY;
        for refinement in 1.. {
            if z.iter().any(|z| !z.is_finite()) {
                return Err(Why::NotFinite);
            }
            given.evaluate(z, f).ok_or(Why::Block)?;
            (0..n).for_each(|i| step[i] = f[i] - z[i]);
            lu_solve(&factors.lu, &factors.pivots, step);
            let share = |i: usize| step[i].abs() / z[i].abs().max(f[i].abs());
            let left = (0..n).map(share).fold(0.0, |most: f64, share| most.max(share));
            // What cancels has fewer digits than it has been made of, and does not get better.
            if left <= ROUNDED || left >= 0.5 * before || refinement == REFINEMENTS {
                break;
            }
            before = left;
            (0..n).for_each(|i| z[i] += step[i]);
        }
        if factors.inverse.is_empty() {
            let is_lost = |i: usize| {
                let row = slopes[i * n..(i + 1) * n].iter().zip(&*z);
                let size = z[i].abs() + row.map(|(slope, z)| (slope * z).abs()).sum::<f64>();
                step[i].abs() > LOST * size
            };
            if (0..n).any(is_lost) {
                return Err(Why::Singular);
            }
        }
        Ok(())
    }
}
