//! A model of a seed.

use super::super::dice::{Dice, rounded};
use super::model::{Edge, Gains, Gate, Law, Method, Model, Node, Relation, Smooth, Way, Windup};

/// How large a model is to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Fewest blocks.
    pub least: usize,
    /// Most blocks.
    pub most: usize,
}

impl Size {
    /// From a few to fifty blocks, few of them more often.
    pub fn any(dice: &mut Dice) -> Size {
        let most = dice.one_of(&[6, 6, 9, 9, 12, 15, 20, 30, 50]);
        Size { least: 3, most }
    }
}

/// Sample times that fit a common clock, s.
const SAMPLES: [f64; 7] = [0.01, 0.02, 0.025, 0.05, 0.1, 0.2, 0.5];

/// A model that is being built.
struct Draft<'a> {
    dice: &'a mut Dice,
    nodes: Vec<Node>,
    /// About how large the signals are.
    sizes: Vec<f64>,
    stop: f64,
}

/// The model of a seed.
pub fn generate(seed: u64) -> Model {
    let mut dice = Dice::new(seed);
    let size = Size::any(&mut dice);
    let stop = dice.one_of(&[1.0, 2.0, 4.0, 5.0, 10.0]);
    let mut draft = Draft { dice: &mut dice, nodes: Vec::new(), sizes: Vec::new(), stop };
    let blocks = size.least + draft.dice.below(size.most - size.least + 1);
    for _ in 0..1 + blocks / 5 {
        draft.source();
    }
    while draft.nodes.len() < blocks {
        draft.block();
    }
    draft.close_loops();
    draft.finish()
}

impl Draft<'_> {
    fn add(&mut self, law: Law, inputs: Vec<usize>, size: f64) -> usize {
        let boolean = match law {
            Law::Compare { .. } | Law::Logic(_) => true,
            Law::Delay { .. } | Law::Hold { .. } => self.nodes[inputs[0]].boolean,
            _ => false,
        };
        self.nodes.push(Node { law, inputs, boolean });
        self.sizes.push(size.clamp(1e-2, 1e2));
        self.nodes.len() - 1
    }

    fn source(&mut self) {
        let dice = &mut *self.dice;
        let size = dice.decades(0.3, 5.0);
        let law = match dice.below(12) {
            0 => Law::Constant(size),
            1 => Law::Step {
                time: dice.number(0.05, 0.9) * self.stop,
                before: dice.one_of(&[0.0, -size]),
                after: size,
            },
            2..=6 => Law::Sine {
                amplitude: size,
                frequency: dice.decades(0.2, 8.0),
                phase: dice.perhaps(0.4, 0.0, 6.2),
                bias: dice.one_of(&[0.0, 0.0, 0.3 * size]),
            },
            7..=8 => Law::Pulse {
                amplitude: size,
                period: dice.decades(0.05, 2.0),
                width: dice.number(0.1, 0.9),
                delay: dice.perhaps(0.5, 0.0, 0.5),
            },
            9..=10 => Law::Ramp {
                slope: dice.one_of(&[-1.0, 1.0]) * dice.decades(0.2, 5.0),
                start: dice.perhaps(0.5, 0.0, 0.5) * self.stop,
                initial: dice.one_of(&[0.0, -size]),
            },
            _ => Law::Clock,
        };
        let law = match law {
            Law::Step { time, before, after } => Law::Step { time: rounded(time), before, after },
            Law::Ramp { slope, start, initial } => Law::Ramp { slope, start: rounded(start), initial },
            Law::Sine { amplitude, frequency, phase, bias } => {
                Law::Sine { amplitude, frequency, phase, bias: rounded(bias) }
            }
            law => law,
        };
        self.add(law, Vec::new(), size);
    }

    /// A real signal, rather a late one.
    fn real(&mut self) -> usize {
        let reals: Vec<usize> = (0..self.nodes.len()).filter(|&n| !self.nodes[n].boolean).collect();
        let late = reals.len().saturating_sub(5);
        let from = if self.dice.chance(0.6) { late } else { 0 };
        reals[from + self.dice.below(reals.len() - from)]
    }

    /// A truth value; if there is none, it is made.
    fn truth(&mut self) -> usize {
        let truths: Vec<usize> = (0..self.nodes.len()).filter(|&n| self.nodes[n].boolean).collect();
        if truths.is_empty() || self.dice.chance(0.3) { self.compare() } else { self.dice.one_of(&truths) }
    }

    fn compare(&mut self) -> usize {
        let u = self.real();
        let relation = self.dice.one_of(&[
            Relation::Less,
            Relation::LessEqual,
            Relation::Greater,
            Relation::GreaterEqual,
        ]);
        if self.dice.chance(0.3) {
            let other = self.real();
            if other != u {
                return self.add(Law::Compare { relation, constant: None }, vec![u, other], 1.0);
            }
        }
        let constant = Some(self.level(u));
        self.add(Law::Compare { relation, constant }, vec![u], 1.0)
    }

    /// A number that a signal may reach.
    fn level(&mut self, u: usize) -> f64 {
        if self.dice.chance(0.15) {
            return 0.0;
        }
        rounded(self.dice.number(-0.8, 0.8) * self.sizes[u])
    }

    fn block(&mut self) {
        match self.dice.below(100) {
            0..=9 => self.source(),
            10..=29 => self.maths(),
            30..=46 => self.limit(),
            47..=64 => self.logic(),
            65..=76 => self.sampled(),
            77..=79 => {
                let u = self.real();
                let law = Law::TransportDelay { delay: self.dice.decades(0.02, 1.0), y0: 0.0 };
                self.add(law, vec![u], self.sizes[u]);
            }
            _ => self.continuous(),
        }
    }

    fn maths(&mut self) {
        let u = self.real();
        let size = self.sizes[u];
        match self.dice.below(8) {
            0 => {
                let k = self.dice.one_of(&[-1.0, 1.0]) * self.dice.decades(0.3, 3.0);
                self.add(Law::Gain(k), vec![u], size * k.abs());
            }
            1..=2 => {
                let v = self.real();
                let signs = self.dice.one_of(&[[1.0, 1.0], [1.0, -1.0], [1.0, -1.0]]).to_vec();
                self.add(Law::Sum(signs), vec![u, v], size.max(self.sizes[v]));
            }
            3 => {
                let v = self.real();
                self.add(Law::Product, vec![u, v], size * self.sizes[v]);
            }
            4 => {
                self.add(Law::Abs, vec![u], size);
            }
            5 => {
                let v = self.real();
                let greatest = self.dice.chance(0.5);
                self.add(Law::MinMax(greatest), vec![u, v], size);
            }
            6 => {
                let smooth = self.dice.one_of(&[Smooth::Sin, Smooth::Atan, Smooth::Tanh, Smooth::Square]);
                self.add(
                    Law::Function(smooth),
                    vec![u],
                    if smooth == Smooth::Square { size * size } else { 1.0 },
                );
            }
            _ => {
                let way = self.dice.one_of(&[Way::Linear, Way::Flat, Way::Nearest]);
                let n = 2 + self.dice.below(5);
                let mut at = -size;
                let mut points = Vec::new();
                let mut values = Vec::new();
                for _ in 0..n {
                    points.push(rounded(at));
                    values.push(self.dice.number(-1.0, 1.0));
                    at += size * self.dice.number(0.05, 0.8);
                }
                points.dedup();
                values.truncate(points.len());
                self.add(Law::Table { way, points, values }, vec![u], 1.0);
            }
        }
    }

    fn limit(&mut self) {
        let u = self.real();
        let size = self.sizes[u];
        let part = |dice: &mut Dice, low, high| rounded(size * dice.number(low, high));
        let dice = &mut *self.dice;
        let law = match dice.below(6) {
            0 => Law::Saturation { lower: part(dice, -0.9, -0.1), upper: part(dice, 0.1, 0.9) },
            1 => Law::DeadZone { start: part(dice, -0.7, -0.05), end: part(dice, 0.05, 0.7) },
            2..=3 => {
                Law::RateLimiter { rising: part(dice, 0.3, 9.0), falling: part(dice, -9.0, -0.3), y0: 0.0 }
            }
            4 => Law::Backlash { width: part(dice, 0.1, 1.0), y0: 0.0 },
            _ => Law::Quantizer { interval: part(dice, 0.1, 0.7) },
        };
        self.add(law, vec![u], size);
    }

    fn logic(&mut self) {
        match self.dice.below(9) {
            0..=1 => {
                self.compare();
            }
            2 => {
                let u = self.real();
                self.add(Law::Sign, vec![u], 1.0);
            }
            3 => {
                let u = self.real();
                let (a, b) = (self.level(u), self.level(u));
                let (off_at, on_at) = if a < b { (a, b) } else { (b, a) };
                let size = self.dice.decades(0.3, 3.0);
                let off = self.dice.one_of(&[0.0, -size]);
                self.add(Law::Relay { on_at, off_at, on: size, off }, vec![u], size);
            }
            4..=5 => {
                let (u1, u3) = (self.real(), self.real());
                let size = self.sizes[u1].max(self.sizes[u3]);
                if self.dice.chance(0.5) {
                    let control = self.truth();
                    self.add(Law::Switch { threshold: None }, vec![u1, control, u3], size);
                } else {
                    let control = self.real();
                    let threshold = Some(self.level(control));
                    self.add(Law::Switch { threshold }, vec![u1, control, u3], size);
                }
            }
            6 => {
                let u = self.real();
                let at = self.level(u);
                let edge = self.dice.one_of(&[Edge::Rising, Edge::Falling, Edge::Either]);
                self.add(Law::HitCrossing { at, edge }, vec![u], 10.0);
            }
            _ => {
                let gate =
                    self.dice.one_of(&[Gate::And, Gate::Or, Gate::Xor, Gate::Nand, Gate::Nor, Gate::Not]);
                let a = self.truth();
                let inputs = if gate == Gate::Not { vec![a] } else { vec![a, self.truth()] };
                self.add(Law::Logic(gate), inputs, 1.0);
            }
        }
    }

    fn sampled(&mut self) {
        let u = self.real();
        let size = self.sizes[u];
        let ts = self.dice.one_of(&SAMPLES);
        match self.dice.below(8) {
            0..=1 => {
                let u = if self.dice.chance(0.3) { self.truth() } else { u };
                self.add(Law::Delay { ts, steps: 1, x0: 0.0 }, vec![u], size);
            }
            2..=3 => {
                let u = if self.dice.chance(0.2) { self.truth() } else { u };
                self.add(Law::Hold { ts }, vec![u], size);
            }
            4 => {
                let steps = 2 + self.dice.below(5);
                self.add(Law::Delay { ts, steps, x0: 0.0 }, vec![u], size);
            }
            5 => {
                let method =
                    self.dice.one_of(&[Method::ForwardEuler, Method::BackwardEuler, Method::Trapezoidal]);
                let limit = self.dice.one_of(&[None, Some(rounded(0.5 * size))]);
                self.add(Law::DiscreteIntegrator { ts, method, gain: 1.0, limit }, vec![u], size);
            }
            6 => {
                let a = self.dice.number(0.3, 0.95);
                let num = if self.dice.chance(0.5) { vec![1.0 - a] } else { vec![1.0 - a, 0.1] };
                self.add(Law::DiscreteTransfer { ts, num, den: vec![1.0, -a] }, vec![u], size);
            }
            _ => {
                let mut gains = self.gains(size);
                gains.n = rounded(0.5 / ts);
                self.add(Law::DiscretePid { ts, gains }, vec![u], size);
            }
        }
    }

    fn gains(&mut self, size: f64) -> Gains {
        let dice = &mut *self.dice;
        let limit = if dice.chance(0.6) { Some(rounded(size * dice.number(0.2, 1.0))) } else { None };
        let windup = match limit {
            None => Windup::None,
            Some(_) => {
                dice.one_of(&[Windup::None, Windup::Clamping, Windup::Clamping, Windup::BackCalculation])
            }
        };
        Gains {
            kp: dice.decades(0.3, 3.0),
            ki: dice.perhaps(0.6, 0.3, 5.0),
            kd: dice.perhaps(0.4, 0.01, 0.1),
            n: dice.decades(10.0, 100.0),
            limit,
            windup,
            kb: 5.0,
        }
    }

    fn continuous(&mut self) {
        let u = self.real();
        let size = self.sizes[u];
        match self.dice.below(9) {
            0..=3 => {
                let limit = if self.dice.chance(0.3) {
                    Some(rounded(size * self.dice.number(0.05, 0.6)))
                } else {
                    None
                };
                let mut inputs = vec![u];
                let reset = if self.dice.chance(0.35) {
                    let trigger = if self.dice.chance(0.5) { self.truth() } else { self.real() };
                    inputs.push(trigger);
                    Some(self.dice.one_of(&[Edge::Rising, Edge::Falling, Edge::Either, Edge::Level]))
                } else {
                    None
                };
                let x0 = self.dice.one_of(&[0.0, 0.0, rounded(limit.unwrap_or(size) * 0.3)]);
                self.add(Law::Integrator { x0, limit, reset }, inputs, limit.unwrap_or(0.5 * size));
            }
            4..=5 => {
                let tau = self.dice.decades(0.02, 1.0);
                self.add(Law::LowPass { tau, y0: 0.0 }, vec![u], size);
            }
            6 => {
                let w = self.dice.decades(2.0, 50.0);
                let d = self.dice.number(0.1, 1.2);
                let (a1, a0) = (rounded(2.0 * d * w), rounded(w * w));
                let num = match self.dice.below(3) {
                    0 => vec![a0],
                    1 => vec![a1, a0],
                    _ => vec![0.5, a1, a0],
                };
                self.add(Law::Transfer { num, den: vec![1.0, a1, a0] }, vec![u], size);
            }
            7 => {
                let n = self.dice.decades(5.0, 100.0);
                self.add(Law::Derivative { n }, vec![u], 3.0 * size);
            }
            _ => {
                let gains = self.gains(size);
                self.add(Law::Pid(gains), vec![u], gains_size(size));
            }
        }
    }

    /// Leads later signals back to what has states.
    fn close_loops(&mut self) {
        for n in 0..self.nodes.len() {
            let stateful = self.nodes[n].law.inputs() > 0 && !self.nodes[n].law.feeds_through(0);
            if !stateful || self.nodes[n].boolean || !self.dice.chance(0.4) {
                continue;
            }
            let behind: Vec<usize> = (n + 1..self.nodes.len()).filter(|&m| self.depends(m, n)).collect();
            let reals: Vec<usize> = behind.iter().copied().filter(|&m| !self.nodes[m].boolean).collect();
            let Some(&back) = (!reals.is_empty()).then(|| &reals[self.dice.below(reals.len())]) else {
                continue;
            };
            let u = self.nodes[n].inputs[0];
            let sum = self.add(Law::Sum(vec![1.0, -1.0]), vec![u, back], self.sizes[u]);
            self.nodes[n].inputs[0] = sum;
            if self.nodes[n].inputs.len() == 2 && self.dice.chance(0.2) {
                self.nodes[n].inputs[1] = self.dice.one_of(&behind);
            }
        }
    }

    fn depends(&self, node: usize, on: usize) -> bool {
        node == on || self.nodes[node].inputs.iter().any(|&u| u < node && self.depends(u, on))
    }

    fn finish(self) -> Model {
        let used: Vec<usize> = self.nodes.iter().flat_map(|node| node.inputs.clone()).collect();
        let ends = (0..self.nodes.len()).filter(|n| !used.contains(n));
        let mut probes: Vec<usize> = ends.collect();
        for _ in 0..2 {
            let more = self.dice.below(self.nodes.len());
            if self.dice.chance(0.5) && !probes.contains(&more) {
                probes.push(more);
            }
        }
        if self.dice.chance(0.15) {
            probes.clear();
        }
        Model { nodes: self.nodes, probes, stop: self.stop }
    }
}

fn gains_size(size: f64) -> f64 {
    2.0 * size
}
