//! Poles: eigenvalues, and what they mean.

use nalgebra::linalg::{Schur, balancing};
use nalgebra::{Complex, DMatrix, DVector};

use crate::LinearError;
use crate::parts::parts;

/// Rounds of the QR iteration for each row after which it is given up.
const ROUNDS: usize = 200;
/// Parts of the entries on the diagonal below which one beside them is nothing, from the most careful on.
const SMALL: [f64; 4] = [f64::EPSILON, 1e-14, 1e-13, 1e-12];
/// Of a singular matrix, eigenvalues below this part of the largest are zero.
const SPREAD: f64 = 1e-7;

/// By how much a slow pole may differ in other coordinates, and what rounding leaves of one in any.
const SAME: f64 = 1e-3;
const LOST: f64 = 1e-13;

/// Poles of sampled systems this near to 1 are integrators.
pub(crate) const INTEGRATES: f64 = 1e-11;

/// A pole in words of control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// The pole; of a sampled system in the plane of z.
    pub pole: Complex<f64>,
    /// Distance from the origin of the pole in continuous time, rad/s.
    pub frequency: f64,
    /// Cosine of its angle against the negative real axis: 1 without oscillation, 0 without damping, negative if it
    /// grows. Of a pole at zero 1.
    pub damping: f64,
    /// Time in which it falls to 1/e, s; negative if it grows, infinite if it stays.
    pub time_constant: f64,
}

/// The eigenvalues of a matrix, sorted by size, of a pair the one with positive imaginary part first.
///
/// # Errors
/// [`LinearError::NotFinite`], [`LinearError::NoConvergence`].
pub fn poles(a: &DMatrix<f64>) -> Result<Vec<Complex<f64>>, LinearError> {
    Ok(poles_by_part(a)?.into_iter().map(|(pole, _)| pole).collect())
}

/// The same, each with the size of the fastest pole that its part of the matrix has: rounding moves it by some last digits of that.
/// Zero for a state that no circle leads back to, whose eigenvalue is an entry of the matrix.
///
/// # Errors
/// As [`poles`].
pub fn poles_by_part(a: &DMatrix<f64>) -> Result<Vec<(Complex<f64>, f64)>, LinearError> {
    if a.iter().any(|value| !value.is_finite()) {
        return Err(LinearError::NotFinite("A"));
    }
    let mut poles = Vec::with_capacity(a.nrows());
    for part in parts(a) {
        match part[..] {
            [one] => poles.push((Complex::new(a[(one, one)], 0.0), 0.0)),
            _ => {
                let own = of_part(a.select_rows(&part).select_columns(&part))?;
                let fastest = own.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
                poles.extend(own.into_iter().map(|pole| (pole, fastest)));
            }
        }
    }
    poles.sort_by(|(a, _), (b, _)| {
        let (size_a, size_b) = (a.norm(), b.norm());
        // Two of a pair differ in their last digit.
        let order = if (size_a - size_b).abs() <= 1e-12 * size_a.max(size_b) {
            std::cmp::Ordering::Equal
        } else {
            size_a.total_cmp(&size_b)
        };
        order.then(a.re.total_cmp(&b.re)).then(b.im.total_cmp(&a.im))
    });
    Ok(poles)
}

/// The eigenvalues of a part of a matrix in which everything depends on everything.
fn of_part(a: DMatrix<f64>) -> Result<Vec<Complex<f64>>, LinearError> {
    let n = a.nrows();
    let (a, _) = balanced(a);
    // What is small enough to be nothing is measured by the diagonal beside it. Where that is zero, as with poles that a delay
    // of samples has, nothing is, unless all are moved away from zero. Some matrices, such as permutations, look the same after
    // a step of the iteration; turned a little they do not. And of some the last digits never come to rest.
    let size = a.norm();
    let tries = SMALL
        .iter()
        .flat_map(|small| [(0.0, false), (0.0, true), (size, true)].map(|(by, turns)| (*small, by, turns)));
    let found = tries.into_iter().find_map(|(small, by, turns)| {
        let moved = if by == 0.0 { a.clone() } else { &a + DMatrix::identity(n, n) * by };
        let moved = if turns { turned(&moved) } else { moved };
        Some((Schur::try_new(moved, small, ROUNDS * n)?, by))
    });
    let (schur, moved_by) = found.ok_or(LinearError::NoConvergence)?;
    let mut poles: Vec<Complex<f64>> =
        schur.complex_eigenvalues().iter().map(|pole| pole - moved_by).collect();
    if poles.iter().any(|pole| !pole.re.is_finite() || !pole.im.is_finite()) {
        return Err(LinearError::NoConvergence);
    }
    // Several integrators in a row are one eigenvalue, which rounding spreads to the root of its size and more.
    let largest = poles.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let near_zero = |pole: &Complex<f64>| pole.norm() <= SPREAD * largest;
    if largest > 0.0 && poles.iter().any(near_zero) && is_singular(a.clone()) {
        // A slow pole is the same in other coordinates, what rounding has made of a zero is not.
        let again =
            Schur::try_new(turned(&a), f64::EPSILON, ROUNDS * n).map(|schur| schur.complex_eigenvalues());
        let is_slow = |pole: &Complex<f64>| {
            let same = |other: &Complex<f64>| (pole - other).norm() <= SAME * pole.norm();
            pole.norm() > LOST * largest && again.as_ref().is_some_and(|again| again.iter().any(same))
        };
        let rounded = poles.iter_mut().filter(|pole| near_zero(pole) && !is_slow(pole));
        rounded.for_each(|pole| *pole = Complex::new(0.0, 0.0));
        // One is zero in any case.
        if poles.iter().all(|pole| pole.norm() > 0.0)
            && let Some(least) = poles.iter_mut().min_by(|a, b| a.norm().total_cmp(&b.norm()))
        {
            *least = Complex::new(0.0, 0.0);
        }
    }
    Ok(poles)
}

/// Whether a matrix is singular but for rounding, whatever the sizes of its rows and columns.
fn is_singular(mut a: DMatrix<f64>) -> bool {
    for mut row in a.row_iter_mut() {
        let size = row.amax();
        row /= if size > 0.0 { size } else { 1.0 };
    }
    for mut column in a.column_iter_mut() {
        let size = column.amax();
        column /= if size > 0.0 { size } else { 1.0 };
    }
    let sizes = a.singular_values();
    sizes.min() <= 1e-14 * sizes.max()
}

/// The matrix in other orthogonal coordinates: reflected at a vector without symmetry.
fn turned(a: &DMatrix<f64>) -> DMatrix<f64> {
    let n = a.nrows();
    let v = DVector::from_fn(n, |i, _| 1.0 / (1.7 + i as f64)).normalize();
    let reflection = DMatrix::identity(n, n) - &v * v.transpose() * 2.0;
    &reflection * a * &reflection
}

/// Rows and columns of like size: `diag(d)^-1 A diag(d)`, and d.
pub(crate) fn balanced(mut a: DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    // What is zero apart from the diagonal cannot be balanced by that; the sizes of the rest can.
    let diagonal = a.diagonal();
    a.set_diagonal(&DVector::zeros(a.nrows()));
    let scale = balancing::balance_parlett_reinsch(&mut a);
    a.set_diagonal(&diagonal);
    (a, scale)
}

/// Poles with their meaning.
pub fn modes(poles: &[Complex<f64>], period: Option<f64>) -> Vec<Mode> {
    poles.iter().map(|&pole| mode(pole, period)).collect()
}

fn mode(pole: Complex<f64>, period: Option<f64>) -> Mode {
    let s = match period {
        None => pole,
        // A pole at z = 0 has died out after a sample.
        Some(_) if pole.norm() == 0.0 => Complex::new(f64::NEG_INFINITY, 0.0),
        // An integrator is as near to 1 as slopes that are measured let it be.
        Some(_) if (pole - 1.0).norm() <= INTEGRATES => Complex::new(0.0, 0.0),
        Some(period) => pole.ln() / period,
    };
    let frequency = s.re.hypot(s.im);
    let damping = match frequency {
        0.0 => 1.0,
        f if f.is_infinite() => 1.0,
        f => -s.re / f,
    };
    Mode { pole, frequency, damping, time_constant: if s.re == 0.0 { f64::INFINITY } else { -1.0 / s.re } }
}

/// Whether all poles die out. Those on the border, such as integrators, do not.
pub fn is_stable(poles: &[Complex<f64>], period: Option<f64>) -> bool {
    poles.iter().all(|pole| match period {
        None => pole.re < 0.0,
        Some(_) => pole.norm() < 1.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::tests::{transfer, transformed};

    fn near(found: &[Complex<f64>], expected: &[(f64, f64)], within: f64) {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (pole, (re, im)) in found.iter().zip(expected) {
            assert!((pole - Complex::new(*re, *im)).norm() < within * re.hypot(*im).max(1.0), "{found:?}");
        }
    }

    #[test]
    fn a_second_order_system_has_its_frequency_and_damping() {
        for (frequency, damping) in [(5.0, 0.2), (300.0, 0.01), (2.0, 0.9)] {
            let system = transfer(&[1.0], &[1.0, 2.0 * damping * frequency, frequency * frequency]);
            for a in [&system.a, &transformed(&system, 1e3).a] {
                let modes = modes(&poles(a).unwrap(), None);
                assert!(modes[0].pole.im > 0.0 && modes[1].pole.im < 0.0);
                for mode in modes {
                    assert!((mode.frequency / frequency - 1.0).abs() < 1e-9);
                    assert!((mode.damping / damping - 1.0).abs() < 1e-7, "{}", mode.damping);
                    assert!((mode.time_constant * damping * frequency - 1.0).abs() < 1e-7);
                }
            }
        }
    }

    #[test]
    fn poles_far_apart_keep_their_digits() {
        // Electrical and mechanical poles of a drive with an integrator: 0, -3, -2e4.
        let system = transfer(&[1.0], &[1.0, 20003.0, 60000.0, 0.0]);
        near(&poles(&system.a).unwrap(), &[(0.0, 0.0), (-3.0, 0.0), (-2e4, 0.0)], 1e-10);
    }

    /// Heat that is kept between bodies of 1 mJ/K, 1 J/K and 100 J/K, and two of them twice: the slow poles are no zeros.
    #[test]
    fn slow_poles_beside_an_integrator_and_fast_ones_are_no_integrators() {
        let chain = |capacities: &[f64], conductances: &[f64]| {
            let n = capacities.len();
            DMatrix::from_fn(n, n, |i, j| {
                let g = |k: usize| conductances.get(k).copied().unwrap_or(0.0);
                let own = if i > 0 { g(i - 1) } else { 0.0 } + g(i);
                let value = match () {
                    () if i == j => -own,
                    () if i == j + 1 => g(j),
                    () if j == i + 1 => g(i),
                    () => 0.0,
                };
                value / capacities[i]
            })
        };
        for (c, g) in [
            (vec![1e-3, 1.0, 100.0], vec![100.0, 1e-3]),
            (vec![1e-3, 1.0, 100.0], vec![100.0, 0.1]),
            (vec![1e-3, 2.0, 1e-3, 50.0], vec![100.0, 1e-3, 200.0]),
        ] {
            let found = poles(&chain(&c, &g)).unwrap();
            assert_eq!(found[0].norm(), 0.0, "{found:?}");
            // Bodies that are one for slow heat: both sides of the weakest wall.
            let weak = (0..g.len()).min_by(|a, b| g[*a].total_cmp(&g[*b])).unwrap();
            let [left, right]: [f64; 2] = [c[..=weak].iter().sum(), c[weak + 1..].iter().sum()];
            let slow = -g[weak] * (1.0 / left + 1.0 / right);
            assert!((found[1].re / slow - 1.0).abs() < 0.02, "{found:?}, not {slow}");
        }
    }

    #[test]
    fn integrators_in_a_row_have_poles_at_zero_and_slow_poles_do_not() {
        let double = transfer(&[1.0], &[1.0, 700.0, 160_000.0, 0.0, 0.0]);
        let found = poles(&transformed(&double, 10.0).a).unwrap();
        assert!(found[..2].iter().all(|pole| pole.norm() == 0.0), "{found:?}");
        let slow = transfer(&[1.0], &[1.0, 1.0 + 1e-9, 1e-9]);
        assert!((poles(&slow.a).unwrap()[0].re / -1e-9 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn integrators_beside_fast_parts_are_at_zero_exactly() {
        // Five integrators in a row behind a lag of 1e-9 s, their gains far apart.
        let mut a = DMatrix::zeros(6, 6);
        a[(0, 0)] = -1e9;
        for (n, gain) in [1e9, 3.0, 1e-4, 2e5, 7.0].into_iter().enumerate() {
            a[(n + 1, n)] = gain;
        }
        let found = poles(&a).unwrap();
        assert!(found[..5].iter().all(|pole| pole.norm() == 0.0) && found[5].re == -1e9, "{found:?}");
    }

    #[test]
    fn the_iteration_ends_for_matrices_that_it_leaves_as_they_are() {
        let n = 4;
        let cycle = DMatrix::from_fn(n, n, |i, j| f64::from(i == (j + 1) % n));
        let found = poles(&cycle).unwrap();
        assert!(found.iter().all(|pole| (pole.powu(4) - 1.0).norm() < 1e-12), "{found:?}");
        let turn = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, 0.0]);
        near(&poles(&turn).unwrap(), &[(0.0, 1.0), (0.0, -1.0)], 1e-15);
        near(&poles(&DMatrix::zeros(3, 3)).unwrap(), &[(0.0, 0.0); 3], 1e-300);
        assert_eq!(poles(&DMatrix::zeros(0, 0)), Ok(Vec::new()));
        let odd = DMatrix::from_element(2, 2, f64::INFINITY);
        assert_eq!(poles(&odd), Err(LinearError::NotFinite("A")));
    }

    #[test]
    fn sampled_poles_mean_what_those_in_continuous_time_mean() {
        let s = Complex::new(-3.0, 40.0);
        let mode = modes(&[(s * 0.01).exp()], Some(0.01))[0];
        assert!((mode.frequency / s.norm() - 1.0).abs() < 1e-12);
        assert!((mode.damping / (3.0 / s.norm()) - 1.0).abs() < 1e-12);
        assert!(is_stable(&[mode.pole], Some(0.01)) && !is_stable(&[Complex::new(1.0, 0.0)], Some(0.01)));
        let dead = modes(&[Complex::new(0.0, 0.0)], Some(0.01))[0];
        assert_eq!((dead.damping, dead.time_constant), (1.0, 0.0));
    }
}
