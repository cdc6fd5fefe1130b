//! Two coupled windings: `v = R i + L di/dt` with a symmetric positive definite matrix `L`.

use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Two coupled windings between the ports 0, 1 and 2, 3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coupled {
    /// Own inductances of both windings, H.
    pub own: [f64; 2],
    /// Mutual inductance, H.
    pub mutual: f64,
    /// Resistances, ohm.
    pub r: [f64; 2],
}

impl Coupled {
    /// Ports, states and elements, with currents at the start.
    pub(super) fn part(start: [f64; 2]) -> Part {
        let winding = |p: usize| Element::Winding { p: Pin::Port(p), n: Pin::Port(p + 1), from_state: true };
        Part::new()
            .port("p1", Domain::Electrical, "positive pin of the first winding")
            .port("n1", Domain::Electrical, "negative pin of the first winding")
            .port("p2", Domain::Electrical, "positive pin of the second winding")
            .port("n2", Domain::Electrical, "negative pin of the second winding")
            .state_in("i1", start[0], "A")
            .state_in("i2", start[1], "A")
            .element(winding(0))
            .element(winding(2))
            .measures("i1", "A", Needs::State, "current from p1 to n1")
            .measures("i2", "A", Needs::State, "current from p2 to n2")
    }

    /// Inverse of the matrix of inductances, 1/H, by rows.
    pub(super) fn inverse(&self) -> [f64; 4] {
        let [a, b] = self.own;
        let determinant = a * b - self.mutual * self.mutual;
        [b, -self.mutual, -self.mutual, a].map(|entry| entry / determinant)
    }

    /// Change of the currents by volt-seconds, A.
    pub(super) fn change(&self, volt_seconds: [f64; 2]) -> [f64; 2] {
        let [a, m, _, b] = self.inverse();
        let [first, second] = volt_seconds;
        [a * first + m * second, m * first + b * second]
    }

    /// What resistances take, V.
    pub(super) fn drop(&self, i: &[f64]) -> [f64; 2] {
        [self.r[0] * i[0], self.r[1] * i[1]]
    }

    /// Energy of the fields, and heat of the resistances.
    pub(super) fn energy(&self, i: &[f64]) -> Energy {
        let ([a, b], [r1, r2]) = (self.own, self.r);
        Energy {
            stored: 0.5 * (a * i[0] * i[0] + b * i[1] * i[1]) + self.mutual * i[0] * i[1],
            dissipated: r1 * i[0] * i[0] + r2 * i[1] * i[1],
            ..Energy::default()
        }
    }

    /// Slopes of the currents, A/s.
    pub(super) fn slopes(&self, c: &Flowing) -> [f64; 2] {
        let drop = self.drop(c.x);
        self.change([c.voltage[0] - drop[0], c.voltage[1] - drop[1]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_is_one() {
        let l = Coupled { own: [2e-3, 8e-3], mutual: 3e-3, r: [0.0; 2] };
        let [a, m, _, b] = l.inverse();
        let product = [2e-3 * a + 3e-3 * m, 2e-3 * m + 3e-3 * b, 3e-3 * a + 8e-3 * m, 3e-3 * m + 8e-3 * b];
        for (found, expected) in product.into_iter().zip([1.0, 0.0, 0.0, 1.0]) {
            assert!((found - expected).abs() < 1e-14);
        }
    }
}
