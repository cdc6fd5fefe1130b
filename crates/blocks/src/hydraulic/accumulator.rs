use blocksim_block::physical::{Characteristics, Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::ATMOSPHERE;

/// What fluid flows in by.
const NECK: Handle = Handle::new("neck");

/// Of its volume, this part of fluid takes an empty accumulator from the precharge to no pressure at all.
const EMPTY: f64 = 1e-4;

/// Accumulator with a gas behind a bladder or a piston: stores fluid under pressure.
///
/// $$ p + p_{at} = (p_v + p_{at}) \left(\frac{V_0}{V_0 - V}\right)^n, \qquad \dot V = q, \qquad p_a - p = R\,q $$
///
/// The fluid $V$ that it holds is a state. $V_0$ is the volume of the gas at the precharge $p_v$, $n$ its exponent: 1 for slow changes at
/// one temperature, 1.4 for fast ones, in which no heat is exchanged. $R$ is the resistance of the neck. An accumulator that is empty has
/// almost no volume left, and its pressure falls below the precharge with the last drops; where it becomes empty is an event.
///
/// ```ron
/// Accumulator(volume: "1 L", precharge: "90 bar", v0: "0.3 L")
/// ```
///
/// Source: H. E. Merritt, *Hydraulic Control Systems* (1967); the polytropic change of an ideal gas.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Accumulator)]
pub struct Accumulator {
    /// Volume of the gas without fluid $V_0$, positive.
    #[block(unit = "m^3", positive)]
    pub volume: f64,
    /// Pressure of the gas without fluid $p_v$, above that of the atmosphere; positive.
    #[block(unit = "Pa", positive)]
    pub precharge: f64,
    /// Polytropic exponent $n$, at least 1.
    #[block(finite, at_least = 1.0, default = 1.4)]
    pub exponent: f64,
    /// Resistance of the neck $R$, positive.
    #[block(unit = "Pa*s/m^3", positive, default = 1e8)]
    pub r: f64,
    /// Fluid at the start: 0 or above, below `volume`.
    #[block(
        unit = "m^3", not_negative, below = volume, default = 0.0,
        remedy = "it leaves no room for the gas: give the fluid at the start, less than `volume`",
    )]
    pub v0: f64,
}

impl Accumulator {
    /// Pressure of the gas, Pa, with a volume of fluid.
    fn gas(&self, v: f64) -> f64 {
        let absolute = self.precharge + ATMOSPHERE;
        if v < 0.0 {
            return self.precharge * (1.0 + v / (EMPTY * self.volume));
        }
        let left = (self.volume - v) / self.volume;
        if left > 0.0 { absolute * left.powf(-self.exponent) - ATMOSPHERE } else { f64::NAN }
    }

    /// Energy that pressing the fluid in has taken, J.
    fn stored(&self, v: f64) -> f64 {
        let absolute = self.precharge + ATMOSPHERE;
        if v < 0.0 {
            return self.precharge * (v + 0.5 * v * v / (EMPTY * self.volume));
        }
        let (left, n) = ((self.volume - v) / self.volume, self.exponent);
        let work = if n == 1.0 { -left.ln() } else { (left.powf(1.0 - n) - 1.0) / (n - 1.0) };
        absolute * self.volume * work - ATMOSPHERE * v
    }
}

impl Component for Accumulator {
    fn part(&self, _given: &Given) -> Part {
        let (p, n, conductance) = (Pin::Port(0), Pin::Ground, 1.0 / self.r);
        Part::new()
            .port("a", Domain::Hydraulic, "hydraulic port")
            .nominal_state("v", self.v0, self.volume)
            .named(NECK, Element::Characteristic { p, n, conductance, guess: self.precharge })
            .measures("v", "m^3", Needs::State, "volume of the fluid")
            .measures("p", "Pa", Needs::State, "pressure of the gas")
            .kink("empty", "takes fluid", "is empty")
    }

    fn characteristics(&self, c: &Moving, curves: &mut Characteristics) {
        curves.current(NECK, (curves.voltage(NECK) - self.gas(c.x[0])) / self.r);
        curves.slope(NECK, NECK, 1.0 / self.r);
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.current(NECK);
    }

    fn guards(&self, c: &Flowing, g: &mut [f64]) {
        g[0] = c.x[0];
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let q = c.current(NECK);
        Energy { stored: self.stored(c.x[0]), dissipated: self.r * q * q, ..Energy::default() }
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y.copy_from_slice(&[c.x[0], self.gas(c.x[0])]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAS: Accumulator = Accumulator { volume: 1e-3, precharge: 9e6, exponent: 1.4, r: 1e8, v0: 0.0 };

    #[test]
    fn half_of_the_gas_has_twice_the_pressure_at_one_temperature() {
        let slow = Accumulator { exponent: 1.0, ..GAS };
        assert!((slow.gas(0.5e-3) - (2.0 * (9e6 + ATMOSPHERE) - ATMOSPHERE)).abs() < 1e-6);
        assert!((GAS.gas(0.5e-3) + ATMOSPHERE) / (9e6 + ATMOSPHERE) - 2.0_f64.powf(1.4) < 1e-12);
        assert!(GAS.gas(-1e-7).abs() < 1e-6);
        assert!((GAS.gas(0.0) - 9e6).abs() < 1e-8 && GAS.gas(1e-3).is_nan());
    }

    #[test]
    fn the_energy_is_the_integral_of_the_pressure() {
        for gas in [GAS, Accumulator { exponent: 1.0, ..GAS }] {
            for v in [-5e-8, 1e-5, 3e-4, 8e-4] {
                let h = 1e-6 * v;
                let slope = (gas.stored(v + h) - gas.stored(v - h)) / (2.0 * h);
                assert!((slope / gas.gas(v) - 1.0).abs() < 1e-5, "{slope} for {} at {v} m^3", gas.gas(v));
            }
        }
        assert_eq!(GAS.stored(0.0), 0.0);
    }

    #[test]
    fn accumulators_without_gas_are_refused() {
        assert!(Accumulator { v0: 1e-3, ..GAS }.errors()[0].help.is_some());
        assert_eq!(Accumulator { exponent: 0.9, ..GAS }.errors()[0].param, "exponent");
        assert_eq!(Accumulator { precharge: 0.0, ..GAS }.errors()[0].param, "precharge");
        assert_eq!(GAS.errors()[..], []);
    }
}
