//! What a circuit is. All in SI units.

/// A circuit and how it is run.
#[derive(Debug, Clone, PartialEq)]
pub struct Circuit {
    /// Nodes beside ground.
    pub nodes: usize,
    /// What lies between them.
    pub branches: Vec<Branch>,
    /// End of the run, s.
    pub stop: f64,
    /// Distance of the rows, s; all steps without.
    pub every: Option<f64>,
    /// Whether the potentials of all nodes are integrated.
    pub integrals: bool,
}

/// A branch from `p` to `n`; node 0 is ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Branch {
    /// Where it begins.
    pub p: usize,
    /// Where it ends.
    pub n: usize,
    /// What it is.
    pub kind: Kind,
}

/// What a branch is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Resistance.
    Resistor(f64),
    /// Inductance; the current starts at zero.
    Coil(f64),
    /// Capacitance and its voltage at the start.
    Capacitor(f64, f64),
    /// Voltage behind a resistance.
    Voltage(Source, f64),
    /// Current through the branch from `p` to `n`.
    Current(Source),
    /// Winding with another one from `p` to `n` of the second pair, and the ratio of the voltages.
    Transformer(usize, usize, f64),
    /// Diode.
    Diode(Valve),
    /// Contact, in both directions.
    Switch(Valve, Gate),
    /// Diode that waits for its gate.
    Thyristor(Valve, Gate),
    /// Transistor that conducts forwards, and a diode beside it.
    Igbt(Valve, Gate),
    /// Transistor that conducts in both directions, and a diode beside it.
    Mosfet(Valve, Gate),
}

/// A value over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// The same for ever.
    Direct(f64),
    /// Amplitude, frequency in Hz, phase.
    Sine(f64, f64, f64),
}

/// Forward voltage, resistance while on, conductance while off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Valve {
    /// V
    pub v_f: f64,
    /// Ohm
    pub r_on: f64,
    /// S
    pub g_off: f64,
}

/// When a gate is on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gate {
    /// From its delay on, for a share of each period.
    Pulse {
        /// s
        period: f64,
        /// Part of the period.
        width: f64,
        /// s
        delay: f64,
    },
    /// From sample to sample where the state of a branch, a coil or a capacitor, has been below a level.
    Sampled {
        /// The branch.
        branch: usize,
        /// s
        ts: f64,
        /// V or A
        below: f64,
    },
}

impl Source {
    /// Its value.
    pub fn at(self, t: f64) -> f64 {
        match self {
            Source::Direct(value) => value,
            Source::Sine(amplitude, frequency, phase) => {
                amplitude * (std::f64::consts::TAU * frequency * t + phase).sin()
            }
        }
    }
}

impl Kind {
    /// Whether it has a state.
    pub fn is_storage(&self) -> bool {
        matches!(self, Kind::Coil(_) | Kind::Capacitor(..))
    }

    /// Its gate, if it has one.
    pub(super) fn gate(&self) -> Option<Gate> {
        match self {
            Kind::Switch(_, gate)
            | Kind::Thyristor(_, gate)
            | Kind::Igbt(_, gate)
            | Kind::Mosfet(_, gate) => Some(*gate),
            _ => None,
        }
    }

    fn gate_mut(&mut self) -> Option<&mut Gate> {
        match self {
            Kind::Switch(_, gate)
            | Kind::Thyristor(_, gate)
            | Kind::Igbt(_, gate)
            | Kind::Mosfet(_, gate) => Some(gate),
            _ => None,
        }
    }

    /// Parts that could be in its place.
    pub(super) fn simpler(&self) -> Vec<Kind> {
        match *self {
            Kind::Coil(_) | Kind::Capacitor(..) | Kind::Current(_) => vec![Kind::Resistor(10.0)],
            Kind::Voltage(Source::Sine(v, ..), r) => vec![Kind::Voltage(Source::Direct(v), r)],
            Kind::Igbt(valve, gate) | Kind::Mosfet(valve, gate) => {
                vec![Kind::Diode(valve), Kind::Switch(valve, gate)]
            }
            Kind::Thyristor(valve, _) => vec![Kind::Diode(valve)],
            _ => Vec::new(),
        }
    }
}

impl Circuit {
    /// Without a branch; nobody looks at it any more.
    pub(super) fn without(&self, k: usize) -> Circuit {
        let mut fewer = self.clone();
        fewer.branches.remove(k);
        for branch in &mut fewer.branches {
            if let Some(Gate::Sampled { branch: seen, ts, .. }) = branch.kind.gate_mut() {
                if *seen == k {
                    let pulse = Gate::Pulse { period: 4.0 * *ts, width: 0.5, delay: 0.0 };
                    branch.kind.gate_mut().into_iter().for_each(|gate| *gate = pulse);
                } else if *seen > k {
                    *seen -= 1;
                }
            }
        }
        fewer.drop_bare_nodes();
        fewer
    }

    /// Nodes that nothing is left at go away.
    fn drop_bare_nodes(&mut self) {
        for node in (1..=self.nodes).rev() {
            let mut used = false;
            self.ends().for_each(|end| used |= *end == node);
            if !used {
                self.ends().filter(|end| **end > node).for_each(|end| *end -= 1);
                self.nodes -= 1;
            }
        }
    }

    fn ends(&mut self) -> impl Iterator<Item = &mut usize> {
        self.branches.iter_mut().flat_map(|branch| {
            let Branch { p, n, kind } = branch;
            let more = match kind {
                Kind::Transformer(p, n, _) => [Some(p), Some(n)],
                _ => [None, None],
            };
            [p, n].into_iter().chain(more.into_iter().flatten())
        })
    }

    /// Whether each node has a way to ground through resistances, capacitors and sources with resistance, so that no current is
    /// without a path and no potential is free, and each gate sees a state.
    pub(super) fn is_sound(&self) -> bool {
        let mut grounded = vec![false; self.nodes + 1];
        grounded[0] = true;
        for _ in 0..self.nodes {
            for Branch { p, n, kind } in &self.branches {
                if matches!(kind, Kind::Resistor(_) | Kind::Capacitor(..) | Kind::Voltage(..)) {
                    let either = grounded[*p] || grounded[*n];
                    (grounded[*p], grounded[*n]) = (either, either);
                }
            }
        }
        let sees = |gate: Option<Gate>| match gate {
            Some(Gate::Sampled { branch, .. }) => self.branches[branch].kind.is_storage(),
            _ => true,
        };
        let closes = |branch: &Branch| match branch.kind {
            Kind::Transformer(p, n, _) => p != n && branch.p != branch.n,
            _ => branch.p != branch.n,
        };
        let mut branches = self.branches.iter();
        !self.branches.is_empty()
            && grounded.into_iter().all(|grounded| grounded)
            && branches.all(|branch| closes(branch) && sees(branch.kind.gate()))
    }
}
