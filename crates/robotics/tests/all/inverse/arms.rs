//! Arms to solve for: the ABB IRB 2600-12/1.85 and arms of its class with random dimensions.

use blocksim_multibody::{BodyId, Frame, Inertia, Joint, Model, ModelBuilder, ModelError, Placement};
use blocksim_robotics::kinematics::JointRange;
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Offsets and axes of the robot, published with the support package of ROS-Industrial.
pub fn irb2600() -> Result<(Model, BodyId), ModelError> {
    let links = [
        ([0.0, 0.0, 0.445], Z),
        ([0.150, 0.0, 0.0], Y),
        ([0.0, 0.0, 0.900], Y),
        ([0.0, 0.0, 0.115], X),
        ([0.795, 0.0, 0.0], Y),
        ([0.085, 0.0, 0.0], X),
    ];
    serial(links.map(|(origin, axis)| (Placement::from_translation(origin), axis.into())))
}

/// A chain of axes without masses.
pub fn serial(links: [(Placement, Vector3<f64>); 6]) -> Result<(Model, BodyId), ModelError> {
    let mut builder = ModelBuilder::new();
    let [first, rest @ ..] = links;
    let mut last = builder.add_body(None, Joint::revolute(first.1), first.0, Inertia::zero())?;
    for (place, axis) in rest {
        last = builder.add_body(Some(last), Joint::revolute(axis), place, Inertia::zero())?;
    }
    Ok((builder.build(), last))
}

/// The flange as the maker draws it: z out of it, x down at home.
pub fn flange(last: BodyId) -> Frame {
    Frame::of(last).at(Placement::from_rpy([0.0; 3], [0.0, FRAC_PI_2, 0.0]))
}

/// Tool centre point of a torch: origin in the flange, turned about y.
pub fn torch() -> Placement {
    Placement::from_rpy([0.1195, 0.0, 0.352], [0.0, 0.945973, 0.0])
}

/// Ranges of the robot's joints.
pub fn ranges() -> [JointRange; 6] {
    [(-180, 180), (-95, 155), (-180, 75), (-400, 400), (-120, 120), (-400, 400)].map(|(lower, upper)| {
        JointRange { lower: f64::from(lower).to_radians(), upper: f64::from(upper).to_radians() }
    })
}

/// Numbers from a known start (splitmix64).
pub struct Random(pub u64);

impl Random {
    /// In [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// In [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Within the ranges.
    pub fn pose(&mut self, ranges: &[JointRange; 6]) -> [f64; 6] {
        ranges.map(|r| r.lower + (r.upper - r.lower) * self.unit())
    }
}

/// Largest deviation of two placements, m and rad.
pub fn apart(a: &Placement, b: &Placement) -> f64 {
    (a.rotation - b.rotation).amax().max((a.translation - b.translation).norm())
}
