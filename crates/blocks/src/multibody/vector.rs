//! Vectors of three elements, and frames that components look at.

use blocksim_block::physical::{FrameMotion, Wrench};

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

/// A force on the origin of `follower`, and its reaction on the body of `base` at the same point.
pub(crate) fn between(base: &FrameMotion, follower: &FrameMotion, force: [f64; 3]) -> [Wrench; 2] {
    let back = scale(-1.0, force);
    let arm = sub(follower.position, base.position);
    [Wrench { force: back, torque: cross(arm, back) }, Wrench { force, torque: [0.0; 3] }]
}
