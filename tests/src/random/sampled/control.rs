//! Controllers as difference equations: what comes out now, from what came out before and what was measured now and before.

use super::{Controller, Sum, Windup};

/// A controller over its samples.
pub(super) struct Memory<'a> {
    law: &'a Controller,
    ts: f64,
    /// All inputs so far.
    inputs: Vec<f64>,
    /// Of a transfer function and of a sum, all outputs so far.
    outputs: Vec<f64>,
    /// Integral part and derivative part of the last sample, and what was integrated then.
    integral: f64,
    derivative: f64,
    driven: f64,
}

impl Sum {
    /// The part of a sample that counts at once.
    fn share(self) -> f64 {
        match self {
            Sum::ForwardEuler => 0.0,
            Sum::BackwardEuler => 1.0,
            Sum::Trapezoidal => 0.5,
        }
    }
}

fn within(value: f64, limit: Option<f64>) -> f64 {
    limit.map_or(value, |limit| value.max(-limit).min(limit))
}

impl<'a> Memory<'a> {
    pub fn new(law: &'a Controller, ts: f64) -> Self {
        let (inputs, outputs) = (Vec::new(), Vec::new());
        Self { law, ts, inputs, outputs, integral: 0.0, derivative: 0.0, driven: 0.0 }
    }

    /// The output at the next sample.
    pub fn next(&mut self, e: f64) -> f64 {
        let before = self.inputs.last().copied();
        self.inputs.push(e);
        let out = match self.law {
            Controller::Transfer { num, den } => self.filtered(num, den),
            Controller::Integral { gain, method, limit } => {
                // What a sample brings is split between its own output and the next; limits hold after each part.
                let share = method.share();
                let kept = before.map_or(0.0, |u| {
                    let last = self.outputs[self.outputs.len() - 1];
                    within(last + (1.0 - share) * gain * self.ts * u, *limit)
                });
                within(kept + share * gain * self.ts * e, *limit)
            }
            Controller::Pid { kp, ki, kd, n, integrator, filter, limit, windup } => {
                let (t, a, b) = (self.ts, integrator.share(), filter.share());
                // The trapezium or rectangle rule for the filter of the derivative, solved for its output.
                let slowed = 1.0 + b * n * t;
                let derivative = match before {
                    None => n * kd * e / slowed,
                    Some(last) => self.derivative * (1.0 - n * t / slowed) + n * kd * (e - last) / slowed,
                };
                let settled = self.integral + t * (1.0 - a) * self.driven;
                let free = ki * e;
                let sum = |driven: f64| kp * e + settled + t * a * driven + derivative;
                let over = |v: f64| v - within(v, *limit);
                let driven = match windup {
                    _ if *ki == 0.0 => 0.0,
                    Windup::None => free,
                    Windup::Clamping if over(sum(free)) * free > 0.0 => 0.0,
                    Windup::Clamping => free,
                    // w = ki e - kb (v - L) and v = v0 + t a w, beyond a limit L.
                    Windup::BackCalculation => free - over(sum(free)) / (1.0 + t * a),
                };
                self.integral = settled + t * a * driven;
                (self.derivative, self.driven) = (derivative, driven);
                within(sum(driven), *limit)
            }
        };
        self.outputs.push(out);
        out
    }

    /// The sum over inputs and outputs so far, zero before the start.
    fn filtered(&self, num: &[f64], den: &[f64]) -> f64 {
        let now = self.inputs.len() - 1;
        let ago = |past: &[f64], steps: usize| now.checked_sub(steps).map_or(0.0, |k| past[k]);
        let lag = den.len() - num.len();
        let forward: f64 = num.iter().enumerate().map(|(i, b)| b * ago(&self.inputs, i + lag)).sum();
        let back: f64 = (1..den.len()).map(|i| den[i] * ago(&self.outputs, i)).sum();
        (forward - back) / den[0]
    }
}
