use blocksim_block::physical::{Domain, Element, Freedom};
use blocksim_block::prelude::*;

use super::axis::{spring_energy, vector_input, vector_output};
use super::quaternion;

/// A ball joint: `follower` turns freely about the common origin.
///
/// The orientation is kept as a unit quaternion $p = (w, x, y, z)$ that turns `follower` against `base`, so no
/// position is singular; the speeds $\omega$ are those of `follower` against `base` in the axes of `follower`.
///
/// $$ \dot p = \tfrac12\, p \circ (0, \omega), \qquad
///    \tau = \tau_{in} - k\,\varphi\,n - d\,\omega $$
///
/// with the axis $n$ and the angle $\varphi$ (at most half a turn) between the frames.
///
/// ```ron
/// SphericalJoint(rpy: ["20 deg", "0 deg", "0 deg"], velocity: ["0 rad/s", "0 rad/s", "90 rad/s"])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Ball)]
pub struct SphericalJoint {
    /// Roll, pitch and yaw of `follower` in `base` at the start. Where none are given the frames are parallel, or in
    /// a closed loop as it closes.
    #[block(unit = "rad", finite, default = None)]
    pub rpy: Option<[f64; 3]>,
    /// Angular velocity at the start in the axes of `follower`.
    #[block(unit = "rad/s", finite, default = None)]
    pub velocity: Option<[f64; 3]>,
    /// Stiffness $k$ of a spring that aligns the frames.
    #[block(unit = "N*m/rad", not_negative, default = 0.0)]
    pub stiffness: f64,
    /// Coefficient $d$ of a damper.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
}

impl Component for SphericalJoint {
    fn part(&self, _given: &Given) -> Part {
        let ball = Freedom::Ball { orientation: self.rpy.map(quaternion::from_rpy), velocity: self.velocity };
        Part::new()
            .port("base", Domain::Frame, "frame it hangs on")
            .port("follower", Domain::Frame, "frame that turns")
            .input(vector_input("torque", 3, "N*m", "torque on the follower in its axes"))
            .output(
                vector_output("p", 4, "1", "unit quaternion w, x, y, z of the follower in the base"),
                Needs::State,
            )
            .output(
                vector_output("w", 3, "rad/s", "angular velocity in the axes of the follower"),
                Needs::State,
            )
            .output(vector_output("a", 3, "rad/s^2", "its derivative"), Needs::Motion)
            .element(Element::Joint { base: 0, follower: 1, freedoms: vec![ball] })
    }

    fn joint_torques(&self, c: &Moving, tau: &mut [Torque]) {
        let turn = match self.stiffness == 0.0 {
            true => [0.0; 3],
            false => quaternion::rotation_vector(*c.orientation),
        };
        for (k, (to, joint)) in tau.iter_mut().zip(c.joint).enumerate() {
            let value = c.input(0)[k] - self.stiffness * turn[k] - self.damping * joint.w;
            *to = Torque { value, slope: self.damping };
        }
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let turn = quaternion::rotation_vector(*c.orientation);
        (0..3).fold(Energy::default(), |sum, k| {
            let w = c.joint[k].w;
            sum + spring_energy(self.stiffness, self.damping, turn[k], w)
                + Energy::supplied(c.input(0)[k] * w)
        })
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[..4].copy_from_slice(c.orientation);
        (0..3).for_each(|k| y[4 + k] = c.joint[k].w);
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        (0..3).for_each(|k| y[7 + k] = c.joint_load[k].a);
    }
}
