use std::ops::{Add, Mul};

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
/// of the parameter. While such a rate limits, the output is its integral, as exact as the tolerance of the run.
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
    #[block(difference, positive)]
    pub rising: f64,
    /// Least rate, negative.
    #[block(difference, negative, remedy = "it is a rate with its sign: -10, not 10")]
    pub falling: f64,
    /// Output at the start, in the unit of the input.
    #[block(finite, default = 0.0)]
    pub y0: f64,
    /// Whether there are extra inputs `rising` and `falling`.
    #[block(default = false)]
    pub external: bool,
}

/// Discrete states: time of the last accepted step; then the outputs there, then what limits them, then, where rates are
/// signals, for each the rates there, rising and falling, and what the integral of the one that limits was.
const OUTPUTS: usize = 1;

/// Ports of rates that are signals.
const RISES: usize = 1;
const FALLS: usize = 2;

const EACH: usize = 3;

/// What limits an element.
const RISING: f64 = 1.0;
const FALLING: f64 = -1.0;
const NOTHING: f64 = 0.0;

/// A guard of a mode that is another one now.
const FAR: f64 = 1.0;

fn mode(u: f64, last: f64) -> f64 {
    // In an algebraic loop the input follows from the mode, and rounding would have it change to and fro.
    let rounding = ROUNDING * (u.abs() + last.abs());
    if u > last + rounding {
        RISING
    } else if u < last - rounding {
        FALLING
    } else {
        NOTHING
    }
}

/// The mean of a rate at both ends of a step.
fn mean<N: Add<Output = N> + Mul<f64, Output = N>>(before: N, now: N) -> N {
    (before + now) * 0.5
}

/// Least and greatest output, `elapsed` after it was `last`, with these greatest rates up and down.
fn range<N>(last: N, [rising, falling]: [N; 2], elapsed: N) -> (N, N)
where
    N: Copy + Add<Output = N> + Mul<Output = N>,
{
    (last + falling * elapsed, last + rising * elapsed)
}

/// Zero where it differs from that by rounding alone.
fn zero_but_for<'r>(l: &Recording<'r>, x: Value<'r>, rounding: Value<'r>) -> Value<'r> {
    x.abs().live(Relation::LessEqual, rounding).select(l.constant(0.0), x)
}

impl RateLimiter {
    /// Least and greatest output of element `i`, `elapsed` seconds after it was `last`, with this mode; `before` are the rates there.
    fn range(
        &self,
        c: &Context,
        before: &[f64],
        i: usize,
        (last, mode): (f64, f64),
        elapsed: f64,
    ) -> (f64, f64) {
        if before.is_empty() {
            return range(last, [self.rising, self.falling], elapsed);
        }
        let now = |port: usize| at(c.input(port), i);
        let pair = [mean(before[EACH * i], now(RISES)), mean(before[EACH * i + 1], now(FALLS))];
        let (lower, upper) = range(last, pair, elapsed);
        let travelled = last + (c.x[i] - before[EACH * i + 2]);
        match mode {
            RISING => (lower, travelled),
            FALLING => (travelled, upper),
            _ => (lower, upper),
        }
    }

    /// Notes what the integrals of the rates are now.
    fn note_integrals(c: &Context, rates: &mut [f64]) {
        rates.chunks_exact_mut(EACH).zip(c.x).for_each(|(noted, x)| noted[2] = *x);
    }

    /// Notes the rates that hold from now on.
    fn note_rates(&self, c: &Context, rates: &mut [f64]) {
        for (i, noted) in rates.chunks_exact_mut(EACH).enumerate() {
            let (rising, falling) = (at(c.input(RISES), i), at(c.input(FALLS), i));
            if rising < 0.0 {
                return c.fail(format!("`rising` is {rising}, but must not be negative"));
            }
            if falling > 0.0 {
                return c.fail(format!(
                    "`falling` is {falling}, but must not be positive: it is a rate with its sign"
                ));
            }
            noted[..2].copy_from_slice(&[rising, falling]);
        }
    }
}

impl Block for RateLimiter {
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
            .memory("rate", if self.external { EACH * n } else { 0 }, 0.0)
            .settles()
            .accepts();
        let states = if self.external { n } else { 0 };
        let interface =
            (0..states).fold(interface, |all, i| all.drifting_state(format!("travelled[{i}]"), 0.0));
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
    ///
    /// The guards: while a rate limits, how far the output is behind. While none does, how far the input is inside of what each rate
    /// has allowed since the last step; each of the two has a maximum where the input passes the rate. What says nothing is far
    /// from zero, or zero where only a maximum counts.
    fn law(&self, l: &Recording) -> bool {
        let n = l.width(0);
        let elapsed = l.time() - l.d()[0];
        let (last, rest) = l.d()[OUTPUTS..].split_at(n);
        let (modes, rates) = rest.split_at(n);
        let [zero, far] = [0.0, FAR].map(|value| l.constant(value));
        for i in 0..n {
            let u = l.element(0, i);
            let is = |mode| modes[i].live(Relation::Equal, l.constant(mode));
            let (lower, upper) = match rates {
                [] => range(last[i], [self.rising, self.falling].map(|rate| l.constant(rate)), elapsed),
                rates => {
                    let (x, [rising, falling]) = (l.x()[i], [RISES, FALLS].map(|port| l.element(port, i)));
                    let none = is(FALLING).select(falling, zero);
                    l.derive(i, is(RISING).select(rising, none));
                    let pair = [mean(rates[EACH * i], rising), mean(rates[EACH * i + 1], falling)];
                    let (lower, upper) = range(last[i], pair, elapsed);
                    let travelled = last[i] + (x - rates[EACH * i + 2]);
                    (is(FALLING).select(travelled, lower), is(RISING).select(travelled, upper))
                }
            };
            let y = is(RISING).select(upper, is(FALLING).select(lower, u));
            l.set(0, i, u.is_number().select(y, u));
            let rounding = ROUNDING * (u.abs() + lower.abs() + upper.abs());
            let exact = |x| zero_but_for(l, x, rounding);
            l.guard(i, is(RISING).select(exact(u - upper), is(FALLING).select(exact(lower - u), far)));
            let free = is(NOTHING);
            for (k, inside) in [exact(upper - u), exact(u - lower)].into_iter().enumerate() {
                l.guard((1 + k) * n + i, free.select(inside, far));
                l.guard((3 + k) * n + i, free.select(inside, zero));
            }
        }
        true
    }

    fn rest(&self, c: &Context, d: &mut [f64]) -> bool {
        d[0] = c.t;
        let n = c.output(0).len();
        let (last, rest) = d[OUTPUTS..].split_at_mut(n);
        let (modes, rates) = rest.split_at_mut(n);
        last.iter_mut().enumerate().for_each(|(i, last)| *last = at(c.input(0), i));
        modes.fill(NOTHING);
        self.note_rates(c, rates);
        Self::note_integrals(c, rates);
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
            let (lower, upper) = self.range(c, rates, i, (*last, *mode_of), elapsed);
            *last = clamp(u, lower, upper);
            let before = std::mem::replace(mode_of, mode(u, *last));
            changed |= *mode_of != before;
        }
        self.note_rates(c, rates);
        Self::note_integrals(c, rates);
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
        assert_eq!(RateLimiter { rising: 0.0, ..LIMITER }.errors()[0].param, "rising");
        assert_eq!(RateLimiter { falling: 4.0, ..LIMITER }.errors()[0].param, "falling");
    }
}
