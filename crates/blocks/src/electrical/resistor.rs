use blocksim_block::physical::{Characteristics, Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What conducts, and the heat that it makes.
const BODY: Handle = Handle::new("body");
const HEAT: Handle = Handle::new("heat");

/// Resistor: $v = R i$.
///
/// With `heat_port: true` it has a thermal port `h`: the power $v i$ flows out of it as heat, and the resistance follows the
/// temperature there, $R = r (1 + \alpha (T - T_\mathrm{ref}))$.
///
/// ```ron
/// Resistor(r: "10 Ohm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Resistor)]
pub struct Resistor {
    /// Resistance, positive: for zero use a wire (join the pins), for infinity nothing.
    #[block(unit = "Ohm", positive, zero = "a resistance of zero is a wire: join the two nodes instead")]
    pub r: f64,
    /// Has the thermal port `h`.
    #[block(default = false)]
    pub heat_port: bool,
    /// Temperature coefficient of the resistance; 3.93e-3 1/K for copper. With `heat_port` only.
    #[block(unit = "1/K", finite, default = 0.0)]
    pub alpha: f64,
    /// Temperature at which the resistance is `r`.
    #[block(unit = "K", positive, default = 293.15)]
    pub t_ref: f64,
}

impl Resistor {
    /// Resistance at a temperature and its derivative; not a number where it would not be positive.
    fn at(&self, t: f64) -> (f64, f64) {
        let r = self.r * (1.0 + self.alpha * (t - self.t_ref));
        (if r > 0.0 { r } else { f64::NAN }, self.r * self.alpha)
    }

    fn validate(&self, errors: &mut ParamErrors) {
        if self.alpha != 0.0 && !self.heat_port {
            errors.add(
                ParamError::new("alpha", "`alpha` has no effect without a temperature")
                    .help("add `heat_port: true` and connect `h`, or leave `alpha` out"),
            );
        }
    }
}

impl Component for Resistor {
    fn part(&self, _given: &Given) -> Part {
        let (p, n) = (Pin::Port(0), Pin::Port(1));
        let part = if self.heat_port {
            let body = Element::Characteristic { p, n, conductance: 1.0 / self.r, guess: 0.0 };
            // From absolute zero into the port: its voltage is the temperature, negative.
            let (p, n) = (Pin::Ground, Pin::Port(2));
            let heat = Element::Characteristic { p, n, conductance: 0.0, guess: -self.t_ref };
            let part = Part::new().pins().port("h", Domain::Thermal, "thermal port that the heat leaves by");
            part.named(BODY, body).named(HEAT, heat)
        } else {
            Part::new().pins().named(BODY, Element::Resistance { p, n, resistance: self.r })
        };
        part.reads("v", "V", Reading::Voltage(BODY), "voltage from p to n").reads(
            "i",
            "A",
            Reading::Current(BODY),
            "current from p to n",
        )
    }

    fn characteristics(&self, _c: &Moving, curves: &mut Characteristics) {
        if !self.heat_port {
            return;
        }
        let (v, t) = (curves.voltage(BODY), -curves.voltage(HEAT));
        let (r, by_t) = self.at(t);
        curves.current(BODY, v / r);
        curves.slope(BODY, BODY, 1.0 / r);
        curves.slope(BODY, HEAT, v / (r * r) * by_t);
        curves.current(HEAT, v * v / r);
        curves.slope(HEAT, BODY, 2.0 * v / r);
        curves.slope(HEAT, HEAT, v * v / (r * r) * by_t);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        // A resistance is booked by the network.
        if self.heat_port { Energy::dissipated(c.voltage(BODY) * c.current(BODY)) } else { Energy::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::electrical::testing::{characteristic, slopes_are_exact};

    const PLAIN: Resistor = Resistor { r: 10.0, heat_port: false, alpha: 0.0, t_ref: 293.15 };
    const WARM: Resistor = Resistor { heat_port: true, alpha: 4e-3, ..PLAIN };

    #[test]
    fn resistances_that_are_none_are_refused() {
        assert!(!Resistor { r: -1.0, ..PLAIN }.errors().is_empty());
        assert!(Resistor { r: 0.0, ..PLAIN }.errors()[0].help.is_some());
        assert_eq!(Resistor { alpha: 4e-3, ..PLAIN }.errors()[0].param, "alpha");
        assert_eq!(WARM.errors()[..], []);
    }

    #[test]
    fn fifty_kelvin_more_are_a_fifth_of_the_resistance_of_copper_more() {
        let (i, _) = characteristic(&WARM, &[], &[24.0, -343.15]);
        assert!((i[0] - 2.0).abs() < 1e-15 && (i[1] - 48.0).abs() < 1e-13, "{i:?}");
        slopes_are_exact(&WARM, &[], &[24.0, -343.15]);
    }
}
