use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

use super::axis::vector_output;
use super::quaternion;
use super::vector::{acceleration_seen, angular_acceleration_seen, dot, sub, to_frame, velocity_seen};

/// Measures where one frame is in another, and how it moves.
///
/// All outputs are those of `follower` as an observer on `base` sees it, in the axes of `base`: `v` is the derivative of
/// `x`, `a` that of `v`, `alpha` that of `w`. Where `base` is not connected it is the world. Accelerations follow
/// from the forces of the same instant, without gravity: at rest they are zero.
///
/// ```ron
/// TransformSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Sensor("T"))]
pub struct TransformSensor;

impl Component for TransformSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("base", Domain::Frame, "frame of the observer; the world unless connected")
            .port("follower", Domain::Frame, "frame that is observed")
            .output(vector_output("x", 3, "m", "position of the origin"), Needs::State)
            .output(vector_output("v", 3, "m/s", "velocity of the origin"), Needs::State)
            .output(
                vector_output("p", 4, "1", "orientation: unit quaternion w, x, y, z with w >= 0"),
                Needs::State,
            )
            .output(vector_output("rpy", 3, "rad", "orientation: roll, pitch and yaw"), Needs::State)
            .output(vector_output("w", 3, "rad/s", "angular velocity"), Needs::State)
            .output(vector_output("a", 3, "m/s^2", "acceleration of the origin"), Needs::Motion)
            .output(vector_output("alpha", 3, "rad/s^2", "angular acceleration"), Needs::Motion)
            .element(Element::FrameProbe { frame: 0 })
            .element(Element::FrameProbe { frame: 1 })
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        let frames = [(&c.frames[0], &c.frame_acceleration[0]), (&c.frames[1], &c.frame_acceleration[1])];
        let base = frames[0].0;
        y[16..19].copy_from_slice(&to_frame(base, acceleration_seen(frames)));
        y[19..22].copy_from_slice(&to_frame(base, angular_acceleration_seen(frames)));
    }

    fn measure_state(&self, c: &Moving, y: &mut [f64]) {
        let (base, follower) = (&c.frames[0], &c.frames[1]);
        // R = R_b' R_f, row by row
        let column = |m: &[[f64; 3]; 3], k: usize| [m[0][k], m[1][k], m[2][k]];
        let r = [0, 1, 2]
            .map(|i| [0, 1, 2].map(|k| dot(column(&base.rotation, i), column(&follower.rotation, k))));
        y[..3].copy_from_slice(&to_frame(base, sub(follower.position, base.position)));
        y[3..6].copy_from_slice(&to_frame(base, velocity_seen(base, follower)));
        y[6..10].copy_from_slice(&quaternion::from_matrix(&r));
        let pitch = (-r[2][0]).atan2(r[0][0].hypot(r[1][0]));
        y[10..13].copy_from_slice(&[r[2][1].atan2(r[2][2]), pitch, r[1][0].atan2(r[0][0])]);
        y[13..16].copy_from_slice(&to_frame(base, sub(follower.angular, base.angular)));
    }
}
