use std::f64::consts::{SQRT_2, TAU};

use blocksim_block::in_unit;
use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

use crate::three_phase::three_phase_source::longest_step;

/// Ideal source of a sinusoidal voltage: $v_p - v_n = \hat v \sin(2\pi f t + \varphi)$, whatever current that takes.
///
/// ```ron
/// AcVoltageSource(amplitude: Rms("230 V"), frequency: "50 Hz")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = AcSource)]
pub struct AcVoltageSource {
    /// `Peak("325 V")` or `Rms("230 V")`.
    #[block(not_negative)]
    pub amplitude: Amplitude,
    /// Frequency.
    #[block(unit = "Hz", not_negative)]
    pub frequency: f64,
    /// Angle at the start; 90 degrees for a cosine.
    #[block(unit = "rad", finite, default = 0.0)]
    pub phase: f64,
}

/// An amplitude, and what is meant by it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub enum Amplitude {
    /// Largest value, V.
    Peak(#[serde(deserialize_with = "in_unit::voltage")] f64),
    /// Root of the mean square, V: the peak over the square root of two.
    Rms(#[serde(deserialize_with = "in_unit::voltage")] f64),
}

impl Inspect for Amplitude {
    fn numbers(&self, place: &mut Vec<usize>, see: &mut dyn FnMut(&[usize], f64)) {
        let (Amplitude::Peak(v) | Amplitude::Rms(v)) = self;
        see(place, *v);
    }
}

impl Amplitude {
    /// Largest value, V.
    pub fn peak(self) -> f64 {
        match self {
            Amplitude::Peak(v) => v,
            Amplitude::Rms(v) => SQRT_2 * v,
        }
    }
}

impl Component for AcVoltageSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .uses_time()
            .rates()
            .max_step(longest_step(self.frequency))
            .element(Element::VoltageSource { p: Pin::Port(0), n: Pin::Port(1) })
    }

    fn voltages(&self, c: &Moving, v: &mut [f64]) {
        v[0] = self.amplitude.peak() * (TAU * self.frequency * c.t + self.phase).sin();
    }

    fn voltage_rates(&self, c: &Moving, dv: &mut [f64]) {
        let w = TAU * self.frequency;
        dv[0] = w * self.amplitude.peak() * (w * c.t + self.phase).cos();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn peak_and_rms_differ_by_the_square_root_of_two() {
        let at = |amplitude: Amplitude| {
            let mut v = [0.0];
            AcVoltageSource { amplitude, frequency: 50.0, phase: 0.0 }
                .voltages(&Seen { t: 5e-3, ..law() }.loaded(), &mut v);
            v[0]
        };
        assert!((at(Amplitude::Peak(325.0)) - 325.0).abs() < 1e-12);
        assert!((at(Amplitude::Rms(230.0)) - 325.269_119_345_812).abs() < 1e-9);
    }
}
