//! Joints of one freedom, which turn or slide: the same under different names and units.

use blocksim_block::physical::{Axis, Domain, Element, Freedom};
use blocksim_block::prelude::*;

use super::axis::{Inside, unit};

/// Name, unit and meaning of a signal.
type Signal = (&'static str, &'static str, &'static str);

/// What a kind of joint calls its quantities.
#[derive(Debug)]
pub struct JointWords {
    /// Whether it turns; else it slides.
    turns: bool,
    domain: Domain,
    follower: &'static str,
    position: Signal,
    speed: Signal,
    acceleration: Signal,
    /// Torque or force on the follower, as an input.
    input: Signal,
    /// That of the actuators: input and drive side.
    load: Signal,
}

pub(crate) const TURNS: JointWords = JointWords {
    turns: true,
    domain: Domain::Rotational,
    follower: "frame that turns",
    position: ("q", "rad", "angle of the follower against the base"),
    speed: ("w", "rad/s", "speed of the follower against the base"),
    acceleration: ("a", "rad/s^2", "acceleration of the follower against the base"),
    input: ("torque", "N*m", "torque on the follower"),
    load: ("tau", "N*m", "torque of the actuators: input and drive side"),
};

pub(crate) const SLIDES: JointWords = JointWords {
    turns: false,
    domain: Domain::Translational,
    follower: "frame that slides",
    position: ("x", "m", "position of the follower against the base"),
    speed: ("v", "m/s", "speed of the follower against the base"),
    acceleration: ("a", "m/s^2", "acceleration of the follower against the base"),
    input: ("force", "N", "force on the follower"),
    load: ("f", "N", "force of the actuators: input and drive side"),
};

impl JointWords {
    /// Unit of the position.
    pub(crate) fn unit(&self) -> &'static str {
        self.position.1
    }
}

/// Where the load stands among the outputs.
const LOAD: usize = 3;

/// A joint with one axis, as `RevoluteJoint` and `PrismaticJoint` build it.
#[derive(Debug)]
pub struct OneAxisJoint {
    pub(crate) words: &'static JointWords,
    /// Direction of the axis in `base`; its length does not matter.
    pub(crate) axis: [f64; 3],
    /// At the start, if given.
    pub(crate) position: Option<f64>,
    /// At the start, if given.
    pub(crate) velocity: Option<f64>,
    pub(crate) inside: Inside,
}

impl OneAxisJoint {
    /// Coefficient of the damper inside, N*m*s/rad or N*s/m.
    pub fn damping(&self) -> f64 {
        self.inside.damping
    }
}

impl Component for OneAxisJoint {
    fn part(&self, _given: &Given) -> Part {
        let JointWords { turns, domain, follower, position, speed, acceleration, input, load } = *self.words;
        let axis = Axis::new([position.0, speed.0], unit(self.axis)).driven(2, 3);
        let axis = axis.starting(self.position, self.velocity);
        let freedom = if turns { Freedom::Turn(axis) } else { Freedom::Slide(axis) };
        let part = Part::new()
            .port("base", Domain::Frame, "frame that carries the axis")
            .port("follower", Domain::Frame, follower)
            .port("r", domain, "rod of the drive side")
            .port("c", domain, "case of the drive side")
            .input(Input::real(input.0).scalar().unit(input.1).default(0.0).doc(input.2))
            .reads(position.0, position.1, Reading::JointPosition(0), position.2)
            .reads(speed.0, speed.1, Reading::JointSpeed(0), speed.2)
            .reads(acceleration.0, acceleration.1, Reading::JointAcceleration(0), acceleration.2)
            .measures(load.0, load.1, Needs::Motion, load.2)
            .element(Element::Joint { base: 0, follower: 1, freedoms: vec![freedom] });
        self.inside.events(part, "").guards_of_state().travel(self.inside.lower, self.inside.upper)
    }

    fn joint_torques(&self, c: &Moving, tau: &mut [Torque]) {
        let inside = self.inside.torque(c.joint[0].q, c.joint[0].w, c.d);
        tau[0] = Torque { value: inside.value + c.scalar(0), slope: inside.slope };
    }

    fn guards_of_state(&self, c: &Moving, g: &mut [f64]) {
        self.inside.guards(c.joint[0].q, c.joint[0].w, c.d, g);
    }

    fn jump(&self, c: &Flowing, _x: &mut [f64], d: &mut [f64]) -> bool {
        self.inside.settle(c.joint[0].q, c.joint[0].w, d)
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let joint = c.joint[0];
        self.inside.energy(joint.q, joint.w, c.d) + Energy::supplied(c.scalar(0) * joint.w)
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        y[LOAD] = c.scalar(0) + c.joint_load[0].drive;
    }
}
