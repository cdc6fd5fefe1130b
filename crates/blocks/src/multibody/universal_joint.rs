use blocksim_block::physical::{Axis, Domain, Element, Freedom};
use blocksim_block::prelude::*;

use super::axis::{spring, spring_energy, unit, vector_input, vector_output};

/// A universal (Cardan) joint: `follower` turns about an axis of `base`, then about a second axis that turns with
/// the first.
///
/// The two drive sides are `r1`, `c1` of the first and `r2`, `c2` of the second axis; they may stay open.
///
/// ```ron
/// UniversalJoint(first: [1.0, 0.0, 0.0], second: [0.0, 1.0, 0.0], position: ["20 deg", "-10 deg"])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Universal)]
pub struct UniversalJoint {
    /// Direction of the first axis in `base`.
    #[block(direction, default = [1.0, 0.0, 0.0])]
    pub first: [f64; 3],
    /// Direction of the second axis in the frame that the first has turned.
    #[block(direction, default = [0.0, 1.0, 0.0])]
    pub second: [f64; 3],
    /// Both angles at the start. Where none are given they are zero, or in a closed loop what closes it.
    #[block(unit = "rad", finite, default = None)]
    pub position: Option<[f64; 2]>,
    /// Both speeds at the start.
    #[block(unit = "rad/s", finite, default = None)]
    pub velocity: Option<[f64; 2]>,
    /// Stiffness of a spring about each axis.
    #[block(unit = "N*m/rad", not_negative, default = 0.0)]
    pub stiffness: f64,
    /// Coefficient of a damper about each axis.
    #[block(unit = "N*m*s/rad", not_negative, default = 0.0)]
    pub damping: f64,
}

impl Component for UniversalJoint {
    fn part(&self, _given: &Given) -> Part {
        let turn = |k: usize, names: [&'static str; 2], axis: [f64; 3]| {
            let (q, w) = (self.position.map(|q| q[k]), self.velocity.map(|w| w[k]));
            Freedom::Turn(Axis::new(names, unit(axis)).driven(2 + 2 * k, 3 + 2 * k).starting(q, w))
        };
        let freedoms = vec![turn(0, ["q1", "w1"], self.first), turn(1, ["q2", "w2"], self.second)];
        Part::new()
            .port("base", Domain::Frame, "frame that carries the first axis")
            .port("follower", Domain::Frame, "frame that turns")
            .port("r1", Domain::Rotational, "rod of the first drive side")
            .port("c1", Domain::Rotational, "case of the first drive side")
            .port("r2", Domain::Rotational, "rod of the second drive side")
            .port("c2", Domain::Rotational, "case of the second drive side")
            .input(vector_input("torque", 2, "N*m", "torques about both axes"))
            .output(vector_output("q", 2, "rad", "angles about both axes"), Needs::State)
            .output(vector_output("w", 2, "rad/s", "speeds about both axes"), Needs::State)
            .output(vector_output("a", 2, "rad/s^2", "accelerations about both axes"), Needs::Motion)
            .element(Element::Joint { base: 0, follower: 1, freedoms })
    }

    fn joint_torques(&self, c: &Moving, tau: &mut [Torque]) {
        for ((to, joint), input) in tau.iter_mut().zip(c.joint).zip(c.input(0)) {
            *to = spring(self.stiffness, self.damping, joint.q, joint.w);
            to.value += input;
        }
    }

    fn energy(&self, c: &Flowing) -> Energy {
        let axes = c.joint.iter().zip(c.input(0));
        axes.fold(Energy::default(), |sum, (joint, torque)| {
            sum + spring_energy(self.stiffness, self.damping, joint.q, joint.w)
                + Energy::supplied(torque * joint.w)
        })
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        let [a, b] = [c.joint[0], c.joint[1]];
        y[..4].copy_from_slice(&[a.q, b.q, a.w, b.w]);
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        let [a, b] = [c.joint_load[0], c.joint_load[1]];
        y[4..6].copy_from_slice(&[a.a, b.a]);
    }
}
