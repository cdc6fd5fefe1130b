//! Motion in time: steps by the rule of the midpoint, whose impulses are found together.

use std::f64::consts::TAU;

use super::{Joint, Shafts, Torque};

/// Rounds over all joints in one step, at most.
const ROUNDS: usize = 3000;
/// Where a round changes speeds by less than this, rad/s, it was the last.
const SETTLED: f64 = 1e-12;

pub(super) struct Walk<'a> {
    shafts: &'a Shafts,
    /// Torque that each source and joint has, as parts of what is said.
    changes: &'a [f64],
    t: f64,
    pub w: Vec<f64>,
    pub phi: Vec<f64>,
    twist: Vec<f64>,
    impulse: Vec<f64>,
    /// What sampled controllers hold.
    held: Vec<f64>,
    /// Largest speed so far.
    pub largest: f64,
    /// Times of all steps, s.
    pub times: Vec<f64>,
    /// Slip of each joint then, rad/s.
    pub slips: Vec<Vec<f64>>,
}

impl<'a> Walk<'a> {
    pub fn new(shafts: &'a Shafts, changes: &'a [f64]) -> Self {
        let w: Vec<f64> = shafts.discs.iter().map(|(_, w)| *w).collect();
        let mut walk = Walk {
            changes,
            t: 0.0,
            phi: vec![0.0; w.len()],
            w,
            twist: vec![0.0; shafts.joints.len()],
            impulse: vec![0.0; shafts.joints.len()],
            held: vec![0.0; shafts.torques.len()],
            largest: 0.0,
            times: Vec::new(),
            slips: vec![Vec::new(); shafts.joints.len()],
            shafts,
        };
        // What freewheels do not let be is gone before anybody looks.
        walk.step(0.0);
        walk
    }

    /// Goes on to a time, in steps no longer than `h` that end wherever a torque jumps.
    pub fn go(&mut self, end: f64, h: f64) {
        while end - self.t > 1e-12 {
            self.sample();
            let next = self.next_edge().min(end);
            let steps = ((next - self.t) / h - 1e-6).ceil().max(1.0);
            let (start, step) = (self.t, (next - self.t) / steps);
            for k in 0..steps as usize {
                self.t = start + k as f64 * step;
                self.step(step);
            }
            self.t = next;
        }
    }

    /// The next instant at which something jumps or is sampled.
    fn next_edge(&self) -> f64 {
        let later = self.t + 1e-12;
        let multiple = |period: f64| ((later / period).floor() + 1.0) * period;
        let torques = self.shafts.torques.iter().map(|(_, torque)| match torque {
            Torque::Step { time, .. } if *time > later => *time,
            Torque::Sampled { ts, .. } => multiple(*ts),
            _ => f64::INFINITY,
        });
        let clutches = self.shafts.joints.iter().map(|(_, _, joint)| match joint {
            Joint::Friction(_, Some(period)) => multiple(0.5 * period),
            _ => f64::INFINITY,
        });
        torques.chain(clutches).fold(f64::INFINITY, f64::min)
    }

    fn sample(&mut self) {
        let soon = self.t + 1e-12;
        for ((disc, torque), held) in self.shafts.torques.iter().zip(&mut self.held) {
            if let Torque::Sampled { ts, gain, target, limit } = torque
                && soon - (soon / ts).floor() * ts < 1e-11
            {
                *held = (gain * (target - self.w[*disc])).max(-limit).min(*limit);
            }
        }
    }

    fn step(&mut self, h: f64) {
        let (t, shafts) = (self.t + 0.5 * h, self.shafts);
        let ease = |i: usize| 1.0 / shafts.discs[i].0;
        let slip = |w: &[f64], a: usize, b: Option<usize>| w[a] - b.map_or(0.0, |b| w[b]);
        let before = self.w.clone();
        let mut w = before.clone();
        for (k, (disc, torque)) in shafts.torques.iter().enumerate() {
            let tau = match torque {
                Torque::Sine { amplitude, frequency } => amplitude * (TAU * frequency * t).sin(),
                Torque::Step { time, before, after } => {
                    if t < *time {
                        *before
                    } else {
                        *after
                    }
                }
                Torque::Sampled { .. } => self.held[k],
            };
            w[*disc] += h * (1.0 + self.changes[k]) * tau * ease(*disc);
        }
        // What the impulses of the last step were is a good start.
        for (k, (a, b, _)) in shafts.joints.iter().enumerate() {
            w[*a] -= self.impulse[k] * ease(*a);
            b.iter().for_each(|b| w[*b] += self.impulse[k] * ease(*b));
        }
        for _ in 0..ROUNDS {
            let mut most = 0.0_f64;
            for (k, (a, b, joint)) in shafts.joints.iter().enumerate() {
                let both = ease(*a) + b.map_or(0.0, ease);
                let now = slip(&w, *a, *b);
                // Slip and twist in the middle of the step.
                let mean = 0.5 * (now + slip(&before, *a, *b));
                let twist = self.twist[k] + 0.5 * h * mean;
                let factor = 1.0 + self.changes[shafts.torques.len() + k];
                let next = match *joint {
                    // The law is linear in the impulse, through the slip at the end: solved for it.
                    Joint::Spring { k: stiffness, d } => {
                        let slope = h * (0.25 * h * stiffness + 0.5 * d) * both;
                        let wanted = h * (stiffness * twist + d * mean);
                        (wanted + slope * self.impulse[k]) / (1.0 + slope)
                    }
                    Joint::Stop { at, k: stiffness, d, width } => {
                        let beyond = twist.abs() - at;
                        let x = (beyond / width).clamp(0.0, 1.0);
                        let share = x * x * (3.0 - 2.0 * x);
                        let side = twist.signum();
                        side * h * share * (stiffness * beyond + d * side * mean).max(0.0)
                    }
                    Joint::Friction(torque, period) => {
                        let is_pressed = period.is_none_or(|period| (t / period).fract() < 0.5);
                        let bound = if is_pressed { h * factor * torque } else { 0.0 };
                        (self.impulse[k] + now / both).clamp(-bound, bound)
                    }
                    Joint::Freewheel => (self.impulse[k] + now / both).max(0.0),
                };
                let more = next - self.impulse[k];
                self.impulse[k] = next;
                w[*a] -= more * ease(*a);
                b.iter().for_each(|b| w[*b] += more * ease(*b));
                most = most.max((more * both).abs());
            }
            if most < SETTLED {
                break;
            }
        }
        self.times.push(self.t + h);
        for (k, (a, b, _)) in shafts.joints.iter().enumerate() {
            let now = slip(&w, *a, *b);
            self.twist[k] += 0.5 * h * (now + slip(&before, *a, *b));
            self.slips[k].push(now);
        }
        for ((phi, w), before) in self.phi.iter_mut().zip(&w).zip(&before) {
            *phi += 0.5 * h * (w + before);
        }
        self.largest = w.iter().fold(self.largest, |most, w| most.max(w.abs()));
        self.w = w;
    }
}
