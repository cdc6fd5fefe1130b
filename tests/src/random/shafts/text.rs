//! Shafts as a diagram: the scope shows speed and angle of each disc.

use super::super::sheet::Sheet;
use super::super::variants::Variant;
use super::{Joint, Shafts, Torque};

pub(super) fn diagram(shafts: &Shafts, variant: &Variant) -> String {
    let mut sheet = Sheet::default();
    sheet.block("frame", "RotationalReference");
    let mut shown = Vec::new();
    for (i, (j, w)) in shafts.discs.iter().enumerate() {
        sheet.block(&format!("disc{i}"), &format!("Inertia(j: {j:?}, w0: {w:?})"));
        sheet.block(&format!("sensor{i}"), "MotionSensor");
        sheet.wire(&format!("disc{i}.r <-> sensor{i}.r"));
        sheet.wire(&format!("sensor{i}.c <-> frame.r"));
        shown.push((format!("w{i}"), format!("sensor{i}.w")));
        shown.push((format!("phi{i}"), format!("sensor{i}.phi")));
    }
    for (k, (a, b, joint)) in shafts.joints.iter().enumerate() {
        sheet.link(k, joint, b.is_some());
        let end = b.map_or("frame.r".to_owned(), |b| format!("disc{b}.r"));
        sheet.wire(&format!("disc{a}.r <-> joint{k}.r"));
        sheet.wire(&format!("joint{k}.c <-> {end}"));
    }
    for (k, (disc, torque)) in shafts.torques.iter().enumerate() {
        sheet.torque(k, *disc, torque);
    }
    sheet.scope("scope", &shown);
    sheet.finish(shafts.stop, variant)
}

impl Sheet {
    fn link(&mut self, k: usize, joint: &Joint, is_between: bool) {
        let block = match joint {
            Joint::Spring { k, d } => format!("RotationalSpringDamper(k: {k:?}, d: {d:?})"),
            Joint::Freewheel => "OneWayClutch()".to_owned(),
            Joint::Stop { at, k, d, width } => format!(
                "RotationalHardStop(lower: {:?}, upper: {at:?}, stiffness: {k:?}, damping: {d:?}, transition: {width:?})",
                -at
            ),
            Joint::Friction(t, _) if !is_between => format!(
                "RotationalFriction(breakaway: {t:?}, breakaway_velocity: 0.0, coulomb: {t:?}, model: Stiction)"
            ),
            Joint::Friction(torque, period) => {
                let normal = match period {
                    None => "Constant(value: 1.0)".to_owned(),
                    Some(period) => format!("Pulse(period: \"{period:?} s\", width: 0.5)"),
                };
                self.block(&format!("normal{k}"), &normal);
                self.signal(&format!("normal{k}.y"), &format!("joint{k}.normal"));
                format!("Clutch(torque: {torque:?})")
            }
        };
        self.block(&format!("joint{k}"), &block);
    }

    fn torque(&mut self, k: usize, disc: usize, torque: &Torque) {
        let from = match torque {
            Torque::Sine { amplitude, frequency } => {
                let text = format!("Sine(amplitude: \"{amplitude:?} N*m\", frequency: \"{frequency:?} Hz\")");
                self.block(&format!("source{k}"), &text);
                format!("source{k}.y")
            }
            Torque::Step { time, before, after } => {
                let text = format!(
                    "Step(time: \"{time:?} s\", before: \"{before:?} N*m\", after: \"{after:?} N*m\")"
                );
                self.block(&format!("source{k}"), &text);
                format!("source{k}.y")
            }
            Torque::Sampled { ts, gain, target, limit } => {
                self.block(&format!("target{k}"), &format!("Constant(value: \"{target:?} rad/s\")"));
                let held = self.behind(
                    &format!("sensor{disc}.w"),
                    &format!("hold{k}"),
                    &format!("ZeroOrderHold(ts: \"{ts:?} s\")"),
                );
                self.block(&format!("error{k}"), "Sum(signs: \"+-\")");
                self.signal(&format!("target{k}.y"), &format!("error{k}.u1"));
                self.signal(&held, &format!("error{k}.u2"));
                let gain = format!("Gain(k: \"{gain:?} N*m*s/rad\")");
                let wanted = self.behind(&format!("error{k}.y"), &format!("gain{k}"), &gain);
                let limits = format!("Saturation(lower: \"{:?} N*m\", upper: \"{limit:?} N*m\")", -limit);
                self.behind(&wanted, &format!("limit{k}"), &limits)
            }
        };
        self.block(&format!("push{k}"), "IdealTorqueSource");
        self.signal(&from, &format!("push{k}.tau"));
        self.wire(&format!("push{k}.r <-> disc{disc}.r"));
        self.wire(&format!("push{k}.c <-> frame.r"));
    }
}
