use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Most steps of the search for the current of a linkage: at the knee of the sharpest curves it takes some twenty.
const STEPS: usize = 100;

/// Inductor whose core saturates, without hysteresis. Its flux linkage is a state.
///
/// $$ \psi = L_s i + (L_0 - L_s)\, i_s \tanh\frac{i}{i_s}, \qquad v = \frac{d\psi}{dt} = L(i) \frac{di}{dt}, \qquad
///    L(i) = L_s + \frac{L_0 - L_s}{\cosh^2(i/i_s)} $$
///
/// Small currents see the inductance $L_0$; far beyond $i_s$ only $L_s$ is left. The field stores $\int i\,d\psi$. A core with a gap, or
/// one that several windings share, is a `MagneticWinding` on a `MagneticCore`.
///
/// ```ron
/// SaturatingInductor(l0: "10 mH", l_s: "0.5 mH", i_s: "4 A")
/// ```
///
/// Source: the same curve of magnetisation as `MagneticCore`.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Inductor)]
pub struct SaturatingInductor {
    /// Inductance of small currents, at least `l_s`.
    #[block(unit = "H", positive)]
    pub l0: f64,
    /// Inductance of large currents, positive.
    #[block(
        unit = "H", positive, at_most = l0,
        remedy = "a core that saturates loses inductance: are the two exchanged?",
    )]
    pub l_s: f64,
    /// Current of the knee, positive: 42 % of the change of the inductance are gone there.
    #[block(unit = "A", positive)]
    pub i_s: f64,
    /// Current at the start, from `p` to `n`.
    #[block(unit = "A", finite, default = 0.0)]
    pub i0: f64,
}

impl SaturatingInductor {
    /// Inductance at a current, H.
    fn inductance(&self, i: f64) -> f64 {
        let tanh = (i / self.i_s).tanh();
        self.l_s + (self.l0 - self.l_s) * (1.0 - tanh * tanh)
    }

    /// Flux linkage at a current, Wb.
    fn linkage(&self, i: f64) -> f64 {
        self.l_s * i + (self.l0 - self.l_s) * self.i_s * (i / self.i_s).tanh()
    }

    /// The current that has a flux linkage, A. Newton's method comes from below, where the linkage bends away from it: from the larger of
    /// the currents of the unsaturated and the saturated line.
    fn current_of(&self, linkage: f64) -> f64 {
        let size = linkage.abs();
        let mut i = (size / self.l0).max((size - (self.l0 - self.l_s) * self.i_s) / self.l_s);
        for _ in 0..STEPS {
            let off = self.linkage(i) - size;
            i -= off / self.inductance(i);
            if off.abs() <= 4.0 * f64::EPSILON * size {
                break;
            }
        }
        i.copysign(linkage)
    }
}

impl Component for SaturatingInductor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .state_in("psi", self.linkage(self.i0), "Wb")
            .element(Element::Winding { p: Pin::Port(0), n: Pin::Port(1), from_state: true })
            .curved()
            .measures("i", "A", Needs::State, "current from p to n")
            .measures("psi", "Wb", Needs::State, "flux linkage")
    }

    fn currents(&self, c: &Moving, i: &mut [f64]) {
        i[0] = self.current_of(c.x[0]);
    }

    fn reluctance(&self, c: &Flowing, _internal: &mut [f64], inverse: &mut [f64]) {
        inverse[0] = 1.0 / self.inductance(self.current_of(c.x[0]));
    }

    fn strike(&self, _c: &Fed, volt_seconds: &[f64], x: &mut [f64]) {
        x[0] += volt_seconds[0];
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.voltage[0];
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let i = self.current_of(c.x[0]);
        let x = (i / self.i_s).abs();
        let ln_cosh = x + (-2.0 * x).exp().ln_1p() - std::f64::consts::LN_2;
        let knee = self.i_s * self.i_s * (x * x.tanh() - ln_cosh);
        Energy::stored(0.5 * self.l_s * i * i + (self.l0 - self.l_s) * knee)
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.copy_from_slice(&[self.current_of(c.x[0]), c.x[0]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::Seen;

    const COIL: SaturatingInductor = SaturatingInductor { l0: 10e-3, l_s: 0.5e-3, i_s: 4.0, i0: 0.0 };

    #[test]
    fn small_currents_see_the_full_inductance_and_large_ones_what_is_left() {
        assert!((COIL.inductance(0.0) - 10e-3).abs() < 1e-18);
        assert!((COIL.inductance(100.0) - 0.5e-3).abs() < 1e-18);
        assert!((COIL.linkage(1e-4) / 1e-4 - 10e-3).abs() < 1e-10);
        assert!((COIL.linkage(400.0) - (0.5e-3 * 400.0 + 9.5e-3 * 4.0)).abs() < 1e-15);
    }

    #[test]
    fn the_inductance_is_the_slope_of_the_linkage() {
        for i in [-9.0, -2.0, 0.3, 4.0, 7.0] {
            let slope = (COIL.linkage(i + 1e-5) - COIL.linkage(i - 1e-5)) / 2e-5;
            assert!((slope / COIL.inductance(i) - 1.0).abs() < 1e-8, "{slope} at {i} A");
        }
    }

    #[test]
    fn the_current_of_a_linkage_is_found_wherever_it_lies() {
        for coil in [
            COIL,
            SaturatingInductor { l0: 5.0, l_s: 5e-3, i_s: 0.1, i0: 0.0 },
            SaturatingInductor { l_s: 10e-3, ..COIL },
        ] {
            for current in [0.0, 1e-12, 1e-3, 0.1, 0.3, 1.0, 4.0, 13.0, 1e4] {
                for current in [current, -current] {
                    let found = coil.current_of(coil.linkage(current));
                    assert!((found - current).abs() <= 1e-12 * current.abs(), "{found} for {current}");
                }
            }
        }
    }

    #[test]
    fn volt_seconds_add_to_the_linkage() {
        for (before, volt_seconds) in [(0.0, 0.02), (3.0, -0.1), (-6.0, 1.0), (0.0, 1e-9), (2.0, 0.0)] {
            let mut x = [COIL.linkage(before)];
            COIL.strike(&Seen::NOTHING.loaded(), &[volt_seconds], &mut x);
            let found = COIL.linkage(COIL.current_of(x[0])) - COIL.linkage(before);
            assert!(
                (found - volt_seconds).abs() < 1e-15 + 1e-14 * volt_seconds.abs(),
                "{found} for {volt_seconds}"
            );
        }
    }

    #[test]
    fn what_gains_inductance_is_refused() {
        assert!(SaturatingInductor { l_s: 20e-3, ..COIL }.errors()[0].help.is_some());
        assert_eq!(SaturatingInductor { i_s: 0.0, ..COIL }.errors()[0].param, "i_s");
        assert_eq!(COIL.errors()[..], []);
    }
}
