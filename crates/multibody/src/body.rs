//! One body of a model.

use crate::joint::{Joint, MountedJoint};
use crate::placement::Placement;
use crate::spatial::SpatialInertia;
use nalgebra::Vector3;

/// Names a body of a [`Model`](crate::Model), and with it the joint that moves it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId(pub(crate) usize);

impl BodyId {
    /// Index of the body's joint in `q`, `v`, `a` and `tau`, counting from 0.
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
}

impl Body {
    /// The ground: it has no parent and nothing reads its joint.
    pub fn ground() -> Self {
        let mount = MountedJoint::new(Joint::Revolute { axis: Vector3::z() }, Placement::identity());
        Body { parent: 0, mount, inertia: SpatialInertia::default() }
    }

    #[inline(always)]
    pub fn joint(&self) -> &Joint {
        &self.mount.joint
    }
}
