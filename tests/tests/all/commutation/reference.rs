//! A slow, independent way to simulate small circuits: steps of fixed length with Alexander's SDIRK method of order two, in
//! which coils and capacitors are resistances with a source, and a search for the diodes that conduct in each stage.

/// A branch from `p` to `n`; node 0 is ground.
#[derive(Debug, Clone, Copy)]
pub struct Branch {
    pub p: usize,
    pub n: usize,
    pub kind: Kind,
}

#[derive(Debug, Clone, Copy)]
pub enum Kind {
    Resistor(f64),
    /// Inductance; the current starts at zero.
    Coil(f64),
    /// Capacitance and its voltage at the start.
    Capacitor(f64, f64),
    /// Direct voltage behind a resistance.
    Battery(f64, f64),
    /// Amplitude, frequency and phase of a sine behind a resistance.
    Sine(f64, f64, f64, f64),
    /// Forward voltage, resistance and conductance while it blocks.
    Diode(f64, f64, f64),
    /// Period, share of it that is on, from its beginning, resistance and conductance while it is open.
    Switch(f64, f64, f64, f64),
}

/// What leaks through a branch that is cut, S.
const LEAK: f64 = 1e-9;

pub struct Slow<'a> {
    nodes: usize,
    branches: &'a [Branch],
    h: f64,
    pub t: f64,
    /// Current of a coil or voltage of a capacitor, for each branch.
    pub x: Vec<f64>,
    on: Vec<bool>,
}

/// `1 - 1/sqrt(2)`.
const GAMMA: f64 = 0.292_893_218_813_452_5;

impl<'a> Slow<'a> {
    pub fn new(nodes: usize, branches: &'a [Branch], h: f64) -> Self {
        let start = |branch: &Branch| match branch.kind {
            Kind::Capacitor(_, v0) => v0,
            _ => 0.0,
        };
        let x = branches.iter().map(start).collect();
        Self { nodes, branches, h, t: 0.0, x, on: vec![false; branches.len()] }
    }

    pub fn step(&mut self) {
        let gh = GAMMA * self.h;
        let start = self.x.clone();
        let first = self.stage(self.t + gh, gh, &start);
        let slope: Vec<f64> = first.iter().zip(&start).map(|(a, b)| (a - b) / gh).collect();
        let base: Vec<f64> = start.iter().zip(&slope).map(|(x, k)| x + (1.0 - GAMMA) * self.h * k).collect();
        self.t += self.h;
        self.x = self.stage(self.t, gh, &base);
    }

    /// Solves `x = base + gh f(x)`.
    fn stage(&mut self, t: f64, gh: f64, base: &[f64]) -> Vec<f64> {
        let most = 60 + 20 * self.branches.len();
        for round in 0..most {
            let v = self.potentials(t, gh, base);
            let across = |b: &Branch| at(&v, b.p) - at(&v, b.n);
            let mut worst = (0.0, None);
            for (k, branch) in self.branches.iter().enumerate() {
                let Kind::Diode(v_f, r_on, _) = branch.kind else { continue };
                let over = across(branch) - v_f;
                let against = if self.on[k] { -over / r_on * 1e-3 } else { over };
                if against > 1e-12 && against > worst.0 {
                    worst = (against, Some(k));
                    // Later the first one, which cannot cycle.
                    if round > 50 {
                        break;
                    }
                }
            }
            match worst.1 {
                Some(k) => self.on[k] = !self.on[k],
                None => {
                    let next = |(k, b): (usize, &Branch)| match b.kind {
                        Kind::Coil(l) => base[k] + gh / l * across(b),
                        Kind::Capacitor(..) => across(b),
                        _ => 0.0,
                    };
                    return self.branches.iter().enumerate().map(next).collect();
                }
            }
        }
        panic!("the reference finds no set of diodes at {t} s");
    }

    /// Conductance of a branch, and the voltage or the current that its source adds.
    fn companion(&self, k: usize, t: f64, gh: f64, base: &[f64]) -> (f64, f64) {
        match self.branches[k].kind {
            Kind::Resistor(r) => (1.0 / r, 0.0),
            Kind::Coil(l) => (gh / l, base[k]),
            Kind::Capacitor(c, _) => (c / gh, -c / gh * base[k]),
            Kind::Battery(v, r) => (1.0 / r, -v / r),
            Kind::Sine(v, f, phase, r) => (1.0 / r, -v * (std::f64::consts::TAU * f * t + phase).sin() / r),
            // Both lines meet at the forward voltage.
            Kind::Diode(v_f, r, g) if self.on[k] => (1.0 / r, (g - 1.0 / r) * v_f),
            Kind::Diode(_, _, g) => (g.max(LEAK), 0.0),
            // A stage at an edge belongs to the time before it.
            Kind::Switch(period, share, r, g) => {
                let phase = ((t - 1e-3 * self.h) / period).rem_euclid(1.0);
                (if phase < share { 1.0 / r } else { g.max(LEAK) }, 0.0)
            }
        }
    }

    fn potentials(&self, t: f64, gh: f64, base: &[f64]) -> Vec<f64> {
        let n = self.nodes;
        let mut a = vec![vec![0.0; n + 1]; n];
        for (k, b) in self.branches.iter().enumerate() {
            let (g, i) = self.companion(k, t, gh, base);
            for (node, sign) in [(b.p, 1.0), (b.n, -1.0)] {
                let Some(row) = node.checked_sub(1) else { continue };
                for (other, by) in [(b.p, 1.0), (b.n, -1.0)] {
                    if let Some(column) = other.checked_sub(1) {
                        a[row][column] += g * sign * by;
                    }
                }
                a[row][n] -= sign * i;
            }
        }
        // Symmetric and positive definite: no pivots are needed.
        for k in 0..n {
            for row in k + 1..n {
                let factor = a[row][k] / a[k][k];
                if factor != 0.0 {
                    let (above, below) = a.split_at_mut(row);
                    below[0][k..].iter_mut().zip(&above[k][k..]).for_each(|(to, by)| *to -= factor * by);
                }
            }
        }
        let mut v = vec![0.0; n];
        for k in (0..n).rev() {
            let rest: f64 = (k + 1..n).map(|j| a[k][j] * v[j]).sum();
            v[k] = (a[k][n] - rest) / a[k][k];
        }
        v
    }
}

fn at(v: &[f64], node: usize) -> f64 {
    node.checked_sub(1).map_or(0.0, |i| v[i])
}

/// The circuit as blocks and connections of a diagram: branch `k` is `b<k>`, its state is recorded as `s.x<k>`, the voltage
/// and the current of a diode as `s.v<k>` and `s.i<k>`.
pub fn diagram(nodes: usize, branches: &[Branch], stop: f64, every: f64, solver: &str) -> String {
    let (mut blocks, mut wires, mut shown) = (vec![r#""g": ElectricalReference"#.to_owned()], vec![], vec![]);
    let mut pins: Vec<Vec<String>> = vec![Vec::new(); nodes + 1];
    pins[0].push("g.p".into());
    for (k, b) in branches.iter().enumerate() {
        pins[b.p].push(format!("b{k}.p"));
        let mut n = format!("b{k}.n");
        let mut record = |from: String, to: String| {
            wires.push(format!("\"{from} -> s.{to}\""));
            shown.push(format!("\"{to}\""));
        };
        let behind = |blocks: &mut Vec<String>, r: f64| blocks.push(format!("\"r{k}\": Resistor(r: {r:?})"));
        let text = match b.kind {
            Kind::Resistor(r) => format!("Resistor(r: {r:?})"),
            Kind::Coil(l) => {
                record(format!("b{k}.i"), format!("x{k}"));
                format!("Inductor(l: {l:?})")
            }
            Kind::Capacitor(c, v0) => {
                record(format!("b{k}.v"), format!("x{k}"));
                format!("Capacitor(c: {c:?}, v0: {v0:?})")
            }
            Kind::Battery(v, r) => {
                behind(&mut blocks, r);
                n = format!("r{k}.n");
                wires.push(format!("\"b{k}.n <-> r{k}.p\""));
                format!("VoltageSource(v: {v:?})")
            }
            Kind::Sine(v, f, phase, r) => {
                behind(&mut blocks, r);
                n = format!("r{k}.n");
                wires.push(format!("\"b{k}.n <-> r{k}.p\""));
                format!("AcVoltageSource(amplitude: Peak({v:?}), frequency: {f:?}, phase: {phase:?})")
            }
            Kind::Diode(v_f, r, g) => {
                record(format!("b{k}.v"), format!("v{k}"));
                record(format!("b{k}.i"), format!("i{k}"));
                format!("Diode(v_f: {v_f:?}, r_on: {r:?}, g_off: {g:?})")
            }
            Kind::Switch(period, share, r, g) => {
                blocks.push(format!("\"p{k}\": Pulse(period: {period:?}, width: {share:?})"));
                blocks.push(format!("\"c{k}\": Compare(operator: Greater, constant: 0.5)"));
                wires.push(format!("\"p{k}.y -> c{k}.u\", \"c{k}.y -> b{k}.gate\""));
                format!("IdealSwitch(r_on: {r:?}, g_off: {g:?})")
            }
        };
        blocks.push(format!("\"b{k}\": {text}"));
        pins[b.n].push(n);
    }
    wires.extend(pins.iter().filter(|pins| pins.len() > 1).map(|pins| format!("\"{}\"", pins.join(" <-> "))));
    format!(
        "Diagram(\n    simulation: (stop_time: {stop:?}, solver: {solver}, output: Every({every:?})),\n    blocks: {{ {}, \
         \"s\": Scope(inputs: [{}]) }},\n    connections: [{}],\n)",
        blocks.join(", "),
        shown.join(", "),
        wires.join(", ")
    )
}
