use blocksim_block::physical::{Axis, Domain, Element, Freedom};
use blocksim_block::prelude::*;

use super::axis::vector_output;
use super::quaternion;

/// No joint at all: `follower` moves freely against `base` in all six directions.
///
/// It gives a body that flies its states. Positions and velocities are those of the origin of `follower` in the axes
/// of `base`; the orientation is a unit quaternion, the angular velocity is in the axes of `follower`.
///
/// ```ron
/// FreeJoint(position: ["0 m", "0 m", "2 m"], velocity: ["1 m/s", "0 m/s", "0 m/s"])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Text("6 dof"))]
pub struct FreeJoint {
    /// Position at the start.
    #[block(unit = "m", finite, default = None)]
    pub position: Option<[f64; 3]>,
    /// Roll, pitch and yaw at the start.
    #[block(unit = "rad", finite, default = None)]
    pub rpy: Option<[f64; 3]>,
    /// Velocity at the start in the axes of `base`.
    #[block(unit = "m/s", finite, default = None)]
    pub velocity: Option<[f64; 3]>,
    /// Angular velocity at the start in the axes of `follower`.
    #[block(unit = "rad/s", finite, default = None)]
    pub spin: Option<[f64; 3]>,
}

impl Component for FreeJoint {
    fn part(&self, _given: &Given) -> Part {
        let slide = |k: usize, names: [&'static str; 2]| {
            let mut axis = [0.0; 3];
            axis[k] = 1.0;
            let (x, v) = (self.position.map(|x| x[k]), self.velocity.map(|v| v[k]));
            Freedom::Slide(Axis::new(names, axis).starting(x, v))
        };
        let freedoms = vec![
            slide(0, ["x", "vx"]),
            slide(1, ["y", "vy"]),
            slide(2, ["z", "vz"]),
            Freedom::Ball { orientation: self.rpy.map(quaternion::from_rpy), velocity: self.spin },
        ];
        Part::new()
            .port("base", Domain::Frame, "frame that the motion is measured in")
            .port("follower", Domain::Frame, "frame that moves freely")
            .output(vector_output("x", 3, "m", "position of the follower in the base"), Needs::State)
            .output(
                vector_output("p", 4, "1", "unit quaternion w, x, y, z of the follower in the base"),
                Needs::State,
            )
            .output(vector_output("v", 3, "m/s", "velocity in the axes of the base"), Needs::State)
            .output(
                vector_output("w", 3, "rad/s", "angular velocity in the axes of the follower"),
                Needs::State,
            )
            .output(vector_output("a", 3, "m/s^2", "acceleration in the axes of the base"), Needs::Motion)
            .output(vector_output("alpha", 3, "rad/s^2", "derivative of w"), Needs::Motion)
            .element(Element::Joint { base: 0, follower: 1, freedoms })
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        y[3..7].copy_from_slice(c.orientation);
        for k in 0..3 {
            y[k] = c.joint[k].q;
            y[7 + k] = c.joint[k].w;
            y[10 + k] = c.joint[3 + k].w;
        }
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        (0..6).for_each(|k| y[13 + k] = c.joint_load[k].a);
    }
}
