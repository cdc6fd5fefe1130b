//! The constant description of a kinematic tree.

use crate::body::{Body, BodyId};
use crate::data::Data;
use crate::inertia::Inertia;
use crate::joint::Joint;
use crate::placement::Placement;
use crate::spatial_inertia::SpatialInertia;
use nalgebra::Vector3;
use std::ops::Range;

/// Standard acceleration of free fall, m/s² (CGPM 1901).
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// A kinematic tree: bodies in topological order, each with one joint to its parent.
#[derive(Debug, Clone)]
pub struct Model {
    /// Entry 0 is the ground.
    pub(crate) bodies: Vec<Body>,
    pub(crate) gravity: Vector3<f64>,
    pub(crate) positions: usize,
    pub(crate) speeds: usize,
}

impl Model {
    /// Number of degrees of freedom: of the speeds, accelerations and joint torques.
    #[inline(always)]
    pub fn dof(&self) -> usize {
        self.speeds
    }

    /// Number of positions; more than degrees of freedom where there are spherical joints.
    pub fn nq(&self) -> usize {
        self.positions
    }

    /// Where the joint of a body stands in `q`.
    pub fn positions(&self, body: BodyId) -> Range<usize> {
        let body = &self.bodies[body.0];
        body.q..body.q + body.joint().positions()
    }

    /// Where the joint of a body stands in `v`, `a` and `tau`.
    pub fn speeds(&self, body: BodyId) -> Range<usize> {
        let body = &self.bodies[body.0];
        body.v..body.v + body.joint().speeds()
    }

    /// The bodies in topological order.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> + use<> {
        (1..self.bodies.len()).map(BodyId)
    }

    /// Parent of a body, `None` for the ground.
    pub fn parent(&self, body: BodyId) -> Option<BodyId> {
        let parent = self.bodies[body.0].parent;
        (parent != 0).then_some(BodyId(parent))
    }

    /// The bodies on the way from the ground to a body, which is the last of them.
    pub fn chain(&self, body: BodyId) -> Vec<BodyId> {
        let mut chain: Vec<_> = std::iter::successors(Some(body), |body| self.parent(*body)).collect();
        chain.reverse();
        chain
    }

    /// Joint that moves a body, with an axis of length one.
    pub fn joint(&self, body: BodyId) -> &Joint {
        self.bodies[body.0].joint()
    }

    /// Where the joint of a body sits in its parent.
    pub fn joint_placement(&self, body: BodyId) -> &Placement {
        &self.bodies[body.0].mount.home
    }

    /// Gravity in world coordinates, m/s².
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// Mass of all bodies, kg.
    pub fn mass(&self) -> f64 {
        self.bodies.iter().map(|body| body.inertia.mass).sum()
    }

    /// Adds `share` times a mass to a body, where the load of a body changes while a simulation runs; `inertia`
    /// is written in the frame of the body ([`Inertia::placed`]) and has passed [`Inertia::check`].
    pub fn add_load(&mut self, body: BodyId, inertia: &Inertia, share: f64) {
        let about = inertia.spatial();
        let load = SpatialInertia {
            mass: share * about.mass,
            moment: about.moment * share,
            rotational: about.rotational.scaled(share),
        };
        self.bodies[body.0].inertia += load;
    }

    /// Gives all bodies the mass properties that they have in `other`, a model of the same tree: without the
    /// loads of [`Model::add_load`].
    pub fn copy_inertias(&mut self, other: &Model) {
        for (body, other) in self.bodies.iter_mut().zip(&other.bodies) {
            body.inertia = other.inertia;
        }
    }

    /// A workspace for this model.
    pub fn data(&self) -> Data {
        let balls = self.bodies.iter().skip(1).filter(|body| *body.joint() == Joint::Spherical).count();
        Data::new(self.bodies.len(), balls)
    }

    /// Panics unless `data` and the slices (name, length) fit the model: a mix-up in the calling code.
    #[inline(always)]
    pub(crate) fn assert_fit(&self, data: &Data, positions: usize, slices: &[(&str, usize)]) {
        assert!(data.bodies.len() == self.bodies.len(), "the workspace belongs to another model");
        assert!(positions == self.positions, "q has {positions} entries, the model {}", self.positions);
        for (name, length) in slices {
            assert!(*length == self.speeds, "{name} has {length} entries, the model {} speeds", self.speeds);
        }
    }
}
