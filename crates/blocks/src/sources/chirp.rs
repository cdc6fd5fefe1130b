use crate::math::elements::common_unit;
use blocksim_block::prelude::*;

/// A sine whose frequency rises or falls linearly: $y = b + A \sin(2 \pi (f_0 t + \frac{f_1 - f_0}{2 T} t^2))$.
///
/// The frequency is $f_0$ at time 0 and $f_1$ at time $T$, and goes on changing at the same rate behind it. A run is best no longer than $T$.
///
/// ```ron
/// Chirp(amplitude: "2 N*m", from: "0.5 Hz", to: "20 Hz", time: "10 s")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Sine))]
pub struct Chirp {
    /// Amplitude $A$; its unit is that of the output.
    #[block(difference, finite, default = 1.0)]
    pub amplitude: f64,
    /// Frequency $f_0$ at time 0.
    #[block(unit = "Hz", not_negative)]
    pub from: f64,
    /// Frequency $f_1$ at time $T$.
    #[block(unit = "Hz", not_negative)]
    pub to: f64,
    /// Time $T$.
    #[block(unit = "s", positive)]
    pub time: f64,
    /// Mean value $b$.
    #[block(finite, default = 0.0)]
    pub bias: f64,
}

impl Block for Chirp {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let dimension = common_unit(given, &[("amplitude", self.amplitude), ("bias", self.bias)])?;
        Ok(Interface::new()
            .output(Output::real("y").dimension(Some(dimension)))
            .period(1.0 / self.from.max(self.to)))
    }

    fn law(&self, l: &Recording) -> bool {
        let t = l.time();
        let turns = self.from * t + 0.5 * (self.to - self.from) / self.time * t * t;
        // Whole turns are taken off before the product with pi is rounded; early ones of a falling chirp are counted down.
        let turns = turns - turns.below();
        l.set(0, 0, self.bias + self.amplitude * (std::f64::consts::TAU * turns).sin());
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    #[test]
    fn zeros_are_where_the_phase_makes_half_a_turn() {
        let chirp = Chirp { amplitude: 3.0, from: 1.0, to: 5.0, time: 2.0, bias: 0.5 };
        let mut bench = Bench::new(chirp.clone());
        for half in 1..12 {
            // t + t^2 = half / 2
            let t = -0.5 + (0.25 + f64::from(half) / 2.0).sqrt();
            let mut at = |t: f64| {
                bench.t = t;
                bench.minor()[0]
            };
            assert!((at(t) - 0.5).abs() < 1e-12, "{t}");
            // The frequency is the slope of the phase, which a sine shows at its zeros.
            let slope = (at(t + 1e-6) - at(t - 1e-6)).abs() / 2e-6;
            let frequency = slope / (std::f64::consts::TAU * 3.0);
            assert!((frequency - (1.0 + 2.0 * t)).abs() < 1e-6, "{t}: {frequency}");
        }
        assert_eq!(Chirp { time: 0.0, ..chirp }.errors()[0].param, "time");
    }

    #[test]
    fn a_falling_chirp_is_as_fast_as_its_beginning() {
        let chirp = Chirp { amplitude: 1.0, from: 8.0, to: 2.0, time: 1.0, bias: 0.0 };
        assert_eq!(Bench::new(chirp).interface.period, Some(0.125));
    }
}
