use crate::math::elements::common_unit;
use blocksim_block::prelude::*;

/// A sine: $y = b + A \sin(2 \pi f t + \varphi)$.
///
/// ```ron
/// Sine(amplitude: "325 V", frequency: "50 Hz")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Sine))]
pub struct Sine {
    /// Amplitude $A$; its unit is that of the output.
    #[block(difference, finite, default = 1.0)]
    pub amplitude: f64,
    /// Frequency $f$.
    #[block(unit = "Hz", not_negative)]
    pub frequency: f64,
    /// Phase $\varphi$ at time 0.
    #[block(unit = "rad", finite, default = 0.0)]
    pub phase: f64,
    /// Mean value $b$.
    #[block(finite, default = 0.0)]
    pub bias: f64,
}

impl Block for Sine {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let dimension = common_unit(given, &[("amplitude", self.amplitude), ("bias", self.bias)])?;
        Ok(Interface::new().output(Output::real("y").dimension(Some(dimension))).period(1.0 / self.frequency))
    }

    fn law(&self, l: &Recording) -> bool {
        // Whole turns are taken off before the product with pi is rounded, so that late times lose nothing.
        let turns = self.frequency * l.time();
        let angle = std::f64::consts::TAU * (turns - turns.below()) + self.phase;
        l.set(0, 0, self.bias + self.amplitude * angle.sin());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;
    use std::f64::consts::FRAC_PI_2;

    const MAINS: Sine = Sine { amplitude: 325.0, frequency: 50.0, phase: 0.0, bias: 10.0 };

    #[test]
    fn quarters_of_a_period_are_hit() {
        let mut bench = Bench::new(MAINS);
        for (t, expected) in
            [(0.0, 10.0), (0.005, 335.0), (0.01, 10.0), (0.015, -315.0), (1e4 + 0.005, 335.0)]
        {
            bench.t = t;
            let y = bench.minor()[0];
            assert!((y - expected).abs() < 1e-6, "{t}: {y}");
        }
        let cosine = Sine { phase: FRAC_PI_2, ..MAINS };
        assert_eq!(Bench::new(cosine).minor(), [335.0]);
    }

    #[test]
    fn the_unit_is_that_of_the_amplitude() {
        let sine = Sine { bias: 0.0, ..MAINS };
        let y = sine.interface(&given(&[], &[("amplitude", "V")])).unwrap().outputs[0].port_type;
        assert_eq!(y.dimension, Some(dimension("V")));
        assert!(MAINS.interface(&given(&[], &[("amplitude", "V"), ("bias", "A")])).is_err());
    }

    #[test]
    fn a_negative_frequency_is_refused() {
        assert_eq!(Sine { frequency: -1.0, ..MAINS }.errors()[0].param, "frequency");
    }
}
