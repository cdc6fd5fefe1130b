//! One body of a model.

use crate::joint::{Joint, MountedJoint};
use crate::placement::Placement;
use crate::spatial_inertia::SpatialInertia;
use nalgebra::Vector3;

/// Names a body of a [`Model`](crate::Model), and with it the joint that moves it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId(pub(crate) usize);

impl BodyId {
    /// Number of the body in the order in which bodies were added, counting from 0. Where its joint stands in
    /// `q` and `v` is told by [`Model::positions`](crate::Model::positions) and
    /// [`Model::speeds`](crate::Model::speeds).
    pub fn index(self) -> usize {
        self.0 - 1
    }
}

/// What is constant about a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Body {
    /// λ(i); 0 is the ground.
    pub parent: usize,
    /// Joint at its place on the parent.
    pub mount: MountedJoint,
    /// About the body's origin, in its coordinates.
    pub inertia: SpatialInertia,
    /// First position of the joint.
    pub q: usize,
    /// First speed of the joint.
    pub v: usize,
    /// Number of spherical joints before.
    pub ball: usize,
}

impl Body {
    /// The ground: it has no parent and nothing reads its joint.
    pub fn ground() -> Self {
        let mount = MountedJoint::new(Joint::Revolute { axis: Vector3::z() }, Placement::identity());
        Body { parent: 0, mount, inertia: SpatialInertia::default(), q: 0, v: 0, ball: 0 }
    }

    #[inline(always)]
    pub fn joint(&self) -> &Joint {
        &self.mount.joint
    }
}
