use blocksim_block::physical::{Characteristics, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// The junction, behind the series resistance.
const JUNCTION: Handle = Handle::new("junction");
/// The whole diode.
const WHOLE: Handle = Handle::new("whole");

/// Boltzmann constant, J/K (exact, SI 2019).
const BOLTZMANN: f64 = 1.380_649e-23;
/// Elementary charge, C (exact, SI 2019).
const CHARGE: f64 = 1.602_176_634e-19;

/// Diode with the exponential characteristic of its junction (W. Shockley, 1949).
///
/// $$ i = i_s \left(e^{v_j / (n v_T)} - 1\right) + g v_j, \qquad v_T = \frac{k T}{q}, \qquad v = v_j + r_s i $$
///
/// It does not switch and has no events; steps end where its current passes $e^8 i_s$, $e^{16} i_s$ and so on, since a pulse of current
/// between two looks at a source would be missed. For power electronics, where only the forward voltage counts, `Diode` is faster.
///
/// There is no junction capacitance and no breakdown; connect a `Capacitor` or a `Varistor` in parallel. In series with a coil the diode
/// needs one of them, or a larger leakage such as `g: "1 uS"`. Without, the current of the coil alone fixes the voltage of a diode that
/// blocks, and steps become tiny.
///
/// ```ron
/// ExponentialDiode(i_s: "4 nA", n: 1.9, r_s: "50 mOhm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Diode)]
pub struct ExponentialDiode {
    /// Saturation current, positive.
    #[block(unit = "A", positive, default = 1e-14)]
    pub i_s: f64,
    /// Emission coefficient (ideality factor), positive.
    #[block(positive, default = 1.0)]
    pub n: f64,
    /// Temperature of the junction, which the thermal voltage follows from.
    #[block(unit = "K", positive, default = 300.15)]
    pub temperature: f64,
    /// Series resistance; zero for none.
    #[block(unit = "ohm", not_negative, default = 0.0)]
    pub r_s: f64,
    /// Conductance of the leakage; zero for none.
    #[block(unit = "S", not_negative, default = 1e-12)]
    pub g: f64,
}

/// Where steps end: voltages of the junction, in multiples of the one over which the current grows by e. From one to the next the current
/// grows by a few thousand, so that a pulse beyond one is seen before it is much larger.
const BENDS: [f64; 5] = [8.0, 16.0, 24.0, 32.0, 40.0];

impl ExponentialDiode {
    /// Voltage over which the current grows by e, V.
    fn scale(&self) -> f64 {
        self.n * BOLTZMANN * self.temperature / CHARGE
    }
}

impl Component for ExponentialDiode {
    fn part(&self, _given: &Given) -> Part {
        let (p, n) = (Pin::Port(0), Pin::Port(1));
        let part = Part::new().pins();
        let part = if self.r_s > 0.0 {
            part.element(Element::Resistance { p, n: Pin::Inner(0), resistance: self.r_s })
        } else {
            part.element(Element::Junction { p, n: Pin::Inner(0) })
        };
        // Between that of a junction which conducts and that of the leakage: rounding harms neither much.
        let junction = Element::Characteristic { p: Pin::Inner(0), n, conductance: 1e-4, guess: 0.0 };
        (0..BENDS.len())
            .fold(part, |part, k| part.bend(format!("bend[{k}]")))
            .named(JUNCTION, junction)
            .named(WHOLE, Element::VoltageProbe { p, n })
            .reads("i", "A", Reading::Current(JUNCTION), "current from p (anode) to n (cathode)")
            .reads("v", "V", Reading::Voltage(WHOLE), "voltage from p to n")
    }

    fn characteristics(&self, _c: &Moving, curves: &mut Characteristics) {
        let v = curves.voltage(JUNCTION);
        let scale = self.scale();
        curves.current(JUNCTION, self.i_s * (v / scale).exp_m1() + self.g * v);
        curves.slope(JUNCTION, JUNCTION, self.i_s / scale * (v / scale).exp() + self.g);
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        let v = c.voltage(JUNCTION) / self.scale();
        g.iter_mut().zip(BENDS).for_each(|(g, bend)| *g = v - bend);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(c.voltage(JUNCTION) * c.current(JUNCTION))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::{characteristic, slopes_are_exact};

    const DIODE: ExponentialDiode =
        ExponentialDiode { i_s: 1e-12, n: 1.5, temperature: 300.0, r_s: 0.0, g: 0.0 };

    #[test]
    fn sixty_millivolts_and_the_emission_coefficient_make_a_decade() {
        // k T / q ln 10 at 300 K is 59.53 mV.
        let decade = 1.5 * 25.851_999_786_435_5e-3 * std::f64::consts::LN_10;
        let (one, _) = characteristic(&DIODE, &[], &[0.7]);
        let (ten, _) = characteristic(&DIODE, &[], &[0.7 + decade]);
        // The current and what leaks backwards are a power of the voltage together.
        let ratio = (ten[0] + DIODE.i_s) / (one[0] + DIODE.i_s);
        assert!((ratio - 10.0).abs() < 1e-9, "{ratio}");
        let (backward, _) = characteristic(&DIODE, &[], &[-50.0]);
        assert_eq!(backward[0], -1e-12);
    }

    #[test]
    fn slopes_are_those_of_the_current() {
        [-5.0, -0.05, 0.0, 0.4, 0.8].iter().for_each(|v| slopes_are_exact(&DIODE, &[], &[*v]));
    }

    #[test]
    fn what_is_no_diode_is_refused() {
        assert_eq!(ExponentialDiode { i_s: 0.0, ..DIODE }.errors()[0].param, "i_s");
        assert_eq!(ExponentialDiode { n: -1.0, ..DIODE }.errors()[0].param, "n");
        assert_eq!(ExponentialDiode { temperature: 0.0, ..DIODE }.errors()[0].param, "temperature");
        assert_eq!(ExponentialDiode { r_s: -1.0, ..DIODE }.errors()[0].param, "r_s");
        assert_eq!(ExponentialDiode { g: f64::NAN, ..DIODE }.errors()[0].param, "g");
    }
}
