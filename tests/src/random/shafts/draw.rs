//! Shafts of a seed.

use super::super::dice::{Dice, rounded};
use super::{Joint, Shafts, Torque};

pub(super) fn draw(seed: u64) -> Shafts {
    let mut dice = Dice::new(seed ^ 0x54AF);
    let dice = &mut dice;
    let n = 1 + dice.below(5);
    let mut shafts = Shafts { discs: Vec::new(), joints: Vec::new(), torques: Vec::new(), stop: 2.0 };
    for i in 0..n {
        let sign = dice.one_of(&[-1.0, 1.0]);
        let speed = if dice.chance(0.5) { sign * dice.decades(1.0, 20.0) } else { 0.0 };
        shafts.discs.push((dice.decades(0.05, 1.0), speed));
        if dice.chance(0.6) {
            shafts.joints.push((i, None, Joint::Friction(dice.decades(0.05, 3.0), None)));
        }
        if dice.chance(0.15) {
            let (k, d) = (dice.decades(1.0, 100.0), dice.decades(0.01, 1.0));
            shafts.joints.push((i, None, Joint::Spring { k, d }));
        }
        if dice.chance(0.1) {
            shafts.joints.push((i, None, stop(dice)));
        }
        if dice.chance(0.5) {
            shafts.torques.push((i, torque(dice)));
        }
    }
    for i in 1..n {
        for _ in 0..if dice.chance(0.25) { 2 } else { 1 } {
            let other = if dice.chance(0.8) { i - 1 } else { dice.below(i) };
            let joint = match dice.below(9) {
                0..=1 => Joint::Freewheel,
                2..=3 => Joint::Spring { k: dice.decades(5.0, 500.0), d: dice.decades(0.01, 2.0) },
                4 => stop(dice),
                _ => {
                    let torque = dice.decades(0.1, 6.0);
                    let period = dice.chance(0.3).then(|| dice.decades(0.1, 2.0));
                    Joint::Friction(torque, period)
                }
            };
            let (a, b) = if dice.chance(0.5) { (i, other) } else { (other, i) };
            shafts.joints.push((a, Some(b), joint));
        }
    }
    shafts
}

fn stop(dice: &mut Dice) -> Joint {
    Joint::Stop {
        at: dice.decades(0.1, 3.0),
        k: dice.decades(100.0, 2000.0),
        d: dice.decades(0.3, 10.0),
        width: dice.decades(0.005, 0.05),
    }
}

fn torque(dice: &mut Dice) -> Torque {
    match dice.below(5) {
        0..=1 => Torque::Sine { amplitude: dice.decades(0.3, 6.0), frequency: dice.decades(0.5, 4.0) },
        2..=3 => Torque::Step {
            time: dice.decades(0.1, 1.5),
            before: dice.decades(0.1, 5.0),
            after: -dice.decades(0.1, 5.0),
        },
        _ => Torque::Sampled {
            ts: dice.one_of(&[0.01, 0.02, 0.05, 0.1]),
            gain: dice.decades(0.1, 2.0),
            target: rounded(dice.one_of(&[-1.0, 1.0]) * dice.decades(1.0, 20.0)),
            limit: dice.decades(0.5, 6.0),
        },
    }
}
