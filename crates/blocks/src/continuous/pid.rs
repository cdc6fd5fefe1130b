use blocksim_block::prelude::*;

use super::pid_law::{AntiWindup, PidLaw};
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
/// `reset` sets the integral part back to `x0` and the filter to `d0`.
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

    /// Derivative part, from the state of its filter.
    fn derivative(&self, e: f64, xf: f64) -> f64 {
        self.law.n * (self.law.kd * e - xf)
    }

    /// Output before the limits.
    fn unlimited(&self, e: f64, x: &[f64]) -> f64 {
        self.law.sum(e, x[0], self.derivative(e, x[1]))
    }
}

impl Block for Pid {
    fn check(&self) -> Result<(), ParamError> {
        self.law.check()
    }

    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let e = given.input_or_unknown("e");
        let u = Output::like("u", e.of(self.law.dimension(given)?));
        let mut interface = Interface::new().input(Input::real("e").doc("Set value minus actual value."));
        interface = interface.output_reading(&[0], u);
        if let Some(reset) = self.reset.input() {
            interface = interface.input(reset).jumps();
        }
        interface = interface.discrete("trigger", UNSEEN);
        let n = e.shape.len();
        for i in 0..n {
            let detail = || (n > 1).then(|| format!("element {i}"));
            interface = interface.state("integral", self.law.x0).state("filter", self.law.d0);
            if self.law.limited() {
                interface = interface.settles().discrete("mode", 0.0);
                interface = interface
                    .kink("upper")
                    .detail(detail())
                    .called("reaches the upper limit", "leaves the upper limit")
                    .kink("lower")
                    .detail(detail())
                    .called("leaves the lower limit", "reaches the lower limit")
                    .guard("e")
                    .detail(detail())
                    .called("sees its error turn positive", "sees its error turn negative");
            }
        }
        let phrase = if self.reset == Reset::Level { "is held or released" } else { "is reset" };
        Ok(self.reset.guard(interface, given).jump_called(phrase))
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        if self.law.anti_windup != AntiWindup::Clamping {
            return;
        }
        let law = &self.law;
        for ((mode, e), x) in d[MODES..].iter_mut().zip(c.input(0)).zip(c.x.chunks_exact(2)) {
            let v = self.unlimited(*e, x);
            let stays = *mode != 0.0 && *mode == law.winds_up(v, *e, self.slack());
            if !stays {
                *mode = law.winds_up(v, *e, 0.0);
            }
        }
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        for ((u, e), x) in y.iter_mut().zip(c.input(0)).zip(c.x.chunks_exact(2)) {
            *u = self.law.saturate(self.unlimited(*e, x));
        }
    }

    fn derivatives(&self, c: &Context, _w: &mut Scratch, dx: &mut [f64]) {
        if self.reset.holds(c.d[TRIGGER]) {
            dx.fill(0.0);
            return;
        }
        let law = &self.law;
        let states = dx.chunks_exact_mut(2).zip(c.x.chunks_exact(2));
        for (i, ((dx, x), e)) in states.zip(c.input(0)).enumerate() {
            let clamped = c.d.get(MODES + i).is_some_and(|mode| *mode != 0.0);
            dx[0] = match self.law.anti_windup {
                _ if self.law.ki == 0.0 || clamped => 0.0,
                AntiWindup::BackCalculation => {
                    let v = self.unlimited(*e, x);
                    self.law.ki * e + self.law.kb * (law.saturate(v) - v)
                }
                AntiWindup::None | AntiWindup::Clamping => self.law.ki * e,
            };
            dx[1] = self.derivative(*e, x[1]);
        }
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

    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        if self.law.limited() {
            let elements = c.input(0).iter().zip(c.x.chunks_exact(2)).zip(&c.d[MODES..]);
            for (((e, x), mode), g) in elements.zip(g.chunks_exact_mut(3)) {
                let v = self.unlimited(*e, x);
                let waits = |side: f64| if *mode == side { self.slack() } else { 0.0 };
                g[0] = self.law.upper.map_or(-1.0, |upper| v - (upper - waits(1.0)));
                g[1] = self.law.lower.map_or(1.0, |lower| v - (lower + waits(-1.0)));
                // Positive where the integral winds up: beyond a limit, with an error that leads further. Far from the limits the
                // error may flicker in rounding.
                g[2] = match self.law.anti_windup {
                    AntiWindup::Clamping => g[0].min(*e).max((-g[1]).min(-*e)),
                    _ => -1.0,
                };
            }
        }
        if self.reset != Reset::None
            && let Some(g) = g.get_mut(3 * (c.d.len() - MODES))
        {
            *g = c.scalar(1);
        }
    }
}

#[cfg(test)]
#[path = "pid_tests.rs"]
mod tests;
