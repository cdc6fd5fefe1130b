//! Loops as a diagram.

use super::super::sheet::Sheet;
use super::super::variants::Variant;
use super::{Controller, Loop, Measuring, Sampled, Signal, Stage, Static, Sum, Windup};

pub(super) fn diagram(model: &Sampled, variant: &Variant) -> String {
    let mut sheet = Sheet::default();
    for (i, one) in model.loops.iter().enumerate() {
        sheet.control_loop(i, one);
    }
    sheet.finish(model.stop, variant)
}

impl Sheet {
    fn control_loop(&mut self, i: usize, one: &Loop) {
        let ts = one.ts;
        let name = |what: &str| format!("{what}{i}");
        self.block(&name("reference"), &source(&one.reference));
        let (inner, y) = self.plant(i, one);
        let measured = if one.outer.is_some() { &inner } else { &y };
        let seen = match one.measuring {
            Measuring::Directly => measured.clone(),
            Measuring::Hold => {
                self.behind(measured, &name("hold"), &format!("ZeroOrderHold(ts: \"{ts:?} s\")"))
            }
            Measuring::Mean(n) => {
                let (mut num, mut den) = (vec![1.0 / n as f64; n], vec![0.0; n]);
                den[0] = 1.0;
                num.truncate(n);
                let text = format!(
                    "DiscreteTransferFunction(ts: \"{ts:?} s\", num: {num:?}, den: {den:?}, k: \"1\")"
                );
                self.behind(measured, &name("mean"), &text)
            }
            Measuring::Late(n) => {
                self.behind(measured, &name("late"), &format!("Delay(ts: \"{ts:?} s\", steps: {n})"))
            }
            Measuring::Coarse(q) => {
                self.behind(measured, &name("coarse"), &format!("Quantizer(interval: {q:?})"))
            }
        };
        let mut wanted = format!("{}.y", name("reference"));
        if let Some((slow, law)) = &one.outer {
            self.block(&name("outer_error"), "Sum(signs: \"+-\")");
            self.signal(&wanted, &format!("{}.u1", name("outer_error")));
            self.signal(&y, &format!("{}.u2", name("outer_error")));
            wanted = self.controller(&format!("{}.y", name("outer_error")), &name("outer"), *slow, law);
        }
        self.block(&name("error"), "Sum(signs: \"+-\")");
        self.signal(&wanted, &format!("{}.u1", name("error")));
        self.signal(&seen, &format!("{}.u2", name("error")));
        let c = self.controller(&format!("{}.y", name("error")), &name("controller"), ts, &one.controller);
        let mut given = c.clone();
        for (k, part) in one.actuator.iter().enumerate() {
            let text = match part {
                Static::Saturation(limit) => format!("Saturation(lower: {:?}, upper: {limit:?})", -limit),
                Static::DeadZone(half) => format!("DeadZone(start: {:?}, end: {half:?})", -half),
                Static::Quantizer(q) => format!("Quantizer(interval: {q:?})"),
            };
            given = self.behind(&given, &format!("actuator{i}_{k}"), &text);
        }
        if let Some(rate) = one.rate {
            let text = format!("RateLimiter(rising: {rate:?}, falling: {:?})", -rate);
            given = self.behind(&given, &name("rate"), &text);
        }
        self.signal(&given, &format!("{}.u1", name("drive")));
        self.count(i, one, measured);
        self.block(&name("per_second"), "Gain(k: \"1 1/s\")");
        self.signal(&y, &format!("{}.u", name("per_second")));
        let sum = self.behind(&format!("{}.y", name("per_second")), &name("sum"), "Integrator");
        self.block(&name("show"), "Scope(inputs: [\"inner\", \"y\", \"sum\", \"count\", \"c\", \"given\"])");
        for (from, to) in [(&inner, "inner"), (&y, "y"), (&sum, "sum"), (&c, "c"), (&given, "given")] {
            self.signal(from, &format!("show{i}.{to}"));
        }
    }

    fn controller(&mut self, error: &str, name: &str, ts: f64, law: &Controller) -> String {
        let limits = |limit: &Option<f64>| {
            limit.map_or(String::new(), |limit| format!(", lower: {:?}, upper: {limit:?}", -limit))
        };
        match law {
            Controller::Transfer { num, den } => {
                let text = format!(
                    "DiscreteTransferFunction(ts: \"{ts:?} s\", num: {num:?}, den: {den:?}, k: \"1\")"
                );
                self.behind(error, name, &text)
            }
            Controller::Integral { gain, method, limit } => {
                let rate = self.behind(error, &format!("{name}_rate"), "Gain(k: \"1 1/s\")");
                let text = format!(
                    "DiscreteIntegrator(ts: \"{ts:?} s\", gain: {gain:?}, method: {}{})",
                    sum(*method),
                    limits(limit)
                );
                self.behind(&rate, name, &text)
            }
            Controller::Pid { kp, ki, kd, n, integrator, filter, limit, windup } => {
                let windup = match windup {
                    Windup::None => "",
                    Windup::Clamping => ", anti_windup: Clamping",
                    Windup::BackCalculation => ", anti_windup: BackCalculation",
                };
                let text = format!(
                    "DiscretePid(ts: \"{ts:?} s\", kp: {kp:?}, ki: {ki:?}, kd: {kd:?}, n: \"{n:?} 1/s\", integrator: {}, filter: {}{}{windup})",
                    sum(*integrator),
                    sum(*filter),
                    limits(limit)
                );
                self.block(name, &text);
                self.signal(error, &format!("{name}.e"));
                format!("{name}.u")
            }
        }
    }

    /// The plant behind the sum `drive`; what is behind its first half and behind all.
    fn plant(&mut self, i: usize, one: &Loop) -> (String, String) {
        self.block(&format!("drive{i}"), "Sum(signs: \"++\")");
        self.block(&format!("disturbance{i}"), &source(&one.disturbance));
        self.signal(&format!("disturbance{i}.y"), &format!("drive{i}.u2"));
        let mut at = format!("drive{i}.y");
        for (k, stage) in one.first.iter().enumerate() {
            at = self.stage(&at, &format!("first{i}_{k}"), stage);
        }
        let inner = at.clone();
        if let Some(limit) = one.limit {
            let text = format!("Saturation(lower: {:?}, upper: {limit:?})", -limit);
            at = self.behind(&at, &format!("limit{i}"), &text);
        }
        for (k, stage) in one.second.iter().enumerate() {
            at = self.stage(&at, &format!("second{i}_{k}"), stage);
        }
        let y = if one.second.is_empty() { inner.clone() } else { at };
        (inner, y)
    }

    fn stage(&mut self, from: &str, name: &str, stage: &Stage) -> String {
        match stage {
            Stage::Integrator(k) => {
                let rate = self.behind(from, &format!("{name}_rate"), &format!("Gain(k: \"{k:?} 1/s\")"));
                self.behind(&rate, name, "Integrator")
            }
            Stage::Lag(tau) => self.behind(from, name, &format!("LowPass(tau: \"{tau:?} s\")")),
            Stage::Swing(w, d) => {
                let square = w * w;
                let text = format!(
                    "TransferFunction(num: [{square:?}], den: [1.0, {:?}, {square:?}], k: \"1\")",
                    2.0 * d * w
                );
                self.behind(from, name, &text)
            }
        }
    }

    /// Counts samples above a threshold, or shows zero.
    fn count(&mut self, i: usize, one: &Loop, measured: &str) {
        self.block(&format!("zero{i}"), "Constant(value: 0)");
        let Some(threshold) = one.count else {
            self.signal(&format!("zero{i}.y"), &format!("show{i}.count"));
            return;
        };
        let above = self.behind(
            measured,
            &format!("above{i}"),
            &format!("Compare(operator: Greater, constant: {threshold:?})"),
        );
        self.block(&format!("one{i}"), "Constant(value: 1)");
        self.block(&format!("number{i}"), "Switch");
        self.signal(&format!("one{i}.y"), &format!("number{i}.u1"));
        self.signal(&above, &format!("number{i}.control"));
        self.signal(&format!("zero{i}.y"), &format!("number{i}.u3"));
        self.block(&format!("more{i}"), "Sum(signs: \"++\")");
        self.signal(&format!("number{i}.y"), &format!("more{i}.u1"));
        self.block(&format!("count{i}"), &format!("UnitDelay(ts: \"{:?} s\")", one.ts));
        self.signal(&format!("more{i}.y"), &format!("count{i}.u"));
        self.signal(&format!("count{i}.y"), &format!("more{i}.u2"));
        self.signal(&format!("count{i}.y"), &format!("show{i}.count"));
    }
}

fn sum(method: Sum) -> &'static str {
    match method {
        Sum::ForwardEuler => "ForwardEuler",
        Sum::BackwardEuler => "BackwardEuler",
        Sum::Trapezoidal => "Trapezoidal",
    }
}

fn source(signal: &Signal) -> String {
    match signal {
        Signal::Constant(value) => format!("Constant(value: {value:?})"),
        Signal::Step { time, after } => format!("Step(time: \"{time:?} s\", before: 0.0, after: {after:?})"),
        Signal::Sine { amplitude, frequency } => {
            format!("Sine(amplitude: {amplitude:?}, frequency: \"{frequency:?} Hz\")")
        }
        Signal::Pulse { amplitude, period, width } => {
            format!("Pulse(amplitude: {amplitude:?}, period: \"{period:?} s\", width: {width:?})")
        }
    }
}
