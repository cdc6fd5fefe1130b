//! What the nodes of a run are at a point, and how their states change.

use super::laws::{branch, holds, on_branch, plain};
use super::model::{Law, Method};
use super::run::Run;

/// At which point the nodes are evaluated.
#[derive(Clone, Copy)]
pub(super) enum Point {
    /// Within the step that begins at the present time and whose middle is this.
    Within(f64),
    /// At an instant; whether it is the first look.
    Instant,
}

/// Number of continuous states.
pub(super) fn states(law: &Law) -> usize {
    match law {
        Law::Integrator { .. } | Law::LowPass { .. } | Law::Derivative { .. } => 1,
        Law::Transfer { den, .. } => den.len() - 1,
        Law::Pid(_) => 2,
        _ => 0,
    }
}

impl Run<'_> {
    /// Outputs of all nodes at `t`, from the states.
    pub(super) fn evaluate(&mut self, t: f64, point: Point) {
        for i in 0..self.order.len() {
            let n = self.order[i];
            let model = self.model;
            let law = &model.nodes[n].law;
            let u = self.inputs(n);
            let instant = matches!(point, Point::Instant);
            if let Some(y) = plain(law, t, &u) {
                self.y[n] = y;
                if instant && let Some(piece) = self.piece(n, &u) {
                    self.held[n] = piece;
                }
                continue;
            }
            if instant && let Some(branch) = branch(law, t, &u, self.held[n], self.shift(n)) {
                self.held[n] = branch;
            }
            let place = self.place[n];
            let elapsed = t - self.t;
            self.y[n] = match law {
                Law::RateLimiter { rising, falling, .. } => {
                    u[0].clamp(self.last[n] + falling * elapsed, self.last[n] + rising * elapsed)
                }
                Law::Backlash { width, .. } => self.last[n].clamp(u[0] - 0.5 * width, u[0] + 0.5 * width),
                Law::HitCrossing { at, edge } => {
                    let value = u[0] + self.shift(n) - at;
                    if instant && self.triggers[n].look(value, *edge) {
                        self.counts[n] += 1.0;
                    }
                    self.counts[n]
                }
                Law::TransportDelay { delay, y0 } => {
                    let within = match point {
                        Point::Within(middle) => middle - delay,
                        Point::Instant => t - delay + 1e-12,
                    };
                    self.past[n].at(t - delay, within).unwrap_or(*y0)
                }
                Law::Integrator { .. } => {
                    if instant && !self.late[n] {
                        self.set_back(n);
                    }
                    self.x[place]
                }
                Law::LowPass { .. } => self.x[place],
                Law::Transfer { num, den } => {
                    let direct = if num.len() == den.len() { num[0] } else { 0.0 };
                    let state = self.x.get(place).copied().filter(|_| den.len() > 1).unwrap_or(0.0);
                    direct * u[0] + state
                }
                Law::Derivative { n: cut } => cut * (u[0] - self.x[place]),
                Law::Pid(gains) => {
                    let (v, _) = gains.sum(u[0], self.x[place], self.x[place + 1]);
                    if instant {
                        self.held[n] = gains.clamped(v + self.shift(n), u[0], self.held[n], true);
                    }
                    gains.limited(v)
                }
                Law::Delay { .. }
                | Law::Hold { .. }
                | Law::DiscreteIntegrator { .. }
                | Law::DiscreteTransfer { .. }
                | Law::DiscretePid { .. } => {
                    if instant && self.is_due(n) {
                        self.sampled(n)
                    } else {
                        self.y[n]
                    }
                }
                law => on_branch(law, self.held[n], &u),
            };
        }
    }

    /// Sets an integrator back if its trigger says so; returns whether its state has changed.
    pub(super) fn set_back(&mut self, n: usize) -> bool {
        let Law::Integrator { x0, reset: Some(edge), .. } = self.model.nodes[n].law else { return false };
        let value = self.y[self.model.nodes[n].inputs[1]] + self.shift(n);
        let place = self.place[n];
        let before = self.x[place];
        if self.triggers[n].look(value, edge) {
            self.x[place] = x0;
        }
        self.x[place] != before
    }

    pub(super) fn is_due(&self, n: usize) -> bool {
        let ts = self.model.nodes[n].law.sample_time();
        ts.is_some_and(|ts| self.hits[n] as f64 * ts <= self.t + 1e-12)
    }

    /// The output of a sampled node at a hit.
    fn sampled(&self, n: usize) -> f64 {
        let u = self.inputs(n);
        let held = &self.samples[n];
        match &self.model.nodes[n].law {
            Law::Delay { .. } => held[0],
            Law::DiscreteIntegrator { ts, method, gain, limit } => {
                let share = match method {
                    Method::ForwardEuler => 0.0,
                    Method::BackwardEuler => 1.0,
                    Method::Trapezoidal => 0.5,
                };
                within(held[0] + share * gain * ts * u[0], *limit)
            }
            Law::DiscreteTransfer { num, den, .. } => {
                let direct = if num.len() == den.len() { num[0] } else { 0.0 };
                direct * u[0] + held[0]
            }
            Law::DiscretePid { gains, .. } => gains.limited(gains.sum(u[0], held[0], held[1]).0),
            _ => u[0],
        }
    }

    /// What a sampled node remembers until the next hit.
    pub(super) fn remember(&mut self, n: usize) {
        let u = self.inputs(n);
        let y = self.y[n];
        let held = &mut self.samples[n];
        match &self.model.nodes[n].law {
            Law::Delay { .. } => {
                held.remove(0);
                held.push(u[0]);
            }
            Law::DiscreteIntegrator { ts, method, gain, limit } => {
                let rest = match method {
                    Method::ForwardEuler => 1.0,
                    Method::BackwardEuler => 0.0,
                    Method::Trapezoidal => 0.5,
                };
                held[0] = within(y + rest * gain * ts * u[0], *limit);
            }
            Law::DiscreteTransfer { num, den, .. } => {
                let next = observer(num, den, held, u[0]);
                held.copy_from_slice(&next);
            }
            Law::DiscretePid { ts, gains } => {
                let (v, derivative) = gains.sum(u[0], held[0], held[1]);
                let clamped = gains.clamped(v, u[0], 0.0, false) != 0.0;
                held[0] += ts * gains.growth(v, u[0], clamped);
                held[1] += ts * derivative;
            }
            _ => {}
        }
    }

    pub(super) fn slopes(&self) -> Vec<f64> {
        let mut dx = vec![0.0; self.x.len()];
        for (n, node) in self.model.nodes.iter().enumerate() {
            let place = self.place[n];
            let u = self.inputs(n);
            let x = &self.x[place..place + states(&node.law)];
            match &node.law {
                Law::Integrator { reset, .. } => {
                    let stands = holds(*reset) && self.triggers[n].is_high();
                    dx[place] = if stands || self.pinned[n] { 0.0 } else { u[0] };
                }
                Law::LowPass { tau, .. } => dx[place] = (u[0] - x[0]) / tau,
                Law::Derivative { n: cut } => dx[place] = cut * (u[0] - x[0]),
                Law::Transfer { num, den } => {
                    let next = observer(num, den, x, u[0]);
                    dx[place..place + x.len()].copy_from_slice(&next);
                }
                Law::Pid(gains) => {
                    let (v, derivative) = gains.sum(u[0], x[0], x[1]);
                    dx[place] = gains.growth(v, u[0], self.held[n] != 0.0);
                    dx[place + 1] = derivative;
                }
                _ => {}
            }
            dx[place..place + x.len()].iter_mut().for_each(|dx| *dx *= 1.0 + self.rates[n]);
        }
        let probes = dx.len() - self.model.probes.len();
        self.model.probes.iter().enumerate().for_each(|(i, &probe)| dx[probes + i] = self.y[probe]);
        dx
    }
}

fn within(x: f64, limit: Option<f64>) -> f64 {
    limit.map_or(x, |limit| x.clamp(-limit, limit))
}

/// States of a rational function in observable form: slopes, or the next values. The first state is what the output has beside
/// what comes straight from the input.
fn observer(num: &[f64], den: &[f64], z: &[f64], u: f64) -> Vec<f64> {
    let n = den.len() - 1;
    let b = |i: usize| if i + num.len() < n + 1 { 0.0 } else { num[i + num.len() - n - 1] };
    (0..n)
        .map(|i| {
            let next = z.get(i + 1).copied().unwrap_or(0.0);
            next + (b(i + 1) - den[i + 1] * b(0)) * u - den[i + 1] * z[0]
        })
        .collect()
}
