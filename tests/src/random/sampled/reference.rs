//! A loop over its samples.

use super::super::dice::Dice;
use super::super::puzzle::Undecided;
use super::control::Memory;
use super::plant::Plant;
use super::{Loop, Measuring, Signal, Static};

/// What is measured is changed by so much, as part of its size, to see what depends on it.
const CHANGE: f64 = 1e-5;

/// What comes out of a loop.
pub struct Outcome {
    /// Behind the first half and behind all, in the end.
    outputs: [f64; 2],
    sizes: [f64; 2],
    integral: f64,
    count: f64,
    /// The control at each sample.
    pub control: Vec<f64>,
    /// What the actuator gives in the end.
    given: f64,
    stop: f64,
    slack: f64,
}

impl Outcome {
    /// Names, values and how far they may be off.
    pub fn ends(&self) -> [(&'static str, f64, f64); 5] {
        let slack = |size: f64| self.slack * (size + 1e-3);
        [
            ("inner", self.outputs[0], slack(self.sizes[0])),
            ("y", self.outputs[1], slack(self.sizes[1])),
            ("sum", self.integral, self.stop * slack(self.sizes[1])),
            ("count", self.count, 0.5),
            ("given", self.given, slack(self.control_size())),
        ]
    }

    pub fn control_size(&self) -> f64 {
        self.control.iter().fold(0.0, |size, c| size.max(c.abs()))
    }

    fn differs(&self, other: &Outcome) -> bool {
        let mut ends = self.ends().into_iter().zip(other.ends());
        let slack = 0.3 * self.slack * (self.control_size() + 1e-3);
        let mut control = self.control.iter().zip(&other.control);
        ends.any(|((_, a, slack), (_, b, _))| (a - b).abs() > 0.3 * slack)
            || control.any(|(a, b)| (a - b).abs() > slack)
    }
}

/// What comes out, or why nobody knows.
pub(super) fn refer(one: &Loop, stop: f64, slack: f64, change: f64) -> Result<Outcome, Undecided> {
    let change = change * CHANGE;
    let outcome = walk(one, stop, slack, None)?;
    for seed in [1, 2] {
        let other = walk(one, stop, slack, Some((&outcome, change, seed)))?;
        if outcome.differs(&other) {
            return Err(Undecided::Sensitive);
        }
    }
    Ok(outcome)
}

/// A time written in decimals and a multiple of a sample time are the same instant.
const SAME: f64 = 1e-12;

impl Signal {
    fn at(&self, t: f64) -> f64 {
        match *self {
            Signal::Constant(value) => value,
            Signal::Step { time, after } => after * f64::from(t >= time - SAME),
            Signal::Sine { amplitude, frequency } => {
                amplitude * (std::f64::consts::TAU * frequency * t).sin()
            }
            Signal::Pulse { amplitude, period, width } => {
                let within = (t + SAME) - ((t + SAME) / period).floor() * period;
                amplitude * f64::from(within < width * period)
            }
        }
    }
}

impl Static {
    fn of(self, u: f64) -> f64 {
        match self {
            Static::Saturation(limit) => u.max(-limit).min(limit),
            Static::DeadZone(half) => (u.abs() - half).max(0.0) * u.signum(),
            Static::Quantizer(interval) => (u / interval).round() * interval,
        }
    }
}

fn walk(
    one: &Loop,
    stop: f64,
    slack: f64,
    change: Option<(&Outcome, f64, u64)>,
) -> Result<Outcome, Undecided> {
    let mut dice = Dice::new(change.map_or(0, |(.., seed)| seed));
    let mut changed = |value: f64, output: usize| {
        let size = change.map_or(0.0, |(outcome, part, _)| part * (outcome.sizes[output] + 1e-3));
        value + size * (2.0 * dice.unit() - 1.0)
    };
    let mut plant = Plant::new(one);
    let mut inner = Memory::new(&one.controller, one.ts);
    let mut outer = one.outer.as_ref().map(|(ts, law)| (*ts, Memory::new(law, *ts)));
    let (mut control, mut measured) = (Vec::new(), Vec::new());
    let (mut count, mut above, mut set, mut slow) = (0.0, 0.0, 0.0, 0_u32);
    let which = usize::from(one.outer.is_none());
    let mut fast = 0_u32;
    loop {
        let next = f64::from(fast) * one.ts;
        let later = one.outer.as_ref().map_or(f64::INFINITY, |(ts, _)| f64::from(slow) * ts);
        let t = next.min(later);
        if t > stop + SAME {
            break;
        }
        plant.go(t);
        if !plant.outputs().iter().all(|y| y.abs() < 1e4) {
            return Err(Undecided::Grows);
        }
        if let Some((_, outer)) = outer.as_mut().filter(|_| later <= t + SAME) {
            set = outer.next(one.reference.at(t) - changed(plant.outputs()[1], 1));
            slow += 1;
        }
        if next <= t + SAME {
            fast += 1;
            let output = changed(plant.outputs()[which], which);
            let ago = |steps: usize| measured.len().checked_sub(steps).map_or(0.0, |k| measured[k]);
            let seen = match one.measuring {
                Measuring::Directly | Measuring::Hold => output,
                Measuring::Mean(n) => (output + (1..n).map(ago).sum::<f64>()) / n as f64,
                Measuring::Late(n) => ago(n),
                Measuring::Coarse(interval) => (output / interval).round() * interval,
            };
            measured.push(output);
            // A memory of one sample shows what has been counted before.
            count += std::mem::replace(
                &mut above,
                f64::from(one.count.is_some_and(|threshold| output > threshold)),
            );
            let wanted = if one.outer.is_some() { set } else { one.reference.at(t) };
            let c = inner.next(wanted - seen);
            control.push(c);
            plant.give(one.actuator.iter().fold(c, |u, part| part.of(u)));
        }
    }
    plant.go(stop);
    Ok(Outcome {
        outputs: plant.outputs(),
        sizes: plant.sizes,
        integral: plant.integral(),
        count,
        control,
        given: plant.given(),
        stop,
        slack,
    })
}
