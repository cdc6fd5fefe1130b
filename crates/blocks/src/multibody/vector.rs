//! Vectors of three elements, and frames that components look at.

use blocksim_block::physical::{FrameAcceleration, FrameMotion, Wrench};

pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale(k: f64, a: [f64; 3]) -> [f64; 3] {
    a.map(|a| k * a)
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A direction in the axes of a frame, in those of the world.
pub(crate) fn to_world(frame: &FrameMotion, a: [f64; 3]) -> [f64; 3] {
    frame.rotation.map(|row| dot(row, a))
}

/// A direction in the axes of the world, in those of a frame.
pub(crate) fn to_frame(frame: &FrameMotion, a: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| dot([frame.rotation[0][k], frame.rotation[1][k], frame.rotation[2][k]], a))
}

/// Velocity of the origin of `follower` as an observer on `base` sees it, in world axes.
pub(crate) fn velocity_seen(base: &FrameMotion, follower: &FrameMotion) -> [f64; 3] {
    let arm = sub(follower.position, base.position);
    sub(sub(follower.velocity, base.velocity), cross(base.angular, arm))
}

/// Acceleration of the origin of `follower` as an observer on `base` sees it, in world axes.
pub(crate) fn acceleration_seen(
    [(base, of_base), (follower, of_follower)]: [(&FrameMotion, &FrameAcceleration); 2],
) -> [f64; 3] {
    let arm = sub(follower.position, base.position);
    let moving = sub(follower.velocity, base.velocity);
    // a - a_b - alpha x r - w x (v - v_b) - w x (what is seen of the velocity)
    let turned = add(cross(base.angular, moving), cross(base.angular, velocity_seen(base, follower)));
    let carried = add(of_base.linear, cross(of_base.angular, arm));
    sub(sub(of_follower.linear, carried), turned)
}

/// Derivative of the angular velocity of `follower` as an observer on `base` sees it, in world axes.
pub(crate) fn angular_acceleration_seen(
    [(base, of_base), (follower, of_follower)]: [(&FrameMotion, &FrameAcceleration); 2],
) -> [f64; 3] {
    let absolute = sub(of_follower.angular, of_base.angular);
    sub(absolute, cross(base.angular, follower.angular))
}

/// A force on the origin of `follower`, and its reaction on the body of `base` at the same point.
pub(crate) fn between(base: &FrameMotion, follower: &FrameMotion, force: [f64; 3]) -> [Wrench; 2] {
    let back = scale(-1.0, force);
    let arm = sub(follower.position, base.position);
    [Wrench { force: back, torque: cross(arm, back) }, Wrench { force, torque: [0.0; 3] }]
}
