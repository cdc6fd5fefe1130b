//! Mechanisms of a seed.

use super::super::dice::{Dice, rounded};
use super::{Bar, Drive, Joint, Limit, Mechanism, Mechanisms};

pub(super) fn draw(seed: u64) -> Mechanisms {
    let mut dice = Dice::new(seed ^ 0xBA12);
    let stop = dice.one_of(&[0.5, 1.0, 2.0]);
    let many = dice.one_of(&[1, 1, 1, 2, 3]);
    let mut all: Vec<Mechanism> = (0..many).map(|_| one(&mut dice, stop)).collect();
    let mut dice = Dice::new(seed ^ 0xC027);
    for one in &mut all {
        let size = if matches!(one, Mechanism::Chain { .. }) { 2.0 } else { 1.0 };
        if let Some(drive) = one.drive().filter(|_| dice.chance(0.3)) {
            *drive = controller(&mut dice, size);
        }
    }
    Mechanisms { all, stop }
}

fn controller(dice: &mut Dice, size: f64) -> Drive {
    Drive::Sampled {
        ts: dice.one_of(&[1e-3, 2e-3, 5e-3, 0.01, 0.02]),
        target: dice.number(-2.0, 2.0),
        kp: rounded(size * dice.decades(0.3, 10.0)),
        kd: rounded(size * dice.decades(0.01, 0.1)),
        limit: rounded(size * dice.decades(0.3, 5.0)),
    }
}

fn one(dice: &mut Dice, stop: f64) -> Mechanism {
    match dice.below(8) {
        0..=3 => {
            let n = 1 + dice.below(4);
            Mechanism::Chain {
                bars: (0..n).map(|_| bar(dice, 0.1, 0.5)).collect(),
                joints: (0..n).map(|_| joint(dice, 1.0, true)).collect(),
                start: (0..n).map(|_| (dice.number(-1.0, 1.0), dice.perhaps(0.5, -4.0, 4.0))).collect(),
                drive: drive(dice, stop, 2.0),
            }
        }
        4..=5 => {
            let crank = bar(dice, 0.05, 0.15);
            let rod = bar(dice, 0.25, 0.6);
            let piston = dice.number(0.1, 2.0);
            let joints = [joint(dice, 0.3, false), joint(dice, 5.0, false)];
            let start = (dice.number(0.2, 6.0), dice.number(-30.0, 30.0));
            Mechanism::Slider { crank, rod, piston, joints, start, drive: drive(dice, stop, 1.0) }
        }
        6 => {
            // The crank is the shortest, and together with the longest shorter than the others: it may turn fully.
            let bars = [bar(dice, 0.1, 0.2), bar(dice, 0.45, 0.5), bar(dice, 0.4, 0.45)];
            let joints = [joint(dice, 0.3, false), joint(dice, 0.3, false)];
            let start = (dice.number(0.2, 6.0), dice.number(-20.0, 20.0));
            Mechanism::FourBar { bars, ground: 0.5, joints, start, drive: drive(dice, stop, 1.0) }
        }
        _ => Mechanism::Ball {
            mass: dice.number(0.2, 2.0),
            tilt: dice.perhaps(0.6, 0.05, 0.6),
            stiffness: dice.decades(3e3, 1e5),
            damping: dice.decades(5.0, 200.0),
            width: dice.decades(1e-4, 1e-3),
            friction: dice.perhaps(0.7, 0.05, 0.6),
            slow: dice.decades(0.02, 0.3),
            start: [dice.number(0.01, 0.3), dice.number(-2.0, 2.0), dice.number(-1.0, 1.0)],
        },
    }
}

fn bar(dice: &mut Dice, least: f64, most: f64) -> Bar {
    let length = dice.number(least, most);
    let mass = dice.number(0.2, 2.0);
    Bar {
        length,
        mass,
        centre: rounded(length * dice.number(0.3, 1.0)),
        inertia: rounded(mass * length * length * dice.number(0.02, 0.1)),
    }
}

fn joint(dice: &mut Dice, size: f64, ends: bool) -> Joint {
    Joint {
        stiffness: if dice.chance(0.3) { rounded(size * dice.decades(0.3, 10.0)) } else { 0.0 },
        relaxed: dice.perhaps(0.5, -0.5, 0.5),
        damping: if dice.chance(0.3) { rounded(size * dice.decades(0.01, 0.2)) } else { 0.0 },
        friction: if dice.chance(0.5) { rounded(size * dice.decades(0.03, 1.0)) } else { 0.0 },
        limit: (ends && dice.chance(0.3)).then(|| Limit {
            at: dice.number(1.05, 1.5),
            stiffness: rounded(dice.decades(100.0, 2000.0)),
            damping: rounded(dice.decades(0.3, 10.0)),
            width: rounded(dice.decades(0.005, 0.05)),
        }),
    }
}

fn drive(dice: &mut Dice, stop: f64, size: f64) -> Drive {
    let size = rounded(size * dice.decades(0.1, 2.0));
    match dice.below(5) {
        0 => Drive::Constant(size),
        1 => Drive::Step { time: rounded(dice.number(0.05, 0.8) * stop), after: size },
        2 => Drive::Sine { amplitude: size, frequency: dice.decades(0.5, 5.0) },
        _ => Drive::None,
    }
}
