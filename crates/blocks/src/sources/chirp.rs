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
    #[block(default = 1.0)]
    pub amplitude: f64,
    /// Frequency $f_0$ at time 0.
    #[block(unit = "Hz")]
    pub from: f64,
    /// Frequency $f_1$ at time $T$.
    #[block(unit = "Hz")]
    pub to: f64,
    /// Time $T$.
    #[block(unit = "s")]
    pub time: f64,
    /// Mean value $b$.
    #[block(default = 0.0)]
    pub bias: f64,
}

impl Chirp {
    /// Turns since time 0.
    fn turns(&self, t: f64) -> f64 {
        self.from * t + 0.5 * (self.to - self.from) / self.time * t * t
    }
}

impl Block for Chirp {
    fn check(&self) -> Result<(), ParamError> {
        finite("amplitude", self.amplitude)?;
        not_negative("from", self.from)?;
        not_negative("to", self.to)?;
        positive("time", self.time)?;
        finite("bias", self.bias)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let dimension = common_unit(given, &[("amplitude", self.amplitude), ("bias", self.bias)])?;
        Ok(Interface::new()
            .output(Output::real("y").dimension(Some(dimension)))
            .uses_time()
            .period(1.0 / self.from.max(self.to)))
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        y[0] = self.bias + self.amplitude * (std::f64::consts::TAU * self.turns(c.t).fract()).sin();
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
            bench.t = t;
            assert!((bench.minor()[0] - 0.5).abs() < 1e-12, "{t}");
        }
        // The frequency is the slope of the phase.
        let slope = |t: f64| (chirp.turns(t + 1e-6) - chirp.turns(t - 1e-6)) / 2e-6;
        assert!((slope(1e-6) - 1.0).abs() < 1e-5 && (slope(2.0) - 5.0).abs() < 1e-6);
        assert_eq!(Chirp { time: 0.0, ..chirp }.check().unwrap_err().param, "time");
    }

    #[test]
    fn a_falling_chirp_is_as_fast_as_its_beginning() {
        let chirp = Chirp { amplitude: 1.0, from: 8.0, to: 2.0, time: 1.0, bias: 0.0 };
        assert_eq!(Bench::new(chirp).interface.period, Some(0.125));
    }
}
