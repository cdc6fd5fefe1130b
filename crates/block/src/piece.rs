//! What a block is told of its inputs over an accepted step.

/// Where a piece is looked at, as shares of its length: Chebyshev's points, which include both ends. A polynomial through
/// them is of degree four, as the dense output of a method of order five is.
pub const NODES: [f64; 5] = [0.0, 0.146_446_609_406_726_24, 0.5, 0.853_553_390_593_273_8, 1.0];

/// Weights of these points in the barycentric form of the polynomial.
const WEIGHTS: [f64; NODES.len()] = [0.5, -1.0, 1.0, -1.0, 0.5];

/// All inputs of a block over a part of an accepted step.
#[derive(Debug, Clone, Copy)]
pub struct Piece<'a> {
    /// Where it begins, s.
    pub begin: f64,
    /// Where it ends, s.
    pub end: f64,
    /// Whether an event at the beginning may have made the inputs, or a derivative of theirs, jump.
    pub is_fresh: bool,
    /// Values of all inputs at the [`NODES`], one node behind the other. Those of the first are behind the event.
    pub inputs: &'a [f64],
}

impl Piece<'_> {
    /// Values of all inputs at one of the nodes.
    pub fn node(&self, node: usize) -> &[f64] {
        let width = self.inputs.len() / NODES.len();
        &self.inputs[node * width..(node + 1) * width]
    }
}

/// Value at the share `share` of a piece of the polynomial through `values` at its [`NODES`]; exact where all are the same.
#[inline]
pub fn through(values: [f64; NODES.len()], share: f64) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    for n in 0..NODES.len() {
        let distance = share - NODES[n];
        if distance == 0.0 {
            return values[n];
        }
        let weight = WEIGHTS[n] / distance;
        above += weight * (values[n] - values[0]);
        below += weight;
    }
    values[0] + above / below
}

/// First and second derivative over the share at the begin or the end of the polynomial through `values` at its [`NODES`].
pub fn derivatives(values: [f64; NODES.len()], at_end: bool) -> [f64; 2] {
    // J.-P. Berrut, L. N. Trefethen, Barycentric Lagrange interpolation, SIAM Rev. 46 (2004), section 9.3.
    let slope = |values: &[f64; NODES.len()], node: usize| -> f64 {
        let others = (0..NODES.len()).filter(|&other| other != node);
        let part = |other: usize| {
            WEIGHTS[other] / WEIGHTS[node] * (values[other] - values[node]) / (NODES[node] - NODES[other])
        };
        others.map(part).sum()
    };
    let node = if at_end { NODES.len() - 1 } else { 0 };
    let slopes = std::array::from_fn(|node| slope(&values, node));
    [slopes[node], slope(&slopes, node)]
}

/// How far the value in the middle is from the cubic through the other four nodes: what the fourth derivative adds, and a
/// bound on what is left of derivatives beyond it in smooth signals.
#[inline]
pub fn roughness(values: [f64; NODES.len()]) -> f64 {
    // The cubic through 0, a, 1 - a and 1 in the middle, with a = 0.146: symmetric, so a parabola tells it.
    let (ends, inner) = ((values[0] + values[4]) / 2.0, (values[1] + values[3]) / 2.0);
    // Squared distances of the ends and of the inner nodes from the middle.
    let (far, near) = (0.25, 0.125);
    let middle = (inner * far - ends * near) / (far - near);
    (values[2] - middle).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(f: impl Fn(f64) -> f64) -> [f64; 5] {
        NODES.map(f)
    }

    #[test]
    fn a_polynomial_of_degree_four_comes_back() {
        let f = |s: f64| 1.0 - 2.0 * s + 3.0 * s * s - 4.0 * s.powi(3) + 5.0 * s.powi(4);
        for share in [0.0, 0.01, 0.146, 0.3, 0.5, 0.77, 0.999, 1.0] {
            assert!((through(at(f), share) - f(share)).abs() < 1e-13, "{share}");
        }
        assert_eq!(through(at(f), 1.0), f(1.0));
    }

    #[test]
    fn derivatives_at_both_ends_are_those_of_the_polynomial() {
        let f = |s: f64| 1.0 - 2.0 * s + 3.0 * s * s - 4.0 * s.powi(3) + 5.0 * s.powi(4);
        let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-11);
        assert!(close(derivatives(at(f), false), [-2.0, 6.0]));
        assert!(close(derivatives(at(f), true), [12.0, 42.0]), "{:?}", derivatives(at(f), true));
    }

    #[test]
    fn a_constant_comes_back_without_rounding() {
        for k in 0..1000 {
            let share = f64::from(k) / 997.0;
            assert_eq!(through([3.05; 5], share), 3.05, "{share}");
        }
    }

    #[test]
    fn cubics_are_not_rough_and_fourth_powers_are_by_their_share() {
        assert!(roughness(at(|s| 2.0 + s - 7.0 * s * s + 3.0 * s.powi(3))) < 1e-14);
        // (s - 1/2)^4 is 1/16 at the ends and 1/64 at the inner nodes; the parabola in (s - 1/2)^2 is -1/32 in the middle.
        assert!((roughness(at(|s| (s - 0.5).powi(4))) - 1.0 / 32.0).abs() < 1e-14);
    }

    #[test]
    fn the_nodes_are_those_of_chebyshev() {
        for (n, node) in NODES.iter().enumerate() {
            let exact = (1.0 - (std::f64::consts::PI * n as f64 / 4.0).cos()) / 2.0;
            assert!((node - exact).abs() < 1e-15, "{n}");
        }
    }
}
