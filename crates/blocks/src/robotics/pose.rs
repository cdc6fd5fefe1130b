//! A place in three forms, as the blocks of robots give it.

use blocksim_block::prelude::*;
use blocksim_multibody::{EulerZyx, Placement, quaternion_of_rotation};

/// Position, Euler angles and quaternion of a frame, one after the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    position: [f64; 3],
    zyx: [f64; 3],
    quaternion: [f64; 4],
}

/// The outputs that [`Pose::write`] fills.
pub(crate) fn pose_outputs(origin: &'static str) -> [Output; 3] {
    [
        Output::real("p").shape(Shape::Vector(3)).unit("m").doc(origin),
        Output::real("zyx").shape(Shape::Vector(3)).unit("rad").doc("Euler angles α, β, γ"),
        Output::real("quaternion").shape(Shape::Vector(4)).unit("1").doc("w, x, y, z"),
    ]
}

impl Pose {
    /// Numbers of a pose.
    pub const LEN: usize = 10;

    pub fn of(placement: &Placement) -> Self {
        let EulerZyx { alpha, beta, gamma } = EulerZyx::from_rotation(&placement.rotation);
        let quaternion = quaternion_of_rotation(&placement.rotation);
        Pose { position: placement.translation.into(), zyx: [alpha, beta, gamma], quaternion }
    }

    /// Into [`Pose::LEN`] numbers.
    pub fn write(&self, y: &mut [f64]) {
        y[..3].copy_from_slice(&self.position);
        y[3..6].copy_from_slice(&self.zyx);
        y[6..].copy_from_slice(&self.quaternion);
    }
}
