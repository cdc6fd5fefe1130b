use blocksim_block::physical::{Axis, Domain, Element, Freedom};
use blocksim_block::prelude::*;

use super::axis::{spring, spring_energy, unit};

/// A joint that slides `follower` along an axis of `base` and turns it about the same axis, independently.
///
/// $$ F = F_{in} + F_{drive} - k_x x - d_x \dot x, \qquad
///    \tau = \tau_{in} + \tau_{drive} - k_q q - d_q \dot q $$
///
/// The drive side of the rotation is `r`, `c`, that of the translation `xr`, `xc`; both may stay open.
///
/// ```ron
/// CylindricalJoint(axis: [0.0, 0.0, 1.0], position: "0.1 m", angle: "30 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Cylinder)]
pub struct CylindricalJoint {
    /// Direction of the axis in `base`; its length does not matter.
    #[block(direction, default = [0.0, 0.0, 1.0])]
    pub axis: [f64; 3],
    /// Position $x$ at the start. Where none is given it is zero, or in a closed loop what closes it.
    #[block(unit = "m", finite, default = None)]
    pub position: Option<f64>,
    /// Speed $\dot x$ at the start.
    #[block(unit = "m/s", finite, default = None)]
    pub velocity: Option<f64>,
    /// Angle $q$ at the start. Where none is given it is zero, or in a closed loop what closes it.
    #[block(unit = "rad", finite, default = None)]
    pub angle: Option<f64>,
    /// Speed $\dot q$ at the start.
    #[block(unit = "rad/s", finite, default = None)]
    pub speed: Option<f64>,
    /// Stiffness $k_x$ of a spring along the axis.
    #[block(unit = "N/m", not_negative, default = 0.0)]
    pub slide_stiffness: f64,
    /// Coefficient $d_x$ of a damper along the axis.
    #[block(unit = "N*s/m", not_negative, default = 0.0)]
    pub slide_damping: f64,
    /// Stiffness $k_q$ of a spring about the axis.
    #[block(unit = "N*m/rad", not_negative, default = 0.0)]
    pub turn_stiffness: f64,
    /// Coefficient $d_q$ of a damper about the axis.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub turn_damping: f64,
}

impl Component for CylindricalJoint {
    fn part(&self, _given: &Given) -> Part {
        let axis = unit(self.axis);
        let slide = Axis::new(["x", "v"], axis).driven(4, 5).starting(self.position, self.velocity);
        let turn = Axis::new(["q", "w"], axis).driven(2, 3).starting(self.angle, self.speed);
        Part::new()
            .port("base", Domain::Frame, "frame that carries the axis")
            .port("follower", Domain::Frame, "frame that slides and turns")
            .port("r", Domain::Rotational, "rod of the drive side that turns")
            .port("c", Domain::Rotational, "case of the drive side that turns")
            .port("xr", Domain::Translational, "rod of the drive side that slides")
            .port("xc", Domain::Translational, "case of the drive side that slides")
            .input(Input::real("force").scalar().unit("N").default(0.0).doc("force on the follower"))
            .input(Input::real("torque").scalar().unit("N*m").default(0.0).doc("torque on the follower"))
            .measures("x", "m", Needs::State, "position along the axis")
            .measures("v", "m/s", Needs::State, "speed along the axis")
            .measures("q", "rad", Needs::State, "angle about the axis")
            .measures("w", "rad/s", Needs::State, "speed about the axis")
            .measures("a", "m/s^2", Needs::Motion, "acceleration along the axis")
            .measures("alpha", "rad/s^2", Needs::Motion, "acceleration about the axis")
            .element(Element::Joint {
                base: 0,
                follower: 1,
                freedoms: vec![Freedom::Slide(slide), Freedom::Turn(turn)],
            })
    }

    fn joint_torques(&self, c: &Moving, tau: &mut [Torque]) {
        let [slide, turn] = [c.joint[0], c.joint[1]];
        tau[0] = spring(self.slide_stiffness, self.slide_damping, slide.q, slide.w);
        tau[0].value += c.scalar(0);
        tau[1] = spring(self.turn_stiffness, self.turn_damping, turn.q, turn.w);
        tau[1].value += c.scalar(1);
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let [slide, turn] = [c.joint[0], c.joint[1]];
        spring_energy(self.slide_stiffness, self.slide_damping, slide.q, slide.w)
            + spring_energy(self.turn_stiffness, self.turn_damping, turn.q, turn.w)
            + Energy::supplied(c.scalar(0) * slide.w + c.scalar(1) * turn.w)
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        let [slide, turn] = [c.joint[0], c.joint[1]];
        y[..4].copy_from_slice(&[slide.q, slide.w, turn.q, turn.w]);
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        let [slide, turn] = [c.joint_load[0], c.joint_load[1]];
        y[4..6].copy_from_slice(&[slide.a, turn.a]);
    }
}
