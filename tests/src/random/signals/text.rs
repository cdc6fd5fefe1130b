//! The diagram of a model.

use std::fmt::Write;

use super::super::sheet::Sheet;
use super::super::variants::Variant;
use super::model::{Edge, Gains, Law, Model, Windup};

/// Names of the outputs in the recording: of a node, and of the integral of a node.
pub(super) fn shown(node: usize) -> String {
    format!("nodes.n{node}")
}

/// See [`shown`].
pub(super) fn integral(node: usize) -> String {
    format!("integrals.n{node}")
}

/// The text of a model as a diagram, put as the variant says.
pub(super) fn diagram(model: &Model, variant: &Variant) -> String {
    let mut writer = Writer { model, variant, sheet: Sheet::default() };
    (0..model.nodes.len()).for_each(|n| writer.node(n));
    writer.outputs();
    writer.sheet.finish(model.stop, variant)
}

struct Writer<'a> {
    model: &'a Model,
    variant: &'a Variant,
    sheet: Sheet,
}

/// A number as a diagram has it.
fn n(value: f64) -> String {
    format!("{value:?}")
}

fn list(values: &[f64]) -> String {
    let items: Vec<String> = values.iter().map(|value| n(*value)).collect();
    format!("[{}]", items.join(", "))
}

impl Writer<'_> {
    fn name(&self, node: usize) -> String {
        self.variant.name(self.model.nodes[node].law.kind(), node)
    }

    /// The port that brings the output of a node, without unit.
    fn output(&self, node: usize) -> String {
        let name = self.name(node);
        match self.model.nodes[node].law {
            Law::Clock | Law::Derivative { .. } => format!("{name}_plain.y"),
            Law::HitCrossing { .. } => format!("{name}.count"),
            Law::Pid(_) | Law::DiscretePid { .. } => format!("{name}.u"),
            _ => format!("{name}.y"),
        }
    }

    fn node(&mut self, node: usize) {
        let name = self.name(node);
        let law = &self.model.nodes[node].law;
        self.sheet.block(&name, &format!("{}{}", law.kind(), parameters(law)));
        let per_second = matches!(law, Law::Integrator { .. } | Law::DiscreteIntegrator { .. });
        match law {
            Law::Clock => {
                self.sheet.block(&format!("{name}_plain"), "Gain(k: \"1 1/s\")");
                self.sheet.signal(&format!("{name}.y"), &format!("{name}_plain.u"));
            }
            Law::Derivative { .. } => {
                self.sheet.block(&format!("{name}_plain"), "Gain(k: \"1 s\")");
                self.sheet.signal(&format!("{name}.y"), &format!("{name}_plain.u"));
            }
            _ => {}
        }
        for (port, &u) in self.model.nodes[node].inputs.iter().enumerate() {
            let from = self.output(u);
            if per_second && port == 0 {
                self.sheet.block(&format!("{name}_rate"), "Gain(k: \"1 1/s\")");
                self.sheet.signal(&from, &format!("{name}_rate.u"));
                self.sheet.signal(&format!("{name}_rate.y"), &format!("{name}.u"));
            } else {
                self.sheet.signal(&from, &format!("{name}.{}", input(law, port)));
            }
        }
    }

    /// What shows the outputs and their integrals.
    fn outputs(&mut self) {
        let all: Vec<usize> = (0..self.model.nodes.len()).collect();
        self.scope("nodes", &all);
        for &node in &all {
            let from = self.output(node);
            self.sheet.signal(&from, &format!("nodes.n{node}"));
        }
        let probes = self.model.probes.clone();
        if probes.iter().any(|&probe| self.model.nodes[probe].boolean) {
            self.sheet.block("one", "Constant(value: 1)");
            self.sheet.block("zero", "Constant(value: 0)");
        }
        for &probe in &probes {
            let mut from = self.output(probe);
            if self.model.nodes[probe].boolean {
                let number = format!("number_{probe}");
                self.sheet.block(&number, "Switch");
                self.sheet.signal("one.y", &format!("{number}.u1"));
                self.sheet.signal(&from, &format!("{number}.control"));
                self.sheet.signal("zero.y", &format!("{number}.u3"));
                from = format!("{number}.y");
            }
            let (rate, sum) = (format!("rate_{probe}"), format!("integral_{probe}"));
            self.sheet.block(&rate, "Gain(k: \"1 1/s\")");
            self.sheet.block(&sum, "Integrator");
            self.sheet.signal(&from, &format!("{rate}.u"));
            self.sheet.signal(&format!("{rate}.y"), &format!("{sum}.u"));
            self.sheet.signal(&format!("{sum}.y"), &format!("integrals.n{probe}"));
        }
        if !probes.is_empty() {
            self.scope("integrals", &probes);
        }
    }

    fn scope(&mut self, name: &str, nodes: &[usize]) {
        let names: Vec<String> = nodes.iter().map(|node| format!("\"n{node}\"")).collect();
        self.sheet.block(name, &format!("Scope(inputs: [{}])", names.join(", ")));
    }
}

/// Name of an input port.
fn input(law: &Law, port: usize) -> &'static str {
    match (law, port) {
        (Law::Switch { .. }, 0) => "u1",
        (Law::Switch { .. }, 1) => "control",
        (Law::Switch { .. }, _) => "u3",
        (Law::Integrator { .. }, 1) => "reset",
        (Law::Pid(_) | Law::DiscretePid { .. }, _) => "e",
        _ if law.inputs() == 1 => "u",
        (_, 0) => "u1",
        _ => "u2",
    }
}

/// The parameters of a block, in parentheses.
fn parameters(law: &Law) -> String {
    match law {
        Law::Constant(value) => format!("(value: {})", n(*value)),
        Law::Step { time, before, after } => {
            format!("(time: \"{} s\", before: {}, after: {})", n(*time), n(*before), n(*after))
        }
        Law::Sine { amplitude, frequency, phase, bias } => format!(
            "(amplitude: {}, frequency: \"{} Hz\", phase: \"{} rad\", bias: {})",
            n(*amplitude),
            n(*frequency),
            n(*phase),
            n(*bias)
        ),
        Law::Pulse { amplitude, period, width, delay } => format!(
            "(amplitude: {}, period: \"{} s\", width: {}, delay: \"{} s\")",
            n(*amplitude),
            n(*period),
            n(*width),
            n(*delay)
        ),
        Law::Ramp { slope, start, initial } => {
            format!("(slope: {}, start: \"{} s\", initial: {})", n(*slope), n(*start), n(*initial))
        }
        Law::Clock | Law::Abs | Law::Sign => String::new(),
        Law::Gain(k) => format!("(k: {})", n(*k)),
        Law::Sum(signs) => {
            let signs: String = signs.iter().map(|sign| if *sign < 0.0 { '-' } else { '+' }).collect();
            format!("(signs: \"{signs}\")")
        }
        Law::Product => "(inputs: 2)".to_owned(),
        Law::MinMax(greatest) => format!("(function: {})", if *greatest { "Max" } else { "Min" }),
        Law::Function(smooth) => format!("(function: {smooth:?})"),
        Law::Table { way, points, values } => format!(
            "(breakpoints: {}, table: {}, interpolation: {way:?}, extrapolation: Clip)",
            list(points),
            list(values)
        ),
        Law::Saturation { lower, upper } => format!("(lower: {}, upper: {})", n(*lower), n(*upper)),
        Law::DeadZone { start, end } => format!("(start: {}, end: {})", n(*start), n(*end)),
        Law::RateLimiter { rising, falling, y0 } => {
            format!("(rising: {}, falling: {}, y0: {})", n(*rising), n(*falling), n(*y0))
        }
        Law::Backlash { width, y0 } => format!("(width: {}, y0: {})", n(*width), n(*y0)),
        Law::Quantizer { interval } => format!("(interval: {})", n(*interval)),
        Law::Compare { relation, constant: None } => format!("(operator: {relation:?})"),
        Law::Compare { relation, constant: Some(constant) } => {
            format!("(operator: {relation:?}, constant: {})", n(*constant))
        }
        Law::Relay { on_at, off_at, on, off } => {
            format!("(on_at: {}, off_at: {}, on: {}, off: {})", n(*on_at), n(*off_at), n(*on), n(*off))
        }
        Law::Switch { threshold: None } => String::new(),
        Law::Switch { threshold: Some(threshold) } => format!("(threshold: {})", n(*threshold)),
        Law::HitCrossing { at, edge } => format!("(at: {}, direction: {})", n(*at), edge_name(*edge)),
        Law::Logic(gate) => format!("(operator: {gate:?})"),
        Law::Delay { ts, steps: 1, x0 } => format!("(ts: \"{} s\", x0: {})", n(*ts), n(*x0)),
        Law::Delay { ts, steps, x0 } => format!("(ts: \"{} s\", steps: {steps}, x0: {})", n(*ts), n(*x0)),
        Law::Hold { ts } => format!("(ts: \"{} s\")", n(*ts)),
        Law::DiscreteIntegrator { ts, method, gain, limit } => {
            format!("(ts: \"{} s\", method: {method:?}, gain: {}{})", n(*ts), n(*gain), limits(*limit))
        }
        Law::DiscreteTransfer { ts, num, den } => {
            format!("(ts: \"{} s\", num: {}, den: {}, k: \"1\")", n(*ts), list(num), list(den))
        }
        Law::DiscretePid { ts, gains } => format!("(ts: \"{} s\", {})", n(*ts), controller(gains)),
        Law::TransportDelay { delay, y0 } => format!("(delay: \"{} s\", y0: {})", n(*delay), n(*y0)),
        Law::Integrator { x0, limit, reset } => {
            let reset = reset.map_or(String::new(), |edge| format!(", reset: {}", edge_name(edge)));
            format!("(x0: {}{}{reset})", n(*x0), limits(*limit))
        }
        Law::LowPass { tau, y0 } => format!("(tau: \"{} s\", y0: {})", n(*tau), n(*y0)),
        Law::Transfer { num, den } => format!("(num: {}, den: {}, k: \"1\")", list(num), list(den)),
        Law::Derivative { n: cut } => format!("(n: \"{} 1/s\")", n(*cut)),
        Law::Pid(gains) => format!("({})", controller(gains)),
    }
}

fn edge_name(edge: Edge) -> String {
    format!("{edge:?}")
}

fn limits(limit: Option<f64>) -> String {
    limit.map_or(String::new(), |limit| format!(", lower: {}, upper: {}", n(-limit), n(limit)))
}

fn controller(gains: &Gains) -> String {
    let mut text = String::new();
    let Gains { kp, ki, kd, n: cut, limit, windup, kb } = gains;
    let _ = write!(
        text,
        "kp: {}, ki: {}, kd: {}, n: \"{} 1/s\"{}",
        n(*kp),
        n(*ki),
        n(*kd),
        n(*cut),
        limits(*limit)
    );
    if *windup != Windup::None {
        let _ = write!(text, ", anti_windup: {windup:?}, kb: \"{} 1/s\"", n(*kb));
    }
    text
}
