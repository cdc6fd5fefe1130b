use crate::math::elements::{TIME, clamp, parameters_like};
use blocksim_block::prelude::*;

/// Follows the input no faster than `rising` and `falling` allow, element by element.
///
/// $$ y(t) = \min(\max(u, y_0 + r_\text{falling}\,(t - t_0)),\; y_0 + r_\text{rising}\,(t - t_0)) $$
///
/// with the output $y_0$ at the end $t_0$ of the last accepted step. While a limit is active this is exact at every
/// instant of a step, whatever the length of the step. Rates written as plain numbers are per second in the unit of the
/// input.
///
/// ```ron
/// RateLimiter(rising: "10 V/s", falling: "-20 V/s")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Discontinuities", symbol = Curve(RateLimit))]
pub struct RateLimiter {
    /// Greatest rate, positive.
    pub rising: f64,
    /// Least rate, negative.
    pub falling: f64,
    /// Output at the start, in the unit of the input.
    #[block(default = 0.0)]
    pub y0: f64,
}

impl RateLimiter {
    /// The output for input `u`, `elapsed` seconds after it was `last`.
    fn limit(&self, u: f64, last: f64, elapsed: f64) -> f64 {
        clamp(u, last + self.falling * elapsed, last + self.rising * elapsed)
    }
}

impl Block for RateLimiter {
    fn check(&self) -> Result<(), ParamError> {
        positive("rising", self.rising)?;
        if !(self.falling < 0.0 && self.falling.is_finite()) {
            let message = format!("`falling` is {}, but must be negative", self.falling);
            return Err(ParamError::new("falling", message).help("it is a rate with its sign: -10, not 10"));
        }
        finite("y0", self.y0)
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let u = given.input_or_unknown("u");
        let dimension = parameters_like(given, "u", u.dimension, &["y0"])?;
        let rate = parameters_like(given, "u", dimension.map(|u| u.over(TIME)), &["rising", "falling"])?;
        let y = u.of(dimension.or(rate.map(|rate| rate.times(TIME))));
        Ok(Interface::new()
            .input(Input::real("u"))
            .output(Output::like("y", y))
            .discrete("t", 0.0)
            .memory("y", u.shape.len(), self.y0)
            .uses_time()
            .accepts())
    }

    fn initialize(&self, c: &Context, _x: &mut [f64], d: &mut [f64]) {
        d[0] = c.t;
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let elapsed = c.t - c.d[0];
        for ((y, u), last) in y.iter_mut().zip(c.u).zip(&c.d[1..]) {
            *y = self.limit(*u, *last, elapsed);
        }
    }

    fn accept(&self, c: &Context, d: &mut [f64]) {
        let elapsed = c.t - d[0];
        for (last, u) in d[1..].iter_mut().zip(c.u) {
            *last = self.limit(*u, *last, elapsed);
        }
        d[0] = c.t;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const LIMITER: RateLimiter = RateLimiter { rising: 2.0, falling: -4.0, y0: 0.0 };

    #[test]
    fn a_step_becomes_a_ramp_up_and_a_ramp_down_whatever_the_steps_are() {
        let mut bench = Bench::new(LIMITER);
        bench.set(0, &[1.0]);
        for t in [0.0, 0.01, 0.3, 0.49, 0.5, 0.9, 1.0] {
            bench.t = t;
            let y = bench.major()[0];
            assert!((y - (2.0 * t).min(1.0)).abs() < 1e-15, "{t}: {y}");
            bench.accept();
        }
        bench.set(0, &[-1.0]);
        for t in [1.0, 1.2, 1.5, 3.0] {
            bench.t = t;
            let y = bench.major()[0];
            assert!((y - (1.0 - 4.0 * (t - 1.0)).max(-1.0)).abs() < 1e-15, "{t}: {y}");
            bench.accept();
        }
    }

    #[test]
    fn rejected_trial_steps_leave_no_trace() {
        let mut bench = Bench::new(LIMITER);
        bench.set(0, &[9.0]).major();
        for (t, y) in [(1.0, 2.0), (0.5, 1.0), (0.25, 0.5)] {
            bench.t = t;
            assert_eq!(bench.minor(), [y]);
        }
        bench.accept();
        assert_eq!(bench.d, [0.25, 0.5]);
    }

    #[test]
    fn a_slow_signal_passes_and_what_is_not_a_number_is_not_hidden() {
        let mut bench = Bench::with_inputs(LIMITER, vec![("u".to_owned(), PortType::vector(2))]);
        for k in 0..10 {
            bench.t = f64::from(k) * 0.1;
            let u = [1.9 * bench.t, -3.9 * bench.t];
            assert_eq!(bench.set(0, &u).major(), u);
            bench.accept();
        }
        assert!(bench.set(0, &[f64::NAN, 0.0]).minor()[0].is_nan());
    }

    #[test]
    fn rates_are_in_the_unit_of_the_input_per_second() {
        let unit = |given: &Given| {
            LIMITER.interface(given).map(|interface| interface.outputs[0].port_type.dimension)
        };
        let volt = Some(dimension("V"));
        assert_eq!(unit(&given(&[("u", "V")], &[("rising", "kV/s"), ("falling", "V/ms")])), Ok(volt));
        assert_eq!(unit(&given(&[], &[("rising", "V/s")])), Ok(volt));
        assert_eq!(unit(&given(&[("u", "V")], &[("rising", "V")])).unwrap_err().code, "unit_mismatch");
        assert_eq!(unit(&given(&[("u", "V")], &[("y0", "A")])).unwrap_err().code, "unit_mismatch");
    }

    #[test]
    fn rates_have_their_signs() {
        assert_eq!(RateLimiter { rising: 0.0, ..LIMITER }.check().unwrap_err().param, "rising");
        assert_eq!(RateLimiter { falling: 4.0, ..LIMITER }.check().unwrap_err().param, "falling");
    }
}
