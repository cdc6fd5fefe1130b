//! Circuits of a seed.

use super::super::dice::{Dice, rounded};
use super::{Branch, Circuit, Gate, Kind, Source, Valve};

pub(super) fn draw(seed: u64) -> Circuit {
    let mut dice = Dice::new(seed ^ 0xC12C);
    let nodes = 2 + dice.below(5);
    let mut draft = Draft { dice: &mut dice, nodes, branches: Vec::new() };
    draft.ladder();
    draft.transformers();
    draft.sources();
    draft.valves();
    let Draft { nodes, branches, .. } = draft;
    let every = dice.chance(0.6).then_some(2e-4);
    let circuit = Circuit { nodes, branches, stop: 0.04, every, integrals: dice.chance(0.6) };
    assert!(circuit.is_sound(), "{circuit:?}");
    circuit
}

struct Draft<'a> {
    dice: &'a mut Dice,
    nodes: usize,
    branches: Vec<Branch>,
}

impl Draft<'_> {
    fn add(&mut self, p: usize, n: usize, kind: Kind) {
        self.branches.push(Branch { p, n, kind });
    }

    /// Two different nodes, ground among them.
    fn pair(&mut self) -> (usize, usize) {
        let p = self.dice.below(self.nodes + 1);
        (p, (p + 1 + self.dice.below(self.nodes)) % (self.nodes + 1))
    }

    /// Sources at the first node and perhaps at another, from there a tree of coils and resistances; each node has a resistance or
    /// a capacitor to ground.
    fn ladder(&mut self) {
        for k in 0..1 + self.dice.below(2) {
            let node = 1 + k * self.dice.below(self.nodes);
            let source = self.source(10.0, 300.0);
            let behind = self.dice.decades(0.05, 2.0);
            self.add(node, 0, Kind::Voltage(source, behind));
        }
        let load = self.dice.decades(5.0, 500.0);
        self.add(1, 0, Kind::Resistor(load));
        for node in 2..=self.nodes {
            let other = self.dice.below(node);
            let (p, n) = self.dice.one_of(&[(node, other), (other, node)]);
            let kind = match self.dice.chance(0.5) {
                true => Kind::Coil(self.dice.decades(1e-3, 2e-2)),
                false => Kind::Resistor(self.dice.decades(0.5, 200.0)),
            };
            self.add(p, n, kind);
            self.ground(node);
        }
        // Capacitors between any nodes close loops with the others.
        if self.dice.chance(0.3) {
            for _ in 0..1 + self.dice.below(3) {
                let (p, n) = self.pair();
                let c = self.dice.decades(2e-6, 1e-3);
                self.add(p, n, Kind::Capacitor(c, 0.0));
            }
        }
    }

    fn ground(&mut self, node: usize) {
        let kind = match self.dice.chance(0.35) {
            true => Kind::Capacitor(self.dice.decades(2e-5, 1e-3), 0.0),
            false => Kind::Resistor(self.dice.decades(5.0, 500.0)),
        };
        self.add(node, 0, kind);
    }

    fn source(&mut self, least: f64, most: f64) -> Source {
        let size = self.dice.decades(least, most);
        match self.dice.below(3) {
            0 => Source::Direct(size),
            _ => Source::Sine(
                size,
                self.dice.one_of(&[50.0, 60.0, 100.0, 400.0]),
                self.dice.perhaps(0.7, 0.0, 6.2),
            ),
        }
    }

    /// Windings from any pair of nodes to new ones, behind which there is a load.
    fn transformers(&mut self) {
        for _ in 0..self.dice.one_of(&[0, 0, 1, 1, 2]) {
            let (p, n) = self.pair();
            let ratio = self.dice.one_of(&[-1.0, 1.0]) * self.dice.decades(0.2, 5.0);
            self.nodes += 1;
            let far = self.nodes;
            self.ground(far);
            if self.dice.chance(0.5) {
                // The second winding bears the load through a coil or a resistance.
                self.nodes += 1;
                self.ground(self.nodes);
                let kind = self.dice.one_of(&[Kind::Coil(3e-3), Kind::Resistor(2.0)]);
                self.add(far, self.nodes, kind);
            }
            self.add(p, n, Kind::Transformer(far, 0, ratio));
        }
    }

    /// Sources of current: each node has something in parallel with them.
    fn sources(&mut self) {
        for _ in 0..self.dice.one_of(&[0, 0, 1, 2]) {
            let (p, n) = self.pair();
            let source = self.source(0.05, 5.0);
            self.add(p, n, Kind::Current(source));
        }
    }

    fn valves(&mut self) {
        for _ in 0..1 + self.dice.below(4) {
            let (p, n) = self.pair();
            let valve = self.valve();
            self.add(p, n, Kind::Diode(valve));
        }
        for _ in 0..self.dice.below(4) {
            let (p, n) = self.pair();
            let (valve, gate) = (self.valve(), self.gate());
            let kind = match self.dice.below(4) {
                0 => Kind::Switch(Valve { v_f: 0.0, ..valve }, gate),
                1 => Kind::Thyristor(valve, gate),
                2 => Kind::Igbt(valve, gate),
                _ => Kind::Mosfet(valve, gate),
            };
            self.add(p, n, kind);
        }
    }

    fn valve(&mut self) -> Valve {
        Valve {
            v_f: self.dice.one_of(&[0.0, 0.6, 0.8]),
            r_on: self.dice.decades(0.02, 0.2),
            g_off: self.dice.one_of(&[0.0, 0.0, 1e-4, 1e-3]),
        }
    }

    fn gate(&mut self) -> Gate {
        let storages: Vec<usize> =
            (0..self.branches.len()).filter(|k| self.branches[*k].kind.is_storage()).collect();
        if !storages.is_empty() && self.dice.chance(0.3) {
            let branch = self.dice.one_of(&storages);
            let size = match self.branches[branch].kind {
                Kind::Coil(_) => 3.0,
                _ => 30.0,
            };
            let ts = self.dice.one_of(&[2e-4, 5e-4, 1e-3]);
            return Gate::Sampled { branch, ts, below: rounded(size * self.dice.number(-0.5, 1.0)) };
        }
        let period = self.dice.decades(5e-4, 2e-2);
        Gate::Pulse {
            period,
            width: self.dice.number(0.1, 0.9),
            delay: if self.dice.chance(0.5) { rounded(period * self.dice.number(0.0, 1.0)) } else { 0.0 },
        }
    }
}
