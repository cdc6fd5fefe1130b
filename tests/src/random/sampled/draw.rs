//! Loops of a seed.

use super::super::dice::{Dice, rounded};
use super::{Controller, Loop, Measuring, Sampled, Signal, Stage, Static, Sum, Windup};

const TIMES: [f64; 6] = [1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05];

pub(super) fn draw(seed: u64) -> Sampled {
    let mut dice = Dice::new(seed ^ 0x5A3D);
    let many = dice.one_of(&[1, 1, 1, 2, 2, 3, 4]);
    let first = dice.below(TIMES.len());
    let mut loops = Vec::new();
    for _ in 0..many {
        // Rates beside each other are no further apart than twice tenfold.
        let ts = TIMES[(first + dice.below(3)).min(TIMES.len() - 1)];
        loops.push(one(&mut dice, ts));
    }
    let longest = loops.iter().map(|one| one.ts).fold(0.0, f64::max);
    let stop = rounded(longest * dice.decades(20.0, 200.0));
    for one in &mut loops {
        one.place(&mut dice, stop);
    }
    Sampled { loops, stop }
}

impl Loop {
    /// Times of what depends on time alone.
    fn place(&mut self, dice: &mut Dice, stop: f64) {
        for signal in [&mut self.reference, &mut self.disturbance] {
            match signal {
                Signal::Step { time, .. } => *time = rounded(dice.number(0.01, 0.8) * stop),
                Signal::Sine { frequency, .. } => *frequency = rounded(dice.decades(0.5, 8.0) / stop),
                Signal::Pulse { period, .. } => *period = rounded(dice.decades(0.1, 0.8) * stop),
                Signal::Constant(_) => {}
            }
        }
    }
}

fn one(dice: &mut Dice, ts: f64) -> Loop {
    let size = dice.decades(0.3, 5.0);
    let reference = match dice.below(5) {
        0 => Signal::Constant(size),
        1..=2 => Signal::Step { time: 0.0, after: size },
        3 => Signal::Sine { amplitude: size, frequency: 1.0 },
        _ => Signal::Pulse { amplitude: size, period: 1.0, width: dice.number(0.2, 0.8) },
    };
    let disturbance = match dice.below(4) {
        0 => Signal::Step { time: 0.0, after: rounded(0.3 * size) },
        1 => Signal::Sine { amplitude: rounded(0.2 * size), frequency: 1.0 },
        _ => Signal::Constant(0.0),
    };
    let is_cascade = dice.chance(0.35);
    let first = plant(dice, ts, 2);
    let second = if is_cascade || dice.chance(0.4) { plant(dice, 3.0 * ts, 2) } else { Vec::new() };
    let limit = (!second.is_empty() && dice.chance(0.4)).then(|| rounded(size * dice.number(0.2, 1.2)));
    let outer = is_cascade.then(|| {
        let ts = rounded(ts * dice.one_of(&[2.0, 3.0, 5.0, 10.0, 2.5]));
        (ts, controller(dice, ts, size))
    });
    let measuring = match dice.below(8) {
        0 => Measuring::Hold,
        1 => Measuring::Mean(2 + dice.below(4)),
        2 => Measuring::Late(1 + dice.below(3)),
        3 => Measuring::Coarse(rounded(size * dice.number(0.02, 0.2))),
        _ => Measuring::Directly,
    };
    let mut actuator = Vec::new();
    for _ in 0..dice.below(3) {
        actuator.push(match dice.below(4) {
            0..=1 => Static::Saturation(rounded(size * dice.number(0.4, 2.0))),
            2 => Static::DeadZone(rounded(size * dice.number(0.02, 0.2))),
            _ => Static::Quantizer(rounded(size * dice.number(0.02, 0.2))),
        });
    }
    Loop {
        reference,
        disturbance,
        ts,
        measuring,
        controller: controller(dice, ts, size),
        outer,
        actuator,
        rate: dice.chance(0.25).then(|| rounded(size / ts * dice.number(0.02, 0.4))),
        first,
        limit,
        second,
        count: dice.chance(0.4).then(|| rounded(size * dice.number(0.1, 0.9))),
    }
}

fn plant(dice: &mut Dice, ts: f64, most: usize) -> Vec<Stage> {
    (0..1 + dice.below(most))
        .map(|i| match dice.below(5) {
            0 if i == 0 => Stage::Integrator(rounded(dice.decades(0.02, 0.3) / ts)),
            1 => Stage::Swing(rounded(dice.decades(0.02, 0.6) / ts), dice.number(0.1, 1.2)),
            _ => Stage::Lag(rounded(ts * dice.decades(1.0, 50.0))),
        })
        .collect()
}

fn controller(dice: &mut Dice, ts: f64, size: f64) -> Controller {
    let any = [Sum::ForwardEuler, Sum::BackwardEuler, Sum::Trapezoidal];
    let limit = dice.chance(0.5).then(|| rounded(size * dice.number(0.4, 2.0)));
    match dice.below(6) {
        0 => {
            let a = dice.number(0.2, 0.9);
            let gain = dice.decades(0.3, 2.0);
            // A lead or a lag, with and without a way through at the same sample.
            match dice.below(3) {
                0 => Controller::Transfer { num: vec![rounded(gain * (1.0 - a))], den: vec![1.0, -a] },
                1 => Controller::Transfer { num: vec![gain, rounded(-0.8 * gain)], den: vec![1.0, -a] },
                _ => Controller::Transfer { num: vec![0.2, 0.1, 0.05], den: vec![1.0, -1.2, 0.4] },
            }
        }
        1 => Controller::Integral {
            gain: rounded(dice.decades(0.01, 0.1) / ts),
            method: dice.one_of(&any),
            limit,
        },
        _ => {
            let windup = match limit {
                None => Windup::None,
                Some(_) => dice.one_of(&[Windup::None, Windup::Clamping, Windup::BackCalculation]),
            };
            // What clamps looks at a sum that does not depend on whether it does only so.
            let integrator = if windup == Windup::Clamping { Sum::ForwardEuler } else { dice.one_of(&any) };
            Controller::Pid {
                kp: dice.decades(0.2, 2.0),
                ki: if dice.chance(0.7) { rounded(dice.decades(0.01, 0.2) / ts) } else { 0.0 },
                kd: if dice.chance(0.4) { rounded(ts * dice.decades(0.2, 2.0)) } else { 0.0 },
                n: rounded(dice.decades(0.1, 1.5) / ts),
                integrator,
                filter: dice.one_of(&any),
                limit,
                windup,
            }
        }
    }
}
