//! What a linear system whose matrices change with time makes of its states over a step.

use nalgebra::DMatrix;

use crate::poles::balanced;

/// Where the matrices of a step are wanted, as parts of the step: the nodes of Gauss's formula of order six.
pub const NODES: [f64; 3] = [0.112_701_665_379_258_31, 0.5, 0.887_298_334_620_741_7];

/// Largest norm of the exponent. Squaring loses as many digits as it has; nine or more are left.
const LARGEST: f64 = 4e6;

/// The matrices of `x' = A(t) x + B(t) u` at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct Instant {
    /// `n` by `n`.
    pub a: DMatrix<f64>,
    /// `n` by `m`.
    pub b: DMatrix<f64>,
}

/// `x(h) = phi x(0) + gamma u` of an input that is constant over a step of length `h`, s, from the matrices at its [`NODES`]. Exact for
/// matrices that do not change, whatever the step; else of order six in `h`. Not finite where the matrices are not, or where they are too stiff for
/// nine digits.
///
/// Source: S. Blanes, F. Casas, J. A. Oteo, J. Ros, *The Magnus expansion and some of its applications*, Physics Reports 470
/// (2009) 151, equations 253 to 257, with the matrices `[A B; 0 0]` after C. Van Loan, *Computing integrals involving the matrix
/// exponential*, IEEE Trans. Automatic Control 23 (1978) 395.
///
/// # Panics
/// Panics if the matrices differ in size.
pub fn transition(nodes: &[Instant; 3], h: f64) -> (DMatrix<f64>, DMatrix<f64>) {
    let (n, m) = nodes[0].b.shape();
    let not_known = || (DMatrix::from_element(n, n, f64::NAN), DMatrix::from_element(n, m, f64::NAN));
    let is_finite = |node: &Instant| node.a.iter().chain(node.b.iter()).all(|entry| entry.is_finite());
    if !nodes.iter().all(is_finite) {
        return not_known();
    }
    // States of like size, and columns of the input no larger than those: powers of two, which change no digit.
    let largest = |i: usize, j: usize| nodes.iter().map(|node| node.a[(i, j)].abs()).fold(0.0, f64::max);
    // What acts in one direction alone has no size of its own: as if it came back once in the step.
    let sizes = balanced(DMatrix::from_fn(n, n, |i, j| match largest(i, j) {
        0.0 if largest(j, i) > 0.0 => h.recip(),
        own => own,
    }))
    .1;
    let rate = |node: &Instant, i: usize, j: usize| node.a[(i, j)] * sizes[j] / sizes[i];
    let columns = nodes.iter().flat_map(|node| (0..n).map(move |j| (node, j)));
    let fastest = columns.map(|(node, j)| (0..n).map(|i| rate(node, i, j).abs()).sum::<f64>());
    let fastest = fastest.fold(0.0, f64::max).max(h.recip());
    let effect = |column: usize| {
        let of_node = |node: &Instant| (0..n).map(|i| (node.b[(i, column)] / sizes[i]).abs()).sum::<f64>();
        let largest = nodes.iter().map(of_node).fold(0.0, f64::max);
        if largest > 0.0 { (fastest / largest).log2().floor().exp2() } else { 1.0 }
    };
    let weights: Vec<f64> = (0..m).map(effect).collect();
    let both = |node: &Instant| {
        DMatrix::from_fn(n + m, n + m, |i, j| match (i < n, j < n) {
            (false, _) => 0.0,
            (true, true) => rate(node, i, j),
            (true, false) => node.b[(i, j - n)] / sizes[i] * weights[j - n],
        })
    };
    let [first, middle, last] = [0, 1, 2].map(|node| both(&nodes[node]));
    let exponent = if nodes[0] == nodes[1] && nodes[1] == nodes[2] {
        middle * h
    } else {
        let one = &middle * h;
        let two = (&last - &first) * (h * 15.0_f64.sqrt() / 3.0);
        let three = (&last - &middle * 2.0 + &first) * (h * 10.0 / 3.0);
        let commutator = |a: &DMatrix<f64>, b: &DMatrix<f64>| a * b - b * a;
        let c1 = commutator(&one, &two);
        let c2 = commutator(&one, &(&three * 2.0 + &c1)) / -60.0;
        let rest = commutator(&(&one * -20.0 - &three + &c1), &(&two + c2));
        one + three / 12.0 + rest / 240.0
    };
    let norm = exponent.column_iter().map(|column| column.lp_norm(1)).fold(0.0, f64::max);
    if !exponent.iter().all(|entry| entry.is_finite()) || norm > LARGEST {
        return not_known();
    }
    let found = exponent.exp();
    (
        DMatrix::from_fn(n, n, |i, j| found[(i, j)] * sizes[i] / sizes[j]),
        DMatrix::from_fn(n, m, |i, j| found[(i, n + j)] * sizes[i] / weights[j]),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(count: usize, end: f64, at: impl Fn(f64) -> Instant) -> (DMatrix<f64>, DMatrix<f64>) {
        let h = end / count as f64;
        let first = at(0.0);
        let (mut phi, mut gamma) =
            (DMatrix::identity(first.a.nrows(), first.a.nrows()), first.b.clone() * 0.0);
        for step in 0..count {
            let nodes = NODES.map(|node| at((step as f64 + node) * h));
            let (a, b) = transition(&nodes, h);
            gamma = &a * gamma + b;
            phi = a * phi;
        }
        (phi, gamma)
    }

    /// `x' = cos(t) x + sin(2 t) / 2 u`: x(t) = exp(sin t) (x(0) + u) - (1 + sin t) u.
    #[test]
    fn a_scalar_system_that_changes_has_its_closed_form() {
        let at = |t: f64| Instant {
            a: DMatrix::from_element(1, 1, t.cos()),
            b: DMatrix::from_element(1, 1, (2.0 * t).sin() / 2.0),
        };
        let (phi, gamma) = over(32, 2.0, at);
        let s = 2.0_f64.sin();
        assert!((phi[(0, 0)] - s.exp()).abs() < 1e-12);
        assert!((gamma[(0, 0)] - (s.exp() - 1.0 - s)).abs() < 1e-9, "{gamma}");
    }

    /// In axes that turn with t, x' = A x is constant: A(t) = R(t) (A - W) R(-t) + W has the transition R(t) exp((A - W) t)
    /// with R = exp(W t) a rotation.
    #[test]
    fn the_order_is_six_where_matrices_do_not_commute() {
        let w = DMatrix::from_row_slice(2, 2, &[0.0, -1.0, 1.0, 0.0]);
        let a = DMatrix::from_row_slice(2, 2, &[-0.3, 2.0, -1.0, -0.7]);
        let turned = |t: f64| (&w * t).exp();
        let at = |t: f64| Instant { a: turned(t) * (&a - &w) * turned(-t) + &w, b: DMatrix::zeros(2, 0) };
        let exact = turned(1.5) * ((&a - &w) * 1.5).exp();
        let errors = [4, 8, 16].map(|count| (over(count, 1.5, at).0 - &exact).amax());
        assert!(errors[2] < 1e-9, "{errors:?}");
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((5.5..7.5).contains(&order), "{errors:?}");
        }
    }

    #[test]
    fn constant_matrices_in_any_units_are_exact_in_one_step() {
        // A stiff chain of two lags in badly chosen units: x1' = (u - x1) / t1, x2' = (1e9 x1 - x2) / t2.
        let (t1, t2) = (1e-6, 0.5);
        let at = Instant {
            a: DMatrix::from_row_slice(2, 2, &[-1.0 / t1, 0.0, 1e9 / t2, -1.0 / t2]),
            b: DMatrix::from_row_slice(2, 1, &[1.0 / t1, 0.0]),
        };
        let h = 0.25;
        let (phi, gamma) = transition(&[at.clone(), at.clone(), at], h);
        let slow = (-h / t2).exp();
        let through = 1e9 * t1 / (t2 - t1) * slow;
        // Doubling the exponent of a part of it eighteen times costs as many binary digits.
        assert!(phi[(0, 0)].abs() < 1e-12 && (phi[(1, 1)] / slow - 1.0).abs() < 1e-9, "{phi}");
        assert!((phi[(1, 0)] / through - 1.0).abs() < 1e-9, "{phi}");
        let step = 1e9 * (1.0 - t2 / (t2 - t1) * slow);
        assert!((gamma[(0, 0)] - 1.0).abs() < 1e-9 && (gamma[(1, 0)] / step - 1.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_not_finite_or_too_stiff_is_not_known() {
        let stiff = Instant { a: DMatrix::from_element(1, 1, -1e9), b: DMatrix::zeros(1, 1) };
        assert!(transition(&[stiff.clone(), stiff.clone(), stiff], 1.0).0[(0, 0)].is_nan());
        let bad = Instant { a: DMatrix::from_element(1, 1, f64::INFINITY), b: DMatrix::zeros(1, 1) };
        let (phi, _) = transition(&[bad.clone(), bad.clone(), bad], 1.0);
        assert!(phi[(0, 0)].is_nan());
    }
}
