use blocksim_block::physical::{Axis, Domain, Element, Freedom};
use blocksim_block::prelude::*;

use super::axis::{Inside, unit};
use super::joint_limit::JointLimit;

/// A joint that slides `follower` along an axis of `base`; the axes of both frames stay parallel.
///
/// $$ F = F_{in} + F_{rc} - k (x - x_0) - d \dot x + F_{lim}, \qquad v_r - v_c = \dot x $$
///
/// Three forces may act on it: the input `force`; whatever is connected to the drive side `r`, `c` (a
/// cylinder, a rack, friction; its mass counts in the mass matrix of the mechanism); and the spring and damper
/// inside. Beyond a limit a spring and a damper set in smoothly over the transition width $b$ and push back,
/// never pull, as those of the `RevoluteJoint`. The output `f` is the force of the actuators: the input and the
/// drive side, without spring, damper and limits.
///
/// ```ron
/// PrismaticJoint(axis: [1.0, 0.0, 0.0], position: "0.2 m", lower: "0 m", upper: "0.8 m")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Slide)]
pub struct PrismaticJoint {
    /// Direction of the axis in `base`; its length does not matter.
    #[block(direction, default = [0.0, 0.0, 1.0])]
    pub axis: [f64; 3],
    /// Position at the start. Where none is given it is zero, or in a closed loop what closes it.
    #[block(unit = "m", finite, default = None)]
    pub position: Option<f64>,
    /// Speed at the start. Where none is given it is zero, or in a closed loop what fits the others.
    #[block(unit = "m/s", finite, default = None)]
    pub velocity: Option<f64>,
    /// Position $x_0$ at which the spring inside is relaxed.
    #[block(unit = "m", finite, default = 0.0)]
    pub equilibrium: f64,
    /// Stiffness $k$ of the spring inside.
    #[block(unit = "N/m", not_negative, default = 0.0)]
    pub stiffness: f64,
    /// Coefficient $d$ of the damper inside.
    #[block(unit = "N*s/m", not_negative, default = 0.0)]
    pub damping: f64,
    /// Least position; none unless given.
    #[block(unit = "m", finite, default = None)]
    pub lower: Option<f64>,
    /// Largest position; none unless given.
    #[block(unit = "m", finite, above = lower, default = None)]
    pub upper: Option<f64>,
    /// Stiffness beyond a limit.
    #[block(unit = "N/m", not_negative, default = 1e6)]
    pub limit_stiffness: f64,
    /// Damping beyond a limit.
    #[block(unit = "N*s/m", not_negative, default = 1e3)]
    pub limit_damping: f64,
    /// Width $b$ over which a limit sets in.
    #[block(unit = "m", not_negative, default = 1e-4)]
    pub limit_transition: f64,
}

impl PrismaticJoint {
    fn inside(&self) -> Inside {
        Inside {
            equilibrium: self.equilibrium,
            stiffness: self.stiffness,
            damping: self.damping,
            lower: self.lower,
            upper: self.upper,
            limit: JointLimit {
                stiffness: self.limit_stiffness,
                damping: self.limit_damping,
                transition: self.limit_transition,
            },
        }
    }

    fn validate(&self, errors: &mut ParamErrors) {
        self.inside().validate(self.position, "m", errors);
    }
}

impl Component for PrismaticJoint {
    fn part(&self, _given: &Given) -> Part {
        let slide =
            Axis::new(["x", "v"], unit(self.axis)).driven(2, 3).starting(self.position, self.velocity);
        let part = Part::new()
            .port("base", Domain::Frame, "frame that carries the axis")
            .port("follower", Domain::Frame, "frame that slides")
            .port("r", Domain::Translational, "rod of the drive side")
            .port("c", Domain::Translational, "case of the drive side")
            .input(Input::real("force").scalar().unit("N").default(0.0).doc("force on the follower"))
            .reads("x", "m", Reading::JointPosition(0), "position of the follower against the base")
            .reads("v", "m/s", Reading::JointSpeed(0), "speed of the follower against the base")
            .reads(
                "a",
                "m/s^2",
                Reading::JointAcceleration(0),
                "acceleration of the follower against the base",
            )
            .measures("f", "N", Needs::Motion, "force of the actuators: input and drive side")
            .element(Element::Joint { base: 0, follower: 1, freedoms: vec![Freedom::Slide(slide)] });
        self.inside().events(part, "").guards_of_state()
    }

    fn joint_torques(&self, c: &Moving, tau: &mut [Torque]) {
        let inside = self.inside().torque(c.joint[0].q, c.joint[0].w);
        tau[0] = Torque { value: inside.value + c.scalar(0), slope: inside.slope };
    }

    fn guards_of_state(&self, c: &Moving, g: &mut [f64]) {
        self.inside().guards(c.joint[0].q, c.joint[0].w, g);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let joint = c.joint[0];
        self.inside().energy(joint.q, joint.w) + Energy::supplied(c.scalar(0) * joint.w)
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        y[3] = c.scalar(0) + c.joint_load[0].drive;
    }
}
