//! Least squares for a handful of unknowns.

use blocksim_solve::linear::{lu_factor, lu_solve};

/// Sum of squares below which a system of equations counts as solved.
const SOLVED: f64 = 1e-26;

/// Steps of one search.
const PATIENCE: usize = 200;

/// Where the sum of the squares of the residuals is smallest, searched from `start` by the method of Levenberg and
/// Marquardt, and this sum. Residuals should be of one size for one size of the unknowns.
///
/// Source: D. W. Marquardt, J. Soc. Indust. Appl. Math. 11 (1963), doi 10.1137/0111030.
pub(super) fn least_squares<const N: usize>(
    residuals: impl Fn(&[f64; N]) -> [f64; N],
    start: [f64; N],
) -> ([f64; N], f64) {
    let square = |r: &[f64; N]| r.iter().map(|r| r * r).sum::<f64>();
    let mut x = start;
    let mut r = residuals(&x);
    let mut sum = square(&r);
    let mut damping = 1e-2;
    for _ in 0..PATIENCE {
        if sum < SOLVED || !sum.is_finite() {
            break;
        }
        let slopes = slopes(&residuals, &x);
        let mut improved = false;
        while damping < 1e12 {
            let Some(step) = damped_step(&slopes, &r, damping) else { break };
            // The unknowns are logarithms: no step changes them by more than a factor of e.
            let longest = step.iter().fold(1.0_f64, |longest, step| longest.max(step.abs()));
            let next = std::array::from_fn(|k| x[k] - step[k] / longest);
            let r_next = residuals(&next);
            let sum_next = square(&r_next);
            if sum_next < sum {
                improved = sum_next < sum * (1.0 - 1e-9);
                (x, r, sum) = (next, r_next, sum_next);
                damping = (0.1 * damping).max(1e-15);
                break;
            }
            damping *= 4.0;
        }
        if !improved {
            break;
        }
    }
    (x, sum)
}

/// Derivatives of residual `i` with respect to unknown `k`, at `[k][i]`.
fn slopes<const N: usize>(residuals: impl Fn(&[f64; N]) -> [f64; N], x: &[f64; N]) -> [[f64; N]; N] {
    const STEP: f64 = 1e-5;
    std::array::from_fn(|k| {
        let at = |by: f64| {
            let mut x = *x;
            x[k] += by;
            residuals(&x)
        };
        let (after, before) = (at(STEP), at(-STEP));
        std::array::from_fn(|i| 0.5 * (after[i] - before[i]) / STEP)
    })
}

/// `(J^T J + damping diag(J^T J)) step = J^T r`.
fn damped_step<const N: usize>(slopes: &[[f64; N]; N], r: &[f64; N], damping: f64) -> Option<[f64; N]> {
    let dot = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut normal = vec![0.0; N * N];
    let mut step = [0.0; N];
    for k in 0..N {
        for l in 0..N {
            normal[k * N + l] = dot(&slopes[k], &slopes[l]);
        }
        // An unknown without influence stays where it is.
        normal[k * N + k] += damping * normal[k * N + k] + 1e-30;
        step[k] = dot(&slopes[k], r);
    }
    let mut pivots = [0; N];
    lu_factor(&mut normal, &mut pivots).ok()?;
    lu_solve(&normal, &pivots, &mut step);
    step.iter().all(|step| step.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        // Rosenbrock's function.
        let (x, sum) = least_squares(|x| [10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]], [-1.2, 1.0]);
        assert!(sum < SOLVED && (x[0] - 1.0).abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12, "{x:?} {sum}");
    }

    #[test]
    fn where_nothing_fits_the_nearest_point_is_found() {
        let (x, sum) = least_squares(|x| [x[0] - 1.0, x[0] + 1.0 + 0.0 * x[1]], [5.0, 2.0]);
        assert!(x[0].abs() < 1e-6 && (sum - 2.0).abs() < 1e-9 && x[1] == 2.0, "{x:?} {sum}");
    }
}
