use std::f64::consts::TAU;

use blocksim_block::physical::{Domain, Element, Pin, Supply};
use blocksim_block::prelude::*;

/// Ideal symmetric three-phase source, such as the mains.
///
/// $$ v_a = \sqrt{\tfrac23}\,V \cos(2\pi f t + \varphi), \qquad
///    v_b, v_c \text{ lag by } 120° \text{ and } 240° $$
///
/// $V$ is the RMS voltage from line to line. A negative frequency exchanges the phases b and c: a machine
/// then turns the other way. Its star point is grounded, unless `neutral: Floating`: a rectifier behind a grounded one must
/// not have a reference on its DC side, nor a load another grounded star point that is meant to carry no current.
///
/// ```ron
/// ThreePhaseSource(voltage: "400 V", frequency: "50 Hz")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = AcSource)]
pub struct ThreePhaseSource {
    /// RMS voltage from line to line.
    #[block(unit = "V", not_negative)]
    pub voltage: f64,
    /// Frequency; negative for the sequence a, c, b.
    #[block(unit = "Hz", finite)]
    pub frequency: f64,
    /// Angle of phase a at the start.
    #[block(unit = "rad", finite, default = 0.0)]
    pub phase: f64,
    /// Star point: `Grounded` or `Floating`.
    #[block(default = Neutral::Grounded)]
    pub neutral: Neutral,
}

/// The star point of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum Neutral {
    /// At potential zero.
    #[default]
    Grounded,
    /// Connected to nothing: the three currents add up to zero.
    Floating,
}

impl Component for ThreePhaseSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("ac", Domain::ThreePhase, "phases a, b, c")
            .measures("power", "W", Needs::Electrics, "power that the source delivers")
            .element(Element::Supply {
                ac: 0,
                n: if self.neutral == Neutral::Grounded { Pin::Ground } else { Pin::Inner(0) },
            })
            .uses_time()
            .rates()
            .max_step(longest_step(self.frequency))
    }

    fn supply(&self, c: &Known) -> Supply {
        Supply {
            voltage: [self.voltage * (2.0_f64 / 3.0).sqrt(), 0.0],
            zero: 0.0,
            frequency: self.frequency,
            angle: TAU * self.frequency * c.t + self.phase,
            ..Supply::NONE
        }
    }

    fn voltage_rates(&self, c: &Moving, dv: &mut [f64]) {
        let w = TAU * self.frequency;
        let peak = self.voltage * (2.0_f64 / 3.0).sqrt();
        for (lag, dv) in dv.iter_mut().enumerate() {
            *dv = -w * peak * (w * c.t + self.phase - TAU / 3.0 * lag as f64).sin();
        }
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y[0] = delivered(c.supply, *c.line_current);
    }
}

/// Step in which no valve sleeps through a half-wave of this frequency, s; the harmonics of a bridge are six times faster.
pub(crate) fn longest_step(frequency: f64) -> f64 {
    1.0 / (24.0 * frequency.abs())
}

/// Power that a supply delivers, W: `3/2 (v_d i_d + v_q i_q) + 3 v_0 i_0`.
pub(crate) fn delivered(supply: &Supply, current: [f64; 3]) -> f64 {
    let [d, q] = supply.voltage;
    1.5 * (d * current[0] + q * current[1]) + 3.0 * supply.zero * current[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_voltage_is_known_as_a_function_of_time() {
        let source =
            ThreePhaseSource { voltage: 220.0, frequency: 60.0, phase: 0.5, neutral: Neutral::Grounded };
        let supply = source.supply(&Seen { t: 0.25, ..law() }.loaded());
        assert!((supply.amplitude() - 179.629_247).abs() < 1e-6, "{}", supply.amplitude());
        assert!((supply.angle - (TAU * 15.0 + 0.5)).abs() < 1e-12);
        assert_eq!((supply.frequency, supply.voltage[1]), (60.0, 0.0));
    }

    #[test]
    fn power_is_three_halves_of_the_product_of_the_vectors() {
        let voltage = [100.0 * 0.3_f64.cos(), 100.0 * 0.3_f64.sin()];
        let supply = Supply { voltage, ..Supply::default() };
        let in_phase = [2.0 * 0.3_f64.cos(), 2.0 * 0.3_f64.sin(), 0.0];
        assert!((delivered(&supply, in_phase) - 300.0).abs() < 1e-12);
        let lagging = [2.0 * 0.3_f64.sin(), -2.0 * 0.3_f64.cos(), 0.0];
        assert!(delivered(&supply, lagging).abs() < 1e-12);
    }
}
