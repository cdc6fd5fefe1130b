use crate::math::elements::{ROUNDING, TIME, at, clamp, parameters_like};
use blocksim_block::prelude::*;

/// Follows the input no faster than `rising` and `falling` allow, element by element.
///
/// $$ y(t) = \min(\max(u, y_0 + r_\text{falling}\,(t - t_0)),\; y_0 + r_\text{rising}\,(t - t_0)) $$
///
/// with the output $y_0$ at the end $t_0$ of the last accepted step. The solver stops where the input passes one of the
/// rates and where the output has caught up with it, so this is exact whatever the length of the steps. Methods of fixed step
/// do not stop there.
/// Rates written as plain numbers are per second in the unit of the input.
///
/// With `external: true` the rates come from the extra inputs `rising` and `falling`; one that is not connected has the value
/// of the parameter. Rates that change in steps, as at samples, are exact; of others the mean of both ends of a step counts.
///
/// ```ron
/// RateLimiter(rising: "10 V/s", falling: "-20 V/s")
/// ```
/// ```ron
/// RateLimiter(rising: 1, falling: -1, external: true)
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
    /// Whether there are extra inputs `rising` and `falling`.
    #[block(default = false)]
    pub external: bool,
}

/// Discrete states: time of the last accepted step; then the outputs there, then what limits them, then, where rates are
/// signals, the rates there: rising and falling for each.
const OUTPUTS: usize = 1;

/// Ports of rates that are signals.
const RISES: usize = 1;
const FALLS: usize = 2;

/// What limits an element.
const RISING: f64 = 1.0;
const FALLING: f64 = -1.0;
const NOTHING: f64 = 0.0;

/// A guard of a mode that is another one now.
const FAR: f64 = 1.0;

fn mode(u: f64, last: f64) -> f64 {
    if u > last {
        RISING
    } else if u < last {
        FALLING
    } else {
        NOTHING
    }
}

impl RateLimiter {
    /// Least and greatest output of element `i`, `elapsed` seconds after it was `last`; `before` are the rates there.
    fn range(&self, c: &Context, before: &[f64], i: usize, last: f64, elapsed: f64) -> (f64, f64) {
        let (rising, falling) = match before {
            [] => (self.rising, self.falling),
            before => {
                let mean = |port: usize, k: usize| 0.5 * (before[2 * i + k] + at(c.input(port), i));
                (mean(RISES, 0), mean(FALLS, 1))
            }
        };
        (last + falling * elapsed, last + rising * elapsed)
    }

    /// Notes the rates that hold from now on.
    fn note_rates(&self, c: &Context, rates: &mut [f64]) {
        for (i, pair) in rates.chunks_exact_mut(2).enumerate() {
            let (rising, falling) = (at(c.input(RISES), i), at(c.input(FALLS), i));
            if rising < 0.0 {
                return c.fail(format!("`rising` is {rising}, but must not be negative"));
            }
            if falling > 0.0 {
                return c.fail(format!(
                    "`falling` is {falling}, but must not be positive: it is a rate with its sign"
                ));
            }
            pair.copy_from_slice(&[rising, falling]);
        }
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
        let ports: &[&str] = if self.external { &["u", "rising", "falling"] } else { &["u"] };
        let shape = given.common_shape(ports, &[])?;
        let y = u.of(dimension.or(rate.map(|rate| rate.times(TIME)))).shaped(shape);
        let n = shape.len();
        let mut interface = Interface::new().input(Input::real("u"));
        if self.external {
            let port = |name, value| Input::real(name).dimension(rate).default(value);
            interface = interface
                .input(
                    port("rising", self.rising).doc("Greatest rate; the parameter if it is not connected."),
                )
                .input(
                    port("falling", self.falling).doc("Least rate; the parameter if it is not connected."),
                );
        }
        let interface = interface
            .output(Output::like("y", y))
            .discrete("t", 0.0)
            .memory("y", n, self.y0)
            .memory("mode", n, 0.0)
            .memory("rate", if self.external { 2 * n } else { 0 }, 0.0)
            .uses_time()
            .settles()
            .accepts();
        // The modes have no words: at the very rate they change by rounding alone.
        let (rises, falls) = ("begins to limit the rise", "begins to limit the fall");
        let meets = "meets the input again";
        let interface = interface.guard_each_when(Crossing::Holds, "limit", n).called(meets, meets);
        let interface = interface.guard_each_when(Crossing::Holds, "upper", n).called(rises, rises);
        let interface = interface.guard_each_when(Crossing::Holds, "lower", n).called(falls, falls);
        let interface = interface.guard_each_when(Crossing::Peak, "rises", n).called(rises, rises);
        Ok(interface.guard_each_when(Crossing::Peak, "falls", n).called(falls, falls))
    }

    fn initialize(&self, c: &Context, _x: &mut [f64], d: &mut [f64]) {
        d[0] = c.t;
    }

    /// After a jump of the input another rate may limit.
    fn settle(&self, c: &Context, d: &mut [f64]) {
        let n = c.output(0).len();
        let (last, rest) = d[OUTPUTS..].split_at_mut(n);
        let (modes, rates) = rest.split_at_mut(n);
        let u = c.input(0);
        modes
            .iter_mut()
            .zip(last)
            .enumerate()
            .for_each(|(i, (mode_of, last))| *mode_of = mode(at(u, i), *last));
        self.note_rates(c, rates);
    }

    /// What limits is held between instants.
    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let (elapsed, n) = (c.t - c.d[0], y.len());
        let (last, rest) = c.d[OUTPUTS..].split_at(n);
        let (modes, rates) = rest.split_at(n);
        for (i, ((y, last), mode)) in y.iter_mut().zip(last).zip(modes).enumerate() {
            let u = at(c.input(0), i);
            let (lower, upper) = self.range(c, rates, i, *last, elapsed);
            *y = match *mode {
                _ if u.is_nan() => u,
                RISING => upper,
                FALLING => lower,
                _ => u,
            };
        }
    }

    /// While a rate limits, how far the output is behind. While none does, how far the input is inside of what each rate has
    /// allowed since the last step; each of the two has a maximum where the input passes the rate. What says nothing is far
    /// from zero, or zero where only a maximum counts.
    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        let (n, elapsed) = (c.output(0).len(), c.t - c.d[0]);
        let (last, rest) = c.d[OUTPUTS..].split_at(n);
        let (modes, rates) = rest.split_at(n);
        for (i, (last, mode)) in last.iter().zip(modes).enumerate() {
            let u = at(c.input(0), i);
            let (lower, upper) = self.range(c, rates, i, *last, elapsed);
            let free = *mode == NOTHING;
            let rounding = ROUNDING * (u.abs() + lower.abs() + upper.abs());
            let exact = |x: f64| if x.abs() <= rounding { 0.0 } else { x };
            let inside = [exact(upper - u), exact(u - lower)];
            g[i] = match *mode {
                RISING => exact(u - upper),
                FALLING => exact(lower - u),
                _ => FAR,
            };
            for (k, inside) in inside.into_iter().enumerate() {
                g[(1 + k) * n + i] = if free { inside } else { FAR };
                g[(3 + k) * n + i] = if free { inside } else { 0.0 };
            }
        }
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        d[0] = c.t;
        let n = c.output(0).len();
        let (last, rest) = d[OUTPUTS..].split_at_mut(n);
        let (modes, rates) = rest.split_at_mut(n);
        last.iter_mut().enumerate().for_each(|(i, last)| *last = at(c.input(0), i));
        modes.fill(NOTHING);
        self.note_rates(c, rates);
        true
    }

    fn accept(&self, c: &Context, d: &mut [f64]) -> bool {
        let elapsed = c.t - d[0];
        d[0] = c.t;
        let n = c.output(0).len();
        let (last, rest) = d[OUTPUTS..].split_at_mut(n);
        let (modes, rates) = rest.split_at_mut(n);
        let mut changed = false;
        for (i, (last, mode_of)) in last.iter_mut().zip(modes).enumerate() {
            let u = at(c.input(0), i);
            let (lower, upper) = self.range(c, rates, i, *last, elapsed);
            *last = clamp(u, lower, upper);
            let before = std::mem::replace(mode_of, mode(u, *last));
            changed |= *mode_of != before;
        }
        self.note_rates(c, rates);
        changed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::{dimension, given};
    use blocksim_block::testing::Bench;

    const LIMITER: RateLimiter = RateLimiter { rising: 2.0, falling: -4.0, y0: 0.0, external: false };

    #[test]
    fn a_step_becomes_a_ramp_up_and_a_ramp_down_whatever_the_steps_are() {
        let mut bench = Bench::new(LIMITER);
        bench.set(0, &[1.0]);
        for t in [0.0, 0.01, 0.3, 0.49, 0.5, 0.9, 1.0] {
            bench.t = t;
            bench.accept();
            let y = bench.major()[0];
            assert!((y - (2.0 * t).min(1.0)).abs() < 1e-15, "{t}: {y}");
        }
        bench.set(0, &[-1.0]);
        for t in [1.0, 1.2, 1.5, 3.0] {
            bench.t = t;
            bench.accept();
            let y = bench.major()[0];
            assert!((y - (1.0 - 4.0 * (t - 1.0)).max(-1.0)).abs() < 1e-15, "{t}: {y}");
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
        assert_eq!(bench.d, [0.25, 0.5, 1.0]);
    }

    #[test]
    fn guards_are_how_far_the_output_is_behind_or_the_input_inside_of_the_rates() {
        let mut bench = Bench::new(LIMITER);
        bench.set(0, &[1.0]).major();
        for t in [0.1, 0.25, 0.5, 0.75] {
            bench.t = t;
            let g = bench.guards();
            assert!((g[0] - (1.0 - 2.0 * t)).abs() < 1e-15 && g[1..] == [FAR, FAR, 0.0, 0.0], "{t}: {g:?}");
        }
        bench.t = 0.5;
        bench.minor();
        bench.accept();
        assert_eq!(bench.d, [0.5, 1.0, NOTHING]);
        bench.t = 0.75;
        assert_eq!(
            bench.set(0, &[1.25]).guards(),
            [FAR, 0.25, 1.25, 0.25, 1.25],
            "it rises by 0.5 and falls by 1 at most"
        );
        bench.t = 0.5;
        bench.set(0, &[-1.0]).major();
        bench.t = 0.75;
        assert_eq!(bench.guards(), [1.0, FAR, FAR, 0.0, 0.0], "down to 0 of -1");
    }

    #[test]
    fn an_input_with_the_very_rate_is_followed_in_spite_of_rounding() {
        let mut bench = Bench::new(RateLimiter { rising: 0.1, ..LIMITER });
        bench.major();
        for k in 1..1000 {
            bench.t = f64::from(k) * 0.007;
            bench.set(0, &[0.1 * bench.t]).major();
            assert!(bench.guards()[..3].iter().all(|guard| *guard >= 0.0), "{k}");
            bench.accept();
        }
    }

    #[test]
    fn a_slow_signal_passes_and_what_is_not_a_number_is_not_hidden() {
        let mut bench = Bench::with_inputs(LIMITER, vec![("u".to_owned(), PortType::vector(2))]);
        for k in 0..10 {
            bench.t = f64::from(k) * 0.1;
            let u = [1.9 * bench.t, -3.9 * bench.t];
            bench.set(0, &u).accept();
            assert_eq!(bench.major(), u);
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
