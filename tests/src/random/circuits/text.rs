//! Circuits as a diagram: branch `k` is `b<k>`; `s.x<k>` is its state, `s.v<k>` and `s.i<k>` are voltage and current of a diode,
//! `s.flux<n>` is the integral of the potential of node `n`.

use super::super::sheet::Sheet;
use super::super::variants::Variant;
use super::{Circuit, Gate, Kind, Source, Valve};

/// Rows between two that are compared, so that spans in which a diode conducts have rows within.
pub(super) const ROWS: f64 = 20.0;

pub(super) fn diagram(circuit: &Circuit, variant: &Variant) -> String {
    let mut writer = Writer {
        sheet: Sheet::default(),
        pins: vec![Vec::new(); circuit.nodes + 1],
        shown: Vec::new(),
        circuit,
    };
    writer.sheet.block("ground", "ElectricalReference");
    writer.pins[0].push("ground.p".to_owned());
    (0..circuit.branches.len()).for_each(|k| writer.branch(k));
    if circuit.integrals {
        (1..=circuit.nodes).for_each(|node| writer.integral(node));
    }
    let Writer { mut sheet, pins, shown, .. } = writer;
    pins.iter().filter(|pins| pins.len() > 1).for_each(|pins| sheet.wire(&pins.join(" <-> ")));
    sheet.scope("s", &shown);
    let mut variant = variant.clone();
    if let Some(every) = circuit.every {
        variant.settings.push_str(&format!(", output: Every({:?})", every / ROWS));
    }
    sheet.finish(circuit.stop, &variant)
}

struct Writer<'a> {
    circuit: &'a Circuit,
    sheet: Sheet,
    /// What meets at each node.
    pins: Vec<Vec<String>>,
    shown: Vec<(String, String)>,
}

impl Writer<'_> {
    fn show(&mut self, name: String, from: String) {
        self.shown.push((name, from));
    }

    fn branch(&mut self, k: usize) {
        let branch = self.circuit.branches[k];
        let (mut first, mut second) = (format!("b{k}.p"), format!("b{k}.n"));
        let text = match branch.kind {
            Kind::Resistor(r) => format!("Resistor(r: {r:?})"),
            Kind::Coil(l) => {
                self.show(format!("x{k}"), format!("b{k}.i"));
                format!("Inductor(l: {l:?})")
            }
            Kind::Capacitor(c, v0) => {
                self.show(format!("x{k}"), format!("b{k}.v"));
                format!("Capacitor(c: {c:?}, v0: {v0:?})")
            }
            Kind::Voltage(source, r) => {
                self.sheet.block(&format!("r{k}"), &format!("Resistor(r: {r:?})"));
                self.sheet.wire(&format!("b{k}.n <-> r{k}.p"));
                second = format!("r{k}.n");
                match source {
                    Source::Direct(v) => format!("VoltageSource(v: {v:?})"),
                    Source::Sine(v, f, phase) => {
                        format!("AcVoltageSource(amplitude: Peak({v:?}), frequency: {f:?}, phase: {phase:?})")
                    }
                }
            }
            Kind::Current(source) => {
                let text = match source {
                    Source::Direct(i) => format!("Constant(value: \"{i:?} A\")"),
                    Source::Sine(i, f, phase) => format!(
                        "Sine(amplitude: \"{i:?} A\", frequency: \"{f:?} Hz\", phase: \"{phase:?} rad\")"
                    ),
                };
                self.sheet.block(&format!("signal{k}"), &text);
                self.sheet.signal(&format!("signal{k}.y"), &format!("b{k}.i"));
                "ControlledCurrentSource".to_owned()
            }
            Kind::Transformer(p, n, ratio) => {
                (first, second) = (format!("b{k}.p1"), format!("b{k}.n1"));
                self.pins[p].push(format!("b{k}.p2"));
                self.pins[n].push(format!("b{k}.n2"));
                format!("IdealTransformer(ratio: {ratio:?})")
            }
            Kind::Diode(valve) => {
                self.show(format!("v{k}"), format!("b{k}.v"));
                self.show(format!("i{k}"), format!("b{k}.i"));
                format!("Diode({})", properties(valve))
            }
            Kind::Switch(valve, gate) => {
                self.gate(k, gate);
                format!("IdealSwitch(r_on: {:?}, g_off: {:?})", valve.r_on, valve.g_off)
            }
            Kind::Thyristor(valve, gate) => {
                self.gate(k, gate);
                format!("Thyristor({})", properties(valve))
            }
            Kind::Igbt(valve, gate) => {
                self.gate(k, gate);
                format!("Igbt({})", properties(valve))
            }
            Kind::Mosfet(valve, gate) => {
                self.gate(k, gate);
                format!("Mosfet({})", properties(valve))
            }
        };
        self.sheet.block(&format!("b{k}"), &text);
        self.pins[branch.p].push(first);
        self.pins[branch.n].push(second);
    }

    fn gate(&mut self, k: usize, gate: Gate) {
        match gate {
            Gate::Pulse { period, width, delay } => {
                let pulse =
                    format!("Pulse(period: \"{period:?} s\", width: {width:?}, delay: \"{delay:?} s\")");
                self.sheet.block(&format!("pulse{k}"), &pulse);
                let is_on = "Compare(operator: Greater, constant: 0.5)";
                let gate = self.sheet.behind(&format!("pulse{k}.y"), &format!("gate{k}"), is_on);
                self.sheet.signal(&gate, &format!("b{k}.gate"));
            }
            Gate::Sampled { branch, ts, below } => {
                let (state, unit) = match self.circuit.branches[branch].kind {
                    Kind::Coil(_) => (format!("b{branch}.i"), "A"),
                    _ => (format!("b{branch}.v"), "V"),
                };
                let hold = format!("ZeroOrderHold(ts: \"{ts:?} s\")");
                let held = self.sheet.behind(&state, &format!("hold{k}"), &hold);
                let is_below = format!("Compare(operator: Less, constant: \"{below:?} {unit}\")");
                let gate = self.sheet.behind(&held, &format!("gate{k}"), &is_below);
                self.sheet.signal(&gate, &format!("b{k}.gate"));
            }
        }
    }

    fn integral(&mut self, node: usize) {
        let sensor = format!("sensor{node}");
        self.sheet.block(&sensor, "VoltageSensor");
        self.pins[node].push(format!("{sensor}.p"));
        self.pins[0].push(format!("{sensor}.n"));
        let flux = self.sheet.behind(&format!("{sensor}.v"), &format!("flux{node}"), "Integrator");
        self.show(format!("flux{node}"), flux);
    }
}

fn properties(valve: Valve) -> String {
    let Valve { v_f, r_on, g_off } = valve;
    format!("v_f: {v_f:?}, r_on: {r_on:?}, g_off: {g_off:?}")
}
