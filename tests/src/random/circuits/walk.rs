//! Motion in time: steps of fixed length by Alexander's method of order two (R. Alexander, *Diagonally implicit Runge-Kutta methods
//! for stiff O.D.E.'s*, SIAM J. Numer. Anal. 14 (1977)), in which coils and capacitors are resistances with a source. In each stage
//! sets of conducting valves are tried, those first that differ least from the last one.

use super::super::puzzle::Undecided;
use super::nodal::{Admittance, Factors, Windings};
use super::{Circuit, Gate, Kind, Valve};

/// `1 - 1/sqrt(2)`.
const GAMMA: f64 = 0.292_893_218_813_452_5;

/// Steps behind an edge: how often the first is half as long as the next, and how many there are of each length.
const HALVINGS: i32 = 10;
const EACH: usize = 6;

/// A part of a valve that conducts in one direction.
struct Leg {
    p: usize,
    n: usize,
    valve: Valve,
    branch: usize,
    waits: Waits,
}

/// What a leg waits for.
#[derive(PartialEq)]
enum Waits {
    Nothing,
    /// It conducts only with its gate.
    Gate,
    /// It begins only with its gate.
    Trigger,
}

/// What a contact is while closed and open.
struct Contact {
    p: usize,
    n: usize,
    branch: usize,
    conductances: [f64; 2],
}

/// A circuit on its way.
pub(super) struct Walk<'a> {
    circuit: &'a Circuit,
    /// Changes of sources, and of levels of gates, as parts.
    changes: &'a [f64],
    legs: Vec<Leg>,
    contacts: Vec<Contact>,
    windings: Vec<Windings>,
    factors: Factors,
    /// Which legs conduct, and which did at the end of the last step.
    on: u64,
    latched: u64,
    /// Gates of all branches during the step.
    gates: Vec<bool>,
    t: f64,
    /// The last edge of a gate.
    edge: f64,
    /// Current of a coil or voltage of a capacitor, for each branch.
    pub x: Vec<f64>,
    /// Integrals of the potentials.
    pub fluxes: Vec<f64>,
    /// Largest potential so far.
    pub largest: f64,
    /// Times of all steps, s.
    pub times: Vec<f64>,
    /// By how much the voltage of each diode is above its forward voltage then, V; nothing for other branches.
    pub over: Vec<Vec<f64>>,
}

impl<'a> Walk<'a> {
    pub fn new(circuit: &'a Circuit, changes: &'a [f64]) -> Self {
        let (mut legs, mut contacts, mut windings) = (Vec::new(), Vec::new(), Vec::new());
        for (branch, b) in circuit.branches.iter().enumerate() {
            let (p, n) = (b.p, b.n);
            let half = |valve: Valve| Valve { g_off: 0.5 * valve.g_off, ..valve };
            let mut leg = |p, n, valve, waits| legs.push(Leg { p, n, valve, branch, waits });
            match b.kind {
                Kind::Diode(valve) => leg(p, n, valve, Waits::Nothing),
                Kind::Thyristor(valve, _) => leg(p, n, valve, Waits::Trigger),
                Kind::Igbt(valve, _) => {
                    leg(p, n, half(valve), Waits::Gate);
                    leg(n, p, half(valve), Waits::Nothing);
                }
                Kind::Mosfet(valve, _) => {
                    leg(n, p, half(valve), Waits::Nothing);
                    let conductances = [0.5 * valve.g_off, 1.0 / valve.r_on];
                    contacts.push(Contact { p, n, branch, conductances });
                }
                Kind::Switch(valve, _) => {
                    let conductances = [valve.g_off, 1.0 / valve.r_on];
                    contacts.push(Contact { p, n, branch, conductances });
                }
                Kind::Transformer(p2, n2, ratio) => {
                    windings.push(Windings { first: (p, n), second: (p2, n2), ratio });
                }
                _ => {}
            }
        }
        let start = |kind: Kind| if let Kind::Capacitor(_, v0) = kind { v0 } else { 0.0 };
        Walk {
            circuit,
            changes,
            legs,
            contacts,
            windings,
            factors: Factors::default(),
            on: 0,
            latched: 0,
            gates: vec![false; circuit.branches.len()],
            t: 0.0,
            edge: 0.0,
            x: circuit.branches.iter().map(|branch| start(branch.kind)).collect(),
            fluxes: vec![0.0; circuit.nodes],
            largest: 0.0,
            times: Vec::new(),
            over: vec![Vec::new(); circuit.branches.len()],
        }
    }

    /// Goes on to a time, in steps no longer than `h` that end wherever a gate changes.
    pub fn go(&mut self, end: f64, h: f64) -> Result<(), Undecided> {
        while end - self.t > 1e-12 {
            self.set_gates();
            let edge = self.next_edge();
            let next = edge.min(end);
            self.settle(next, h)?;
            let steps = ((next - self.t) / h - 1e-6).ceil().max(0.0);
            let (start, step) = (self.t, (next - self.t) / steps);
            for k in 0..steps as usize {
                self.t = start + k as f64 * step;
                self.step(step)?;
            }
            self.t = next;
            if next == edge {
                self.edge = edge;
            }
        }
        Ok(())
    }

    /// Behind the start and each edge goes on in steps that begin short and grow: charges pass through small resistances.
    fn settle(&mut self, end: f64, h: f64) -> Result<(), Undecided> {
        if self.t > 0.0 && self.t != self.edge {
            return Ok(());
        }
        for halvings in (1..=HALVINGS).rev() {
            let step = h * 0.5_f64.powi(halvings);
            for _ in 0..EACH {
                if self.t + step >= end {
                    return Ok(());
                }
                self.step(step)?;
                self.t += step;
            }
        }
        Ok(())
    }

    /// The next instant at which a gate may change.
    fn next_edge(&self) -> f64 {
        let later = self.t + 1e-12;
        let edges = self.circuit.branches.iter().filter_map(|branch| match branch.kind.gate()? {
            Gate::Pulse { period, width, delay } => {
                let k = ((later - delay) / period).floor().max(0.0);
                [0.0, width, 1.0].map(|part| delay + (k + part) * period).into_iter().find(|t| *t > later)
            }
            Gate::Sampled { ts, .. } => Some(((later / ts).floor() + 1.0) * ts),
        });
        edges.fold(f64::INFINITY, f64::min)
    }

    fn set_gates(&mut self) {
        let soon = self.t + 1e-12;
        for (k, branch) in self.circuit.branches.iter().enumerate() {
            match branch.kind.gate() {
                Some(Gate::Pulse { period, width, delay }) => {
                    let at = (soon - delay) / period;
                    self.gates[k] = at >= 0.0 && at - at.floor() < width;
                }
                Some(Gate::Sampled { branch, ts, below }) if soon - (soon / ts).floor() * ts < 1e-11 => {
                    self.gates[k] = self.x[branch] < below + self.changes[k] * self.size(branch);
                }
                _ => {}
            }
        }
    }

    /// About how large the state of a branch is.
    fn size(&self, branch: usize) -> f64 {
        self.x[branch].abs().max(1.0)
    }

    fn step(&mut self, h: f64) -> Result<(), Undecided> {
        let gh = GAMMA * h;
        let start = self.x.clone();
        let v = self.stage(self.t + gh, gh, &start)?;
        let between = self.states(&v, gh, &start);
        let slopes = between.iter().zip(&start).map(|(a, b)| (a - b) / gh);
        let base: Vec<f64> = start.iter().zip(slopes).map(|(x, k)| x + (1.0 - GAMMA) * h * k).collect();
        self.fluxes.iter_mut().zip(&v[1..]).for_each(|(flux, v)| *flux += (h - gh) * v);
        let v = self.stage(self.t + h, gh, &base)?;
        self.x = self.states(&v, gh, &base);
        self.fluxes.iter_mut().zip(&v[1..]).for_each(|(flux, v)| *flux += gh * v);
        self.latched = self.on;
        self.largest = v.iter().fold(self.largest, |most, v| most.max(v.abs()));
        self.times.push(self.t + h);
        for leg in self.legs.iter().filter(|leg| leg.waits == Waits::Nothing) {
            if let Kind::Diode(valve) = self.circuit.branches[leg.branch].kind {
                self.over[leg.branch].push(v[leg.p] - v[leg.n] - valve.v_f);
            }
        }
        Ok(())
    }

    /// `x = base + gh f(x)` at these potentials.
    fn states(&self, v: &[f64], gh: f64, base: &[f64]) -> Vec<f64> {
        let next = |(k, b): (usize, &super::Branch)| match b.kind {
            Kind::Coil(l) => base[k] + gh / l * (v[b.p] - v[b.n]),
            Kind::Capacitor(..) => v[b.p] - v[b.n],
            _ => 0.0,
        };
        self.circuit.branches.iter().enumerate().map(next).collect()
    }

    /// Potentials at which no valve contradicts itself.
    fn stage(&mut self, t: f64, gh: f64, base: &[f64]) -> Result<Vec<f64>, Undecided> {
        let may = |(k, leg): (usize, &Leg)| match leg.waits {
            Waits::Nothing => true,
            Waits::Gate => self.gates[leg.branch],
            Waits::Trigger => self.gates[leg.branch] || self.latched >> k & 1 == 1,
        };
        let free = self.legs.iter().enumerate().map(|leg| u64::from(may(leg)) << leg.0).sum::<u64>();
        let parts = self.parts(t, gh, base);
        let last = self.on & free;
        for distance in 0..=self.legs.len() as u32 {
            for change in
                (0..1_u64 << self.legs.len()).filter(|c| c.count_ones() == distance && c & !free == 0)
            {
                let on = last ^ change;
                let v = self.potentials(on, gh, &parts);
                if self.agrees(on, free, &v) {
                    self.on = on;
                    return Ok(v);
                }
            }
        }
        Err(Undecided::Coarse)
    }

    /// Whether what conducts does so forwards, and what could conduct has no reason to.
    fn agrees(&self, on: u64, free: u64, v: &[f64]) -> bool {
        let slack = 1e-12 * v.iter().fold(1.0, |most: f64, v| most.max(v.abs()));
        self.legs.iter().enumerate().all(|(k, leg)| {
            let over = v[leg.p] - v[leg.n] - leg.valve.v_f;
            match (on >> k & 1 == 1, free >> k & 1 == 1) {
                (true, _) => over > -slack,
                (false, true) => over < slack,
                (false, false) => true,
            }
        })
    }

    /// All branches but the legs, as conductances and currents.
    fn parts(&self, t: f64, gh: f64, base: &[f64]) -> Vec<Admittance> {
        let mut parts = Vec::new();
        for (k, b) in self.circuit.branches.iter().enumerate() {
            let factor = 1.0 + self.changes[k];
            let (g, i) = match b.kind {
                Kind::Resistor(r) => (1.0 / r, 0.0),
                Kind::Coil(l) => (gh / l, base[k]),
                Kind::Capacitor(c, _) => (c / gh, -c / gh * base[k]),
                Kind::Voltage(source, r) => (1.0 / r, -factor * source.at(t) / r),
                Kind::Current(source) => (0.0, factor * source.at(t)),
                _ => continue,
            };
            parts.push(Admittance { p: b.p, n: b.n, g, i });
        }
        for Contact { p, n, branch, conductances } in &self.contacts {
            let g = conductances[usize::from(self.gates[*branch])];
            parts.push(Admittance { p: *p, n: *n, g, i: 0.0 });
        }
        parts
    }

    fn potentials(&mut self, on: u64, gh: f64, parts: &[Admittance]) -> Vec<f64> {
        let mut parts = parts.to_vec();
        for (k, Leg { p, n, valve, .. }) in self.legs.iter().enumerate() {
            let Valve { v_f, r_on, g_off } = *valve;
            // Both lines meet at the forward voltage.
            let (g, i) = match on >> k & 1 == 1 {
                true => (1.0 / r_on, (g_off - 1.0 / r_on) * v_f),
                false => (g_off, 0.0),
            };
            parts.push(Admittance { p: *p, n: *n, g, i });
        }
        let closed = self.contacts.iter().map(|contact| u64::from(self.gates[contact.branch]));
        let mask = closed.fold(on, |mask, closed| mask << 1 | closed);
        self.factors.solve((mask, gh.to_bits()), self.circuit.nodes, &parts, &self.windings)
    }
}
