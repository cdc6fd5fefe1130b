use blocksim_block::prelude::*;

use super::pid_law::{AntiWindup, Limits, PidLaw};
use super::reset::{Reset, UNSEEN};

/// PID controller with filtered derivative, limits and protection against windup.
///
/// $$ \dot x_i = k_i e + a, \qquad \dot x_f = y_d = n (k_d e - x_f), \qquad
///    v = k_p e + x_i + y_d, \qquad u = \operatorname{sat}(v) $$
///
/// that is $C(s) = k_p + k_i / s + k_d\, n / (1 + n / s)$; with `form: Ideal`, where $v = k_p (e + x_i + y_d)$,
/// it is $C(s) = k_p (1 + k_i / s + k_d\, n / (1 + n / s))$. Against windup
///
/// - `BackCalculation` feeds back what the limits cut off: $a = k_b (u - v)$;
/// - `Clamping` stops the integral part while $v$ is outside the limits and the integral part would lead further
///   out. It goes on when the error changes sign or $v$ is back inside by a thousandth of the range; without this
///   small distance the two laws could take turns without end while $v$ slides along a limit.
///
/// Without `ki` the integral part keeps its initial value. The unit of the output is that of the input times
/// that of `kp`. Vectors are controlled element by element. Direct feedthrough. With `reset` the extra input
/// `reset` sets the integral part back to `x0` and the filter to `d0`. With `external_limits: true` the limits are the extra
/// inputs `lower` and `upper`, which act at once; limits that cross end the run with an error.
///
/// ```ron
/// Pid(kp: 8.0, ki: 2.0, kd: 0.4, lower: -1.0, upper: 1.0, anti_windup: Clamping)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Continuous", symbol = Text("PID"))]
pub struct Pid {
    /// Gains, limits and start values.
    #[block(group)]
    pub law: PidLaw,
    /// What the extra input `reset` must do to set the states back: `None` (there is no such input), `Rising`,
    /// `Falling`, `Either`, `Level`.
    #[block(default = Reset::None)]
    pub reset: Reset,
}

/// Distance, as share of the range of the output, by which a clamped integral part waits inside the limits.
const SLACK: f64 = 1e-3;

/// A range of the output that counts as infinite.
const MOST_RANGE: f64 = 1e300;

/// Discrete states: memory of the trigger, then a mode for each element: 1 clamped at the upper limit, -1 at the
/// lower one, 0 free.
const TRIGGER: usize = 0;
const MODES: usize = 1;

impl Pid {
    fn slack(&self) -> f64 {
        match (self.law.lower, self.law.upper) {
            (Some(lower), Some(upper)) => SLACK * (upper - lower),
            (Some(limit), None) | (None, Some(limit)) => SLACK * limit.abs(),
            (None, None) => 0.0,
        }
    }

    /// The same as a value of the law. Limits that are signals may be infinite: then the other one counts, as for parameters.
    fn slack_of<'r>(&self, l: &Recording<'r>, limits: Limits<'r>) -> Value<'r> {
        if !self.law.external_limits {
            return l.constant(self.slack());
        }
        let most = l.constant(MOST_RANGE);
        let range = limits.upper - limits.lower;
        let nearer = limits.upper.abs().min(limits.lower.abs()).min(most);
        SLACK * range.live(Relation::Less, most).select(range, nearer)
    }

    /// Derivative part, from the state of its filter.
    fn derivative<'r>(&self, e: Value<'r>, xf: Value<'r>) -> Value<'r> {
        self.law.n * (self.law.kd * e - xf)
    }

    /// Output before the limits.
    fn unlimited<'r>(&self, e: Value<'r>, x: &[Value<'r>]) -> Value<'r> {
        self.law.sum(e, x[0], self.derivative(e, x[1]))
    }

    /// Records derivatives, mode and guards of element `i` for this error, and gives the output.
    pub(crate) fn record<'r>(&self, l: &Recording<'r>, i: usize, e: Value<'r>) -> Value<'r> {
        let (law, held) = (&self.law, self.reset.held(l, l.d()[TRIGGER]));
        let limits = law.limits(l, i);
        let (zero, slack) = (l.constant(0.0), self.slack_of(l, limits));
        let free = |value: Value<'r>| held.map_or(value, |held| held.select(zero, value));
        let x = &l.x()[2 * i..][..2];
        let v = self.unlimited(e, x);
        let u = limits.saturate(v);
        let mode = law.limited().then(|| l.d()[MODES + i]);
        let integral = match law.anti_windup {
            _ if law.ki == 0.0 => zero,
            AntiWindup::BackCalculation => law.ki * e + law.kb * (u - v),
            AntiWindup::None => law.ki * e,
            AntiWindup::Clamping => mode.map_or(law.ki * e, |mode| mode.is_true().select(zero, law.ki * e)),
        };
        l.derive(2 * i, free(integral));
        l.derive(2 * i + 1, free(self.derivative(e, x[1])));
        let Some(mode) = mode else { return u };
        if law.anti_windup == AntiWindup::Clamping {
            let stays = mode.is_true().and(mode.live(Relation::Equal, law.winds_up(l, limits, v, e, slack)));
            l.settle(MODES + i, stays.select(mode, law.winds_up(l, limits, v, e, zero)));
        } else {
            l.settle(MODES + i, mode);
        }
        let waits = |side: f64| mode.live(Relation::Equal, l.constant(side)).select(slack, zero);
        let has = |limit: Option<f64>| law.external_limits || limit.is_some();
        let upper = if has(law.upper) { v - (limits.upper - waits(1.0)) } else { l.constant(-1.0) };
        let lower = if has(law.lower) { v - (limits.lower + waits(-1.0)) } else { l.constant(1.0) };
        l.guard(3 * i, upper);
        l.guard(3 * i + 1, lower);
        // Positive where the integral winds up: beyond a limit, with an error that leads further. Far from the limits the
        // error may flicker in rounding.
        let winds = match law.anti_windup {
            AntiWindup::Clamping => {
                let drive = if law.per_integral() * law.ki < 0.0 { -e } else { e };
                upper.min(drive).max((-lower).min(-drive))
            }
            _ => l.constant(-1.0),
        };
        l.guard(3 * i + 2, winds);
        u
    }
}

impl Block for Pid {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let e = given.input_or_unknown("e");
        let dimension = self.law.dimension(given)?;
        let mut interface = Interface::new().input(Input::real("e").doc("Set value minus actual value."));
        if let Some(reset) = self.reset.input() {
            interface = interface.input(reset).jumps();
        }
        interface = self.law.inputs_of_limits(interface, dimension);
        let limits: &[&str] = if self.law.external_limits { &["e", "lower", "upper"] } else { &["e"] };
        given.common_shape(limits, &[]).and_then(|shape| {
            let message = || format!("the limits are a {shape}, but `e` is a {}", e.shape);
            if shape == e.shape { Ok(()) } else { Err(InterfaceError::types(&["e"], message())) }
        })?;
        interface = interface.output(Output::like("u", e.of(dimension)));
        interface = interface.discrete("trigger", UNSEEN);
        let n = e.shape.len();
        for i in 0..n {
            let detail = || (n > 1).then(|| format!("element {i}"));
            interface = interface.state("integral", self.law.x0).state("filter", self.law.d0);
            if self.law.limited() {
                interface = interface.discrete("mode", 0.0);
                interface = interface
                    .kink("upper")
                    .detail(detail())
                    .called("reaches the upper limit", "leaves the upper limit")
                    .kink("lower")
                    .detail(detail())
                    .called("leaves the lower limit", "reaches the lower limit")
                    .guard("integral")
                    .detail(detail())
                    .called("holds its integral at a limit", "lets its integral go on");
            }
        }
        let phrase = if self.reset == Reset::Level { "is held or released" } else { "is reset" };
        Ok(self.reset.guard(interface, given).jump_called(phrase))
    }

    fn law(&self, l: &Recording) -> bool {
        l.each(0, |i| self.record(l, i, l.element(0, i)));
        let of_limits = if self.law.limited() { 3 * l.width(0) } else { 0 };
        // That of the reset, unless it is true or false.
        if l.guards() > of_limits {
            l.guard(of_limits, l.u(1));
        }
        true
    }

    fn no_value(&self, _failure: &Failure, c: &Context) -> Option<String> {
        self.law.no_value(c)
    }

    fn jump(&self, c: &Context, _w: &mut Scratch, x: &mut [f64], d: &mut [f64]) -> bool {
        if self.reset == Reset::None {
            return false;
        }
        let held = self.reset.holds(d[TRIGGER]);
        let fires = self.reset.fires(&mut d[TRIGGER], c.scalar(1));
        // Whether the states are held shows in their derivatives.
        let turned = held != self.reset.holds(d[TRIGGER]);
        if !fires {
            return turned;
        }
        let changed = turned || x.chunks_exact(2).any(|x| x != [self.law.x0, self.law.d0]);
        x.chunks_exact_mut(2).for_each(|x| x.copy_from_slice(&[self.law.x0, self.law.d0]));
        changed
    }
}

#[cfg(test)]
#[path = "pid_tests.rs"]
mod tests;
