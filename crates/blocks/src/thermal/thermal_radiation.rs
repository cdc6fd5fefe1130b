use blocksim_block::physical::{Characteristics, Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What each side has against absolute zero.
const SIDE_A: Handle = Handle::new("side a");
const SIDE_B: Handle = Handle::new("side b");

/// Stefan-Boltzmann constant, W/(m^2*K^4) (CODATA 2018, exact).
const STEFAN_BOLTZMANN: f64 = 5.670_374_419e-8;
/// Temperature of the first search for an operating point, K.
const GUESS: f64 = 293.15;

/// Exchange of heat by radiation between two grey surfaces.
///
/// $$ q = \varepsilon \sigma A \left(T_a^4 - T_b^4\right) $$
///
/// For a small convex body in large surroundings $\varepsilon$ is its emissivity and $A$ its surface; else it is the factor
/// that follows from both emissivities and the view factor.
///
/// ```ron
/// ThermalRadiation(area: "0.04 m^2", emissivity: 0.9)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Thermal", symbol = Text("εσT⁴"))]
pub struct ThermalRadiation {
    /// Area, positive.
    #[block(unit = "m^2", positive)]
    pub area: f64,
    /// Emissivity of the exchange, above 0 and at most 1.
    #[block(positive, at_most = 1.0, remedy = "1 is that of a black body")]
    pub emissivity: f64,
}

impl Component for ThermalRadiation {
    fn part(&self, _given: &Given) -> Part {
        let side = |port: usize| Element::Characteristic {
            p: Pin::Port(port),
            n: Pin::Ground,
            conductance: 4.0 * self.factor() * GUESS.powi(3),
            guess: GUESS,
        };
        Part::new()
            .port("a", Domain::Thermal, "thermal port that heat enters by")
            .port("b", Domain::Thermal, "thermal port that it leaves by")
            .named(SIDE_A, side(0))
            .named(SIDE_B, side(1))
            .reads("q", "W", Reading::Current(SIDE_A), "heat flow from a to b")
    }

    fn characteristics(&self, _c: &Moving, curves: &mut Characteristics) {
        let (a, b) = (curves.voltage(SIDE_A), curves.voltage(SIDE_B));
        // Odd, so that a search that comes below absolute zero returns.
        let power = |t: f64| self.factor() * t.abs().powi(3) * t;
        let slope = |t: f64| 4.0 * self.factor() * t.abs().powi(3);
        let q = power(a) - power(b);
        for (of, sign) in [(SIDE_A, 1.0), (SIDE_B, -1.0)] {
            curves.current(of, sign * q);
            curves.slope(of, SIDE_A, sign * slope(a));
            curves.slope(of, SIDE_B, -sign * slope(b));
        }
    }
}

impl ThermalRadiation {
    /// W/K^4.
    fn factor(&self) -> f64 {
        self.emissivity * STEFAN_BOLTZMANN * self.area
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::{characteristic, slopes_are_exact};

    const BLACK: ThermalRadiation = ThermalRadiation { area: 2.0, emissivity: 1.0 };

    #[test]
    fn a_black_body_at_1000_k_radiates_57_kw_a_square_metre() {
        let (q, _) = characteristic(&BLACK, &[], &[1000.0, 0.0]);
        assert!((q[0] - 2.0 * 56_703.744_19).abs() < 1e-6 && q[1] == -q[0], "{q:?}");
        slopes_are_exact(&BLACK, &[], &[400.0, 300.0]);
    }

    #[test]
    fn more_than_black_is_refused() {
        assert_eq!(ThermalRadiation { emissivity: 1.1, ..BLACK }.errors()[0].param, "emissivity");
        assert_eq!(ThermalRadiation { area: 0.0, ..BLACK }.errors()[0].param, "area");
    }
}
