//! A run of the interpreter: steps, what ends them, instants.

use super::super::puzzle::Undecided;
use super::laws::{branch, distances, piece};
use super::memory::{History, Trigger};
use super::model::{Edge, Law, Model, Way};
use super::nodes::{Point, states};
use super::reference::{MOST_EVENTS, Outcome, SAME, SLACK};

/// A run and all that it remembers.
pub(super) struct Run<'a> {
    pub(super) model: &'a Model,
    pub(super) order: Vec<usize>,
    pub(super) late: Vec<bool>,
    /// First continuous state of each node; those of the integrals follow at the end.
    pub(super) place: Vec<usize>,
    pub(super) h: f64,
    pub(super) t: f64,
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) held: Vec<f64>,
    pub(super) triggers: Vec<Trigger>,
    pub(super) counts: Vec<f64>,
    pub(super) samples: Vec<Vec<f64>>,
    /// Output of nodes with play or a limited slope at the start of the step.
    pub(super) last: Vec<f64>,
    /// Whether any node limits a slope.
    pub(super) limits_slopes: bool,
    /// Which integrators stand on a limit during the step.
    pub(super) pinned: Vec<bool>,
    pub(super) past: Vec<History>,
    /// Number of the next sample of each node.
    pub(super) hits: Vec<u64>,
    /// Times at which something jumps out of a dead time.
    pub(super) jumps: Vec<f64>,
    pub(super) rates: &'a [f64],
    pub(super) shifts: &'a [f64],
    pub(super) sizes: Vec<f64>,
    pub(super) toggles: Vec<(u32, u32)>,
    /// Distances of watched conditions at the last ends of steps since an instant.
    pub(super) watched: Vec<Vec<[Option<f64>; 2]>>,
    pub(super) events: usize,
    pub(super) last_event: f64,
    pub(super) last_instant: f64,
    /// Whether two things have happened at nearly the same time.
    pub(super) crowded: bool,
    /// How many instants have been planned to come out of dead times.
    pub(super) echoes: usize,
    /// Nodes that watch a signal that stands at zero exactly, or has hardly left it.
    pub(super) rests: Vec<bool>,
}

/// Instants that come out of dead times because slopes are limited, at most.
const MOST_ECHOES: usize = 2000;

fn has_steps(law: &Law) -> bool {
    matches!(law, Law::Compare { .. } | Law::Logic(_) | Law::Sign | Law::Relay { .. } | Law::Quantizer { .. })
        || matches!(law, Law::Table { way: Way::Flat | Way::Nearest, .. })
}

impl<'a> Run<'a> {
    pub(super) fn new(model: &'a Model, steps: usize, rates: &'a [f64], shifts: &'a [f64]) -> Self {
        let n = model.nodes.len();
        let (order, late) = model.order();
        let mut place = Vec::new();
        let mut x = Vec::new();
        for node in &model.nodes {
            place.push(x.len());
            x.resize(x.len() + states(&node.law), 0.0);
            match node.law {
                Law::Integrator { x0, .. } => *x.last_mut().unwrap_or(&mut 0.0) = x0,
                Law::LowPass { y0, .. } => *x.last_mut().unwrap_or(&mut 0.0) = y0,
                _ => {}
            }
        }
        x.resize(x.len() + model.probes.len(), 0.0);
        let sample = |law: &Law| match law {
            Law::Delay { steps, x0, .. } => vec![*x0; *steps],
            Law::DiscreteTransfer { den, .. } => vec![0.0; den.len() - 1],
            Law::DiscreteIntegrator { .. } => vec![0.0],
            Law::DiscretePid { .. } => vec![0.0; 2],
            _ => Vec::new(),
        };
        let first = |law: &Law| match law {
            Law::RateLimiter { y0, .. } | Law::Backlash { y0, .. } => *y0,
            _ => 0.0,
        };
        Run {
            model,
            order,
            late,
            place,
            h: model.stop / steps as f64,
            t: 0.0,
            x,
            y: vec![0.0; n],
            held: vec![0.0; n],
            triggers: vec![Trigger::default(); n],
            counts: vec![0.0; n],
            samples: model.nodes.iter().map(|node| sample(&node.law)).collect(),
            last: model.nodes.iter().map(|node| first(&node.law)).collect(),
            limits_slopes: model.nodes.iter().any(|node| matches!(node.law, Law::RateLimiter { .. })),
            pinned: vec![false; n],
            past: vec![History::default(); n],
            hits: vec![0; n],
            jumps: Vec::new(),
            rates,
            shifts,
            sizes: vec![0.0; n],
            toggles: vec![(0, 0); n],
            watched: Vec::new(),
            events: 0,
            last_event: -1.0,
            last_instant: -1.0,
            crowded: false,
            echoes: 0,
            rests: vec![true; n],
        }
    }

    pub(super) fn finish(mut self) -> Result<Outcome, Undecided> {
        self.instant(true)?;
        while self.t < self.model.stop {
            let (end, planned) = self.next();
            self.step(end, planned)?;
        }
        let n = self.model.nodes.len();
        let probes = self.x.len() - self.model.probes.len();
        let toggles = (0..n).map(|node| has_steps(&self.model.nodes[node].law).then(|| self.toggles[node]));
        Ok(Outcome {
            end_slack: self.sizes.iter().map(|size| SLACK * (size + 1e-3)).collect(),
            integral_slack: self
                .model
                .probes
                .iter()
                .map(|&p| SLACK * self.model.stop * (self.sizes[p] + 1e-3))
                .collect(),
            integral_sizes: self.model.probes.iter().map(|&p| self.sizes[p]).collect(),
            integrals: self.x[probes..].to_vec(),
            toggles: toggles.collect(),
            others: Vec::new(),
            crowded: self.crowded,
            ends: self.y,
            sizes: self.sizes,
        })
    }

    /// The end of the next step, and whether something is planned to happen there.
    fn next(&self) -> (f64, bool) {
        let mut planned = self.model.stop;
        let mut plan = |time: f64| {
            if time > self.t + 1e-12 {
                planned = planned.min(time);
            }
        };
        for (n, node) in self.model.nodes.iter().enumerate() {
            match node.law {
                Law::Step { time, .. } | Law::Ramp { start: time, .. } => plan(time),
                Law::Pulse { period, width, delay, .. } => {
                    let k = ((self.t - delay) / period).floor().max(0.0);
                    [0.0, width, 1.0, 1.0 + width].iter().for_each(|part| plan(delay + (k + part) * period));
                }
                ref law => {
                    if let Some(ts) = law.sample_time() {
                        plan(self.hits[n] as f64 * ts);
                    }
                }
            }
        }
        self.jumps.iter().for_each(|&time| plan(time));
        let grid = ((self.t / self.h + 1e-9).floor() + 1.0) * self.h;
        if planned <= grid + 1e-12 { (planned, true) } else { (grid, false) }
    }

    /// A step to `end`, or to the first instant at which a branch changes.
    fn step(&mut self, end: f64, planned: bool) -> Result<(), Undecided> {
        self.pin();
        let (start, before) = (self.x.clone(), self.y.clone());
        self.advance(&start, end);
        if !self.turns() {
            if self.touches(&before) {
                return Err(Undecided::Grazes);
            }
            self.accept(end);
            if planned {
                // What changes exactly in the end may or may not be seen.
                self.crowded |= (self.is_sampling(end) || end >= self.model.stop) && self.near_zero();
                return self.instant(false);
            }
            return self.look();
        }
        let (mut left, mut right) = (self.t, end);
        while right - left > 1e-12 {
            let middle = 0.5 * (left + right);
            self.advance(&start, middle);
            if self.turns() { right = middle } else { left = middle }
        }
        self.advance(&start, right);
        if self.touches(&before) {
            return Err(Undecided::Grazes);
        }
        self.events += 1;
        let first = self.last_event < 0.0 && right < SAME;
        let crowded = right - self.last_event < SAME || right - self.last_instant < SAME && !first;
        self.crowded |= crowded || planned && end - right < SAME;
        if self.events > MOST_EVENTS {
            return Err(Undecided::Chatters);
        }
        self.last_event = right;
        self.accept(right);
        self.instant(false)
    }

    /// Whether a condition that watches a magnitude at zero was touched in the step from these outputs: the magnitude reaches zero
    /// where its input changes sign, for no time at all.
    fn touches(&self, before: &[f64]) -> bool {
        let nodes = &self.model.nodes;
        let changed = |m: usize| {
            let u = nodes[m].inputs.first();
            matches!(nodes[m].law, Law::Abs) && u.is_some_and(|&u| before[u] * self.y[u] < 0.0)
        };
        let at_zero = |n: usize, m: usize| {
            let near = |d: &f64| (d.abs() - self.y[m]).abs() <= 2.0 * self.shift(n).abs() + 1e-12;
            self.distances(n).iter().flatten().any(near)
        };
        (0..nodes.len()).any(|n| nodes[n].inputs.iter().any(|&m| changed(m) && at_zero(n, m)))
    }

    fn is_sampling(&self, t: f64) -> bool {
        let mut nodes = self.model.nodes.iter().zip(&self.hits);
        nodes.any(|(node, hits)| {
            node.law.sample_time().is_some_and(|ts| (*hits as f64 * ts - t).abs() < 1e-12)
        })
    }

    /// Whether a watched condition is so near to its change that nobody knows on which side it is.
    fn near_zero(&self) -> bool {
        let nodes = 0..self.model.nodes.len();
        nodes.into_iter().any(|n| {
            let scale = self.scale(n);
            self.distances(n).iter().flatten().any(|d| *d != 0.0 && d.abs() < 1e-9 * scale)
        })
    }

    /// By how much what decides node `n` is off. No method is off where nothing has happened yet, or within a dead zone.
    pub(super) fn shift(&self, n: usize) -> f64 {
        if self.rests[n] { 0.0 } else { self.shifts[n] }
    }

    /// Notes which watched signals stand at zero.
    fn note_rest(&mut self) {
        for n in 0..self.model.nodes.len() {
            let value = self.model.watched(n).map_or(0.0, |u| self.y[u]);
            self.rests[n] = value == 0.0 || self.rests[n] && value.abs() < 10.0 * self.shifts[n].abs();
        }
    }

    fn scale(&self, n: usize) -> f64 {
        self.model.nodes[n].inputs.iter().map(|&u| self.sizes[u]).fold(1e-3, f64::max)
    }

    fn distances(&self, n: usize) -> [Option<f64>; 2] {
        distances(&self.model.nodes[n].law, &self.inputs(n), self.held[n], self.shift(n))
    }

    pub(super) fn inputs(&self, n: usize) -> Vec<f64> {
        self.model.nodes[n].inputs.iter().map(|&u| self.y[u]).collect()
    }

    /// Looks whether a condition has turned round near its change.
    fn look(&mut self) -> Result<(), Undecided> {
        let now: Vec<_> = (0..self.model.nodes.len()).map(|n| self.distances(n)).collect();
        self.watched.push(now);
        let [.., a, b, c] = &self.watched[..] else { return Ok(()) };
        for n in 0..a.len() {
            for k in 0..2 {
                let (Some(a), Some(b), Some(c)) = (a[n][k], b[n][k], c[n][k]) else { continue };
                let turned = b.abs() <= a.abs() && b.abs() <= c.abs() && a * b > 0.0 && b * c > 0.0;
                // Between the steps it comes nearer to zero than at them: by what a parabola through them does.
                let bend = a - 2.0 * b + c;
                let nearest = b - (a - c) * (a - c) / (8.0 * bend);
                let beyond = nearest * b.signum() < 1e-9 * self.scale(n) + 0.1 * bend.abs();
                if turned && bend != 0.0 && beyond {
                    return Err(Undecided::Grazes);
                }
            }
        }
        self.watched.remove(0);
        Ok(())
    }

    /// Which integrators stand on a limit and are pushed outwards.
    fn pin(&mut self) {
        for n in 0..self.model.nodes.len() {
            if let Law::Integrator { limit: Some(limit), .. } = self.model.nodes[n].law {
                let (x, u) = (self.x[self.place[n]], self.y[self.model.nodes[n].inputs[0]]);
                self.pinned[n] = x >= limit && u >= 0.0 || x <= -limit && u <= 0.0;
            }
        }
    }

    /// States and outputs at `end`, from those at the start of the step.
    fn advance(&mut self, start: &[f64], end: f64) {
        let (h, t) = (end - self.t, self.t);
        let middle = Point::Within(t + 0.5 * h);
        let slope = |run: &mut Self, share: f64, k: Option<&[f64]>| {
            for (i, x) in run.x.iter_mut().enumerate() {
                *x = start[i] + k.map_or(0.0, |k| share * h * k[i]);
            }
            run.evaluate(t + share * h, middle);
            run.slopes()
        };
        let k1 = slope(self, 0.0, None);
        let k2 = slope(self, 0.5, Some(&k1));
        let k3 = slope(self, 0.5, Some(&k2));
        let k4 = slope(self, 1.0, Some(&k3));
        for i in 0..start.len() {
            self.x[i] = start[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        for n in 0..self.model.nodes.len() {
            if let Law::Integrator { limit: Some(limit), .. } = self.model.nodes[n].law {
                let x = &mut self.x[self.place[n]];
                *x = x.clamp(-limit, limit);
            }
        }
        self.evaluate(end, middle);
    }

    /// Keeps the step.
    fn accept(&mut self, end: f64) {
        self.t = end;
        self.note_rest();
        for n in 0..self.model.nodes.len() {
            self.sizes[n] = self.sizes[n].max(self.y[n].abs());
            match self.model.nodes[n].law {
                Law::RateLimiter { .. } | Law::Backlash { .. } => self.keep(n),
                Law::TransportDelay { .. } => {
                    let u = self.y[self.model.nodes[n].inputs[0]];
                    self.past[n].note(end, u);
                }
                _ => {}
            }
            // A crossing that does not count is seen all the same.
            if let Some((value, edge)) = self.trigger(n)
                && !self.triggers[n].would(value, edge)
            {
                self.triggers[n].look(value, edge);
            }
        }
    }

    /// Keeps the output of a node with play or a limited slope, and which rate limits it.
    fn keep(&mut self, n: usize) {
        self.last[n] = self.y[n];
        let behind = self.y[self.model.nodes[n].inputs[0]] - self.y[n];
        self.held[n] = if behind == 0.0 { 0.0 } else { behind.signum() };
    }

    /// What the trigger of a node sees between instants, if it has one that is not a truth value.
    fn trigger(&self, n: usize) -> Option<(f64, Edge)> {
        let node = &self.model.nodes[n];
        match node.law {
            Law::HitCrossing { at, edge } => Some((self.y[node.inputs[0]] + self.shift(n) - at, edge)),
            Law::Integrator { reset: Some(edge), .. } if !self.model.nodes[node.inputs[1]].boolean => {
                Some((self.y[node.inputs[1]] + self.shift(n), edge))
            }
            _ => None,
        }
    }

    /// Whether some branch contradicts what decides it.
    fn turns(&self) -> bool {
        (0..self.model.nodes.len()).any(|n| {
            let (u, shift) = (self.inputs(n), self.shift(n));
            match &self.model.nodes[n].law {
                Law::Step { .. } | Law::Pulse { .. } => false,
                Law::HitCrossing { .. } | Law::Integrator { .. } => {
                    self.trigger(n).is_some_and(|(value, edge)| self.triggers[n].would(value, edge))
                }
                // Where the output has caught up it may be too slow again at once, to the other side.
                Law::RateLimiter { .. } => self.held[n] != 0.0 && (u[0] - self.y[n]) * self.held[n] <= 0.0,
                Law::Pid(gains) => {
                    let x = &self.x[self.place[n]..];
                    let (v, _) = gains.sum(u[0], x[0], x[1]);
                    gains.clamped(v + shift, u[0], self.held[n], true) != self.held[n]
                }
                law => {
                    let held = self.held[n];
                    let branch = branch(law, self.t, &u, held, shift).or_else(|| self.piece(n, &u));
                    branch.is_some_and(|branch| branch != held)
                }
            }
        })
    }

    /// On which side of its kinks a node is, where anything limits slopes.
    pub(super) fn piece(&self, n: usize, u: &[f64]) -> Option<f64> {
        piece(&self.model.nodes[n].law, u).filter(|_| self.limits_slopes)
    }

    /// What happens at one instant: branches, resets, samples, jumps into dead times.
    fn instant(&mut self, first: bool) -> Result<(), Undecided> {
        let before = self.y.clone();
        let mut rounds = 0;
        let mut last = before.clone();
        let n = self.model.nodes.len();
        loop {
            self.evaluate(self.t, Point::Instant);
            for ((y, last), toggles) in self.y.iter().zip(&last).zip(&mut self.toggles) {
                toggles.1 += u32::from(!first && y != last);
            }
            last.copy_from_slice(&self.y);
            let mut jumped = false;
            for node in 0..n {
                jumped |= self.late[node] && self.set_back(node);
            }
            if !jumped {
                break;
            }
            rounds += 1;
            if rounds > 20 {
                return Err(Undecided::Chatters);
            }
        }
        for (node, before) in before.iter().enumerate() {
            self.sizes[node] = self.sizes[node].max(self.y[node].abs());
            if !self.y[node].is_finite() || self.y[node].abs() > 1e4 {
                return Err(Undecided::Grows);
            }
            if !first && self.y[node] != *before {
                self.toggles[node].0 += 1;
            }
            match self.model.nodes[node].law {
                Law::TransportDelay { delay, .. } => {
                    let u = self.y[self.model.nodes[node].inputs[0]];
                    // What is there at the start comes out as a jump, too. Where slopes are limited, no kink may lie within a step.
                    let echoes = self.limits_slopes && self.echoes < MOST_ECHOES;
                    if self.past[node].note(self.t, u) || first || echoes {
                        self.echoes += usize::from(echoes);
                        self.jumps.push(self.t + delay);
                    }
                }
                Law::Backlash { .. } | Law::RateLimiter { .. } => self.keep(node),
                _ => {}
            }
        }
        let due: Vec<usize> = (0..n).filter(|&node| self.is_due(node)).collect();
        due.iter().for_each(|&node| self.remember(node));
        due.iter().for_each(|&node| self.hits[node] += 1);
        self.jumps.retain(|&time| time > self.t);
        self.note_rest();
        self.watched.clear();
        self.last_instant = self.t;
        Ok(())
    }
}
