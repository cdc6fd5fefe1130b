//! Mechanisms as a diagram.

use super::super::sheet::Sheet;
use super::super::variants::Variant;
use super::{Bar, Drive, Joint, Mechanism, Mechanisms};

pub(super) fn diagram(model: &Mechanisms, variant: &Variant) -> String {
    let mut sheet = Sheet::default();
    sheet.block("world", "World");
    for (i, one) in model.all.iter().enumerate() {
        sheet.mechanism(i, one);
    }
    sheet.finish(model.stop, variant)
}

/// The x-z plane: angles turn x towards z with this axis, and straight down towards -x with the opposite one.
const UPWARDS: &str = "[0, -1, 0]";
const HANGING: &str = "[0, 1, 0]";

impl Sheet {
    fn show(&mut self, i: usize, outputs: impl Iterator<Item = String>) {
        let outputs: Vec<_> = outputs.enumerate().map(|(k, from)| (format!("v{k}"), from)).collect();
        self.scope(&format!("show{i}"), &outputs);
    }

    /// A joint with what acts in it; `turns` says of which kind it is.
    fn joint(&mut self, name: &str, turns: bool, axis: &str, start: &str, joint: &Joint) {
        let Joint { stiffness, relaxed, damping, friction, limit } = joint;
        let ends = limit.map_or(String::new(), |limit| {
            format!(
                ", lower: {:?}, upper: {:?}, limit_stiffness: {:?}, limit_damping: {:?}, limit_transition: {:?}",
                -limit.at, limit.at, limit.stiffness, limit.damping, limit.width
            )
        });
        let kind = if turns { "RevoluteJoint" } else { "PrismaticJoint" };
        self.block(
            name,
            &format!("{kind}(axis: {axis}{start}, stiffness: {stiffness:?}, equilibrium: {relaxed:?}, damping: {damping:?}{ends})"),
        );
        if *friction > 0.0 {
            let (kind, wall) = if turns {
                ("RotationalFriction", "RotationalReference")
            } else {
                ("TranslationalFriction", "TranslationalReference")
            };
            self.block(
                &format!("{name}_rub"),
                &format!("{kind}(breakaway: {friction:?}, breakaway_velocity: 0.0, coulomb: {friction:?}, model: Stiction)"),
            );
            self.block(&format!("{name}_wall"), wall);
            self.wire(&format!("{name}.r <-> {name}_rub.r"));
            self.wire(&format!("{name}.c <-> {name}_rub.c <-> {name}_wall.r"));
        }
    }

    fn drive(&mut self, i: usize, drive: &Drive, joint: &str) {
        let text = match drive {
            Drive::None => return,
            Drive::Constant(torque) => format!("Constant(value: \"{torque:?} N*m\")"),
            Drive::Step { time, after } => {
                format!("Step(time: \"{time:?} s\", before: \"0 N*m\", after: \"{after:?} N*m\")")
            }
            Drive::Sine { amplitude, frequency } => {
                format!("Sine(amplitude: \"{amplitude:?} N*m\", frequency: \"{frequency:?} Hz\")")
            }
            Drive::Sampled { ts, target, kp, kd, limit } => {
                let hold = format!("ZeroOrderHold(ts: \"{ts:?} s\")");
                let angle = self.behind(&format!("{joint}.q"), &format!("angle{i}"), &hold);
                let speed = self.behind(&format!("{joint}.w"), &format!("speed{i}"), &hold);
                self.block(&format!("target{i}"), &format!("Constant(value: \"{target:?} rad\")"));
                let missing = self.sum(&format!("missing{i}"), "+-", [&format!("target{i}.y"), &angle]);
                let push = format!("Gain(k: \"{kp:?} N*m/rad\")");
                let push = self.behind(&missing, &format!("push{i}"), &push);
                let brake = format!("Gain(k: \"{kd:?} N*m*s/rad\")");
                let brake = self.behind(&speed, &format!("brake{i}"), &brake);
                let wanted = self.sum(&format!("wanted{i}"), "+-", [&push, &brake]);
                self.signal(&wanted, &format!("drive{i}.u"));
                format!("Saturation(lower: \"{:?} N*m\", upper: \"{limit:?} N*m\")", -limit)
            }
        };
        self.block(&format!("drive{i}"), &text);
        self.wire(&format!("drive{i}.y -> {joint}.torque"));
    }

    /// A bar along `along` (+x or -z), and the frame at its end.
    fn bar(&mut self, name: &str, bar: &Bar, hangs: bool) {
        let at =
            |far: f64| if hangs { format!("[0.0, 0.0, {:?}]", -far) } else { format!("[{far:?}, 0.0, 0.0]") };
        let moi = bar.inertia;
        self.block(
            name,
            &format!("Body(mass: {:?}, com: {}, moi: [{moi:?}, {moi:?}, {moi:?}])", bar.mass, at(bar.centre)),
        );
        self.block(&format!("{name}_end"), &format!("Transform(translation: {})", at(bar.length)));
    }

    fn mechanism(&mut self, i: usize, one: &Mechanism) {
        match one {
            Mechanism::Chain { bars, joints, start, drive } => {
                let mut from = "world.frame".to_owned();
                let mut shown = Vec::new();
                for (k, bar) in bars.iter().enumerate() {
                    let (name, body) = (format!("joint{i}_{k}"), format!("bar{i}_{k}"));
                    let start = format!(", position: {:?}, velocity: {:?}", start[k].0, start[k].1);
                    self.joint(&name, true, HANGING, &start, &joints[k]);
                    self.bar(&body, bar, true);
                    self.wire(&format!("{from} <-> {name}.base"));
                    self.wire(&format!("{name}.follower <-> {body}.frame <-> {body}_end.base"));
                    from = format!("{body}_end.follower");
                    shown.extend([format!("{name}.q"), format!("{name}.w")]);
                }
                self.drive(i, drive, &format!("joint{i}_0"));
                self.show(i, shown.into_iter());
            }
            Mechanism::Slider { crank, rod, piston, joints, start, drive } => {
                let begin = format!(", position: {:?}, velocity: {:?}", start.0, start.1);
                self.joint(&format!("crank{i}"), true, UPWARDS, &begin, &joints[0]);
                let high = crank.length * start.0.sin();
                let x = crank.length * start.0.cos() + (rod.length * rod.length - high * high).sqrt();
                self.joint(
                    &format!("slide{i}"),
                    false,
                    "[1, 0, 0]",
                    &format!(", position: {x:?}"),
                    &joints[1],
                );
                self.bar(&format!("arm{i}"), crank, false);
                self.bar(&format!("rod{i}"), rod, false);
                self.block(&format!("pin{i}"), &format!("RevoluteJoint(axis: {UPWARDS})"));
                self.block(&format!("wrist{i}"), &format!("RevoluteJoint(axis: {UPWARDS})"));
                self.block(&format!("piston{i}"), &format!("Body(mass: {piston:?})"));
                self.wire(&format!("world.frame <-> crank{i}.base <-> slide{i}.base"));
                self.wire(&format!("crank{i}.follower <-> arm{i}.frame <-> arm{i}_end.base"));
                self.wire(&format!("arm{i}_end.follower <-> pin{i}.base"));
                self.wire(&format!("pin{i}.follower <-> rod{i}.frame <-> rod{i}_end.base"));
                self.wire(&format!("rod{i}_end.follower <-> wrist{i}.base"));
                self.wire(&format!("wrist{i}.follower <-> slide{i}.follower <-> piston{i}.frame"));
                self.drive(i, drive, &format!("crank{i}"));
                let shown = ["crank", "crank", "slide", "slide"].iter().zip([".q", ".w", ".x", ".v"]);
                self.show(i, shown.map(|(joint, output)| format!("{joint}{i}{output}")));
            }
            Mechanism::FourBar { bars, ground, joints, start, drive } => {
                let begin = format!(", position: {:?}, velocity: {:?}", start.0, start.1);
                self.joint(&format!("crank{i}"), true, UPWARDS, &begin, &joints[0]);
                let rocker = one.shown(&[start.0], &[start.1])[2];
                self.joint(
                    &format!("pivot{i}"),
                    true,
                    UPWARDS,
                    &format!(", position: {rocker:?}"),
                    &joints[1],
                );
                self.block(&format!("ground{i}"), &format!("Transform(translation: [{ground:?}, 0.0, 0.0])"));
                for (name, bar) in ["arm", "coupler", "rocker"].iter().zip(bars) {
                    self.bar(&format!("{name}{i}"), bar, false);
                }
                self.block(&format!("elbow{i}"), &format!("RevoluteJoint(axis: {UPWARDS})"));
                self.block(&format!("knee{i}"), &format!("RevoluteJoint(axis: {UPWARDS})"));
                self.wire(&format!("world.frame <-> crank{i}.base <-> ground{i}.base"));
                self.wire(&format!("crank{i}.follower <-> arm{i}.frame <-> arm{i}_end.base"));
                self.wire(&format!("arm{i}_end.follower <-> elbow{i}.base"));
                self.wire(&format!("elbow{i}.follower <-> coupler{i}.frame <-> coupler{i}_end.base"));
                self.wire(&format!("coupler{i}_end.follower <-> knee{i}.base"));
                self.wire(&format!("knee{i}.follower <-> rocker{i}_end.follower"));
                self.wire(&format!("rocker{i}_end.base <-> rocker{i}.frame <-> pivot{i}.follower"));
                self.wire(&format!("pivot{i}.base <-> ground{i}.follower"));
                self.drive(i, drive, &format!("crank{i}"));
                let shown = ["crank", "crank", "pivot", "pivot"].iter().zip([".q", ".w", ".q", ".w"]);
                self.show(i, shown.map(|(joint, output)| format!("{joint}{i}{output}")));
            }
            Mechanism::Ball {
                mass,
                tilt,
                stiffness,
                damping,
                width,
                friction,
                slow,
                start: [height, along, up],
            } => {
                // Two slides bear the point; along the plane x points downhill.
                let (s, c) = tilt.sin_cos();
                let turned = |x: f64, z: f64| [c * x + s * z, -s * x + c * z];
                let ([x, z], [vx, vz]) = (turned(0.0, *height), turned(*along, *up));
                self.block(
                    &format!("across{i}"),
                    &format!("PrismaticJoint(axis: [1, 0, 0], position: {x:?}, velocity: {vx:?})"),
                );
                self.block(
                    &format!("fall{i}"),
                    &format!("PrismaticJoint(axis: [0, 0, 1], position: {z:?}, velocity: {vz:?})"),
                );
                self.block(&format!("ball{i}"), &format!("Body(mass: {mass:?})"));
                self.block(&format!("plane{i}"), &format!("Transform(rpy: [0.0, {tilt:?}, 0.0])"));
                self.block(
                    &format!("touch{i}"),
                    &format!("PointPlaneContact(stiffness: {stiffness:?}, damping: {damping:?}, transition: {width:?}, friction: {friction:?}, threshold: {slow:?})"),
                );
                self.wire(&format!("world.frame <-> across{i}.base <-> plane{i}.base"));
                self.wire(&format!("across{i}.follower <-> fall{i}.base"));
                self.wire(&format!("fall{i}.follower <-> ball{i}.frame <-> touch{i}.follower"));
                self.wire(&format!("plane{i}.follower <-> touch{i}.base"));
                let shown = ["across", "across", "fall", "fall"].iter().zip([".x", ".v", ".x", ".v"]);
                self.show(i, shown.map(|(joint, output)| format!("{joint}{i}{output}")));
            }
        }
    }
}
