use blocksim_block::physical::{Axis, Domain, Element, Freedom};
use blocksim_block::prelude::*;

use super::axis::{spring, spring_energy, vector_input, vector_output};

/// A joint that lets `follower` slide in the x-y plane of `base` and turn about its z axis.
///
/// The drive side of the rotation is `r`, `c`; it may stay open. Forces and springs act along the axes of
/// `base`.
///
/// ```ron
/// PlanarJoint(position: ["0.1 m", "0 m"], angle: "30 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Planar)]
pub struct PlanarJoint {
    /// Position x, y at the start. Where none is given it is zero, or in a closed loop what closes it.
    #[block(unit = "m", finite, default = None)]
    pub position: Option<[f64; 2]>,
    /// Velocity x, y at the start.
    #[block(unit = "m/s", finite, default = None)]
    pub velocity: Option<[f64; 2]>,
    /// Angle at the start. Where none is given it is zero, or in a closed loop what closes it.
    #[block(unit = "rad", finite, default = None)]
    pub angle: Option<f64>,
    /// Speed of rotation at the start.
    #[block(unit = "rad/s", finite, default = None)]
    pub speed: Option<f64>,
    /// Stiffness of springs along x and y.
    #[block(unit = "N/m", not_negative, default = 0.0)]
    pub slide_stiffness: f64,
    /// Coefficient of dampers along x and y.
    #[block(unit = "N*s/m", not_negative, default = 0.0)]
    pub slide_damping: f64,
    /// Stiffness of a spring about z.
    #[block(unit = "N*m/rad", not_negative, default = 0.0)]
    pub turn_stiffness: f64,
    /// Coefficient of a damper about z.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub turn_damping: f64,
}

impl PlanarJoint {
    /// Stiffness and damping of a freedom.
    fn spring(&self, freedom: usize) -> (f64, f64) {
        match freedom {
            2 => (self.turn_stiffness, self.turn_damping),
            _ => (self.slide_stiffness, self.slide_damping),
        }
    }
}

impl Component for PlanarJoint {
    fn part(&self, _given: &Given) -> Part {
        let start = |k: usize| (self.position.map(|x| x[k]), self.velocity.map(|v| v[k]));
        let (x, y) = (start(0), start(1));
        let freedoms = vec![
            Freedom::Slide(Axis::new(["x", "vx"], [1.0, 0.0, 0.0]).starting(x.0, x.1)),
            Freedom::Slide(Axis::new(["y", "vy"], [0.0, 1.0, 0.0]).starting(y.0, y.1)),
            Freedom::Turn(
                Axis::new(["q", "w"], [0.0, 0.0, 1.0]).driven(2, 3).starting(self.angle, self.speed),
            ),
        ];
        Part::new()
            .port("base", Domain::Frame, "frame that carries the plane")
            .port("follower", Domain::Frame, "frame that slides and turns")
            .port("r", Domain::Rotational, "rod of the drive side")
            .port("c", Domain::Rotational, "case of the drive side")
            .input(vector_input("force", 2, "N", "force on the follower along x and y of the base"))
            .input(Input::real("torque").scalar().unit("N*m").default(0.0).doc("torque on the follower"))
            .output(vector_output("x", 2, "m", "position in the plane"), Needs::State)
            .output(vector_output("v", 2, "m/s", "velocity in the plane"), Needs::State)
            .measures("q", "rad", Needs::State, "angle about z")
            .measures("w", "rad/s", Needs::State, "speed about z")
            .output(vector_output("a", 2, "m/s^2", "acceleration in the plane"), Needs::Motion)
            .measures("alpha", "rad/s^2", Needs::Motion, "acceleration about z")
            .element(Element::Joint { base: 0, follower: 1, freedoms })
    }

    fn joint_torques(&self, c: &Moving, tau: &mut [Torque]) {
        for (k, (to, joint)) in tau.iter_mut().zip(c.joint).enumerate() {
            let (stiffness, damping) = self.spring(k);
            *to = spring(stiffness, damping, joint.q, joint.w);
            // the inputs lie one behind the other: force x, force y, torque
            to.value += c.u[k];
        }
    }

    fn energy(&self, c: &Flowing) -> Energy {
        (0..3).fold(Energy::default(), |sum, k| {
            let ((stiffness, damping), joint) = (self.spring(k), c.joint[k]);
            sum + spring_energy(stiffness, damping, joint.q, joint.w) + Energy::supplied(c.u[k] * joint.w)
        })
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        let [a, b, turn] = [c.joint[0], c.joint[1], c.joint[2]];
        y[..6].copy_from_slice(&[a.q, b.q, a.w, b.w, turn.q, turn.w]);
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        let [a, b, turn] = [c.joint_load[0], c.joint_load[1], c.joint_load[2]];
        y[6..9].copy_from_slice(&[a.a, b.a, turn.a]);
    }
}
