use blocksim_block::physical::{Characteristics, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What follows from the law of the varistor.
const BODY: Handle = Handle::new("body");

/// Varistor (metal oxide): a resistance that breaks down beyond a voltage of either sign, as protection against surges.
///
/// $$ i = i_1 \operatorname{sign}(v) \left|\frac{v}{v_1}\right|^\alpha + \frac{v}{r} $$
///
/// Data sheets give $v_1$ at $i_1 = 1\,\mathrm{mA}$; $\alpha$ is 20 to 50 for zinc oxide. The leakage $r$ keeps the slope above
/// zero where the power is flat. Steps end where the power is $i_1$, or a few thousand times more or less, which is no event.
///
/// ```ron
/// Varistor(v_1: "20 V", alpha: 25.0)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Varistor)]
pub struct Varistor {
    /// Voltage at the current `i_1`, positive.
    #[block(unit = "V", positive)]
    pub v_1: f64,
    /// Current at the voltage `v_1`, positive.
    #[block(unit = "A", positive, default = 1e-3)]
    pub i_1: f64,
    /// Exponent, at least 1.
    #[block(at_least = 1.0, default = 30.0)]
    pub alpha: f64,
    /// Resistance of the leakage, positive.
    #[block(unit = "ohm", positive, default = 1e8)]
    pub r: f64,
}

/// Where steps end: shares of `v_1` at which the power is `e^-8`, 1, `e^8` and `e^16` times the current `i_1`; a surge between two looks at a
/// source would be missed.
const BENDS: [f64; 4] = [-8.0, 0.0, 8.0, 16.0];

impl Component for Varistor {
    fn part(&self, _given: &Given) -> Part {
        let conductance = self.i_1 / self.v_1 + 1.0 / self.r;
        let part = Part::new().pins();
        (0..BENDS.len())
            .fold(part, |part, k| part.bend(format!("bend[{k}]")))
            .named(
                BODY,
                Element::Characteristic { p: Pin::Port(0), n: Pin::Port(1), conductance, guess: 0.0 },
            )
            .reads("i", "A", Reading::Current(BODY), "current from p to n")
            .reads("v", "V", Reading::Voltage(BODY), "voltage from p to n")
    }

    fn characteristics(&self, _c: &Moving, curves: &mut Characteristics) {
        let v = curves.voltage(BODY);
        // From the slope, which is even, so that both have the same sign of rounding.
        let slope = self.i_1 / self.v_1 * (v / self.v_1).abs().powf(self.alpha - 1.0);
        curves.current(BODY, slope * v + v / self.r);
        curves.slope(BODY, BODY, self.alpha * slope + 1.0 / self.r);
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        let v = c.voltage(BODY).abs() / self.v_1;
        g.iter_mut().zip(BENDS).for_each(|(g, bend)| *g = v - (bend / self.alpha).exp());
    }

    fn energy(&self, c: &Flowing) -> Energy {
        Energy::dissipated(c.voltage(BODY) * c.current(BODY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::electrical::testing::{characteristic, slopes_are_exact};

    const VARISTOR: Varistor = Varistor { v_1: 20.0, i_1: 1e-3, alpha: 25.0, r: 1e8 };

    #[test]
    fn the_current_at_the_voltage_of_the_data_sheet_is_that_of_the_data_sheet() {
        for sign in [1.0, -1.0] {
            let (i, _) = characteristic(&VARISTOR, &[], &[sign * 20.0]);
            assert!((i[0] - sign * (1e-3 + 2e-7)).abs() < 1e-15);
            // Ten times the current takes 10^(1/25) of the voltage.
            let (i, _) = characteristic(&VARISTOR, &[], &[sign * 20.0 * 10.0_f64.powf(0.04)]);
            assert!((i[0].abs() - 1e-2).abs() < 1e-6);
        }
    }

    #[test]
    fn slopes_are_those_of_the_current() {
        [-25.0, -3.0, 0.0, 1.0, 20.0, 24.0].iter().for_each(|v| slopes_are_exact(&VARISTOR, &[], &[*v]));
    }

    #[test]
    fn what_is_no_varistor_is_refused() {
        assert_eq!(Varistor { v_1: 0.0, ..VARISTOR }.errors()[0].param, "v_1");
        assert_eq!(Varistor { alpha: 0.5, ..VARISTOR }.errors()[0].param, "alpha");
        assert_eq!(Varistor { r: -1.0, ..VARISTOR }.errors()[0].param, "r");
    }
}
