//! The constant description of a kinematic tree, and how it is built.

use crate::body::{Body, BodyId};
use crate::data::Data;
use crate::error::ModelError;
use crate::inertia::Inertia;
use crate::joint::{Joint, MountedJoint};
use crate::placement::Placement;
use crate::spatial_inertia::SpatialInertia;
use nalgebra::Vector3;
use std::ops::Range;

/// Standard acceleration of free fall, m/s² (CGPM 1901).
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// How far `RᵀR` of a placement may be from the identity: rotations typed with seven digits pass.
const ROTATION_TOLERANCE: f64 = 1e-6;

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

/// Builds a [`Model`] body by body, parents first.
///
/// ```
/// use blocksim_multibody::{Inertia, Joint, ModelBuilder, Placement, bias};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let mut builder = ModelBuilder::new();
/// let bob = Inertia::point(2.0, [0.0, 0.0, -0.5])?;
/// builder.add_body(None, Joint::revolute([0.0, 1.0, 0.0]), Placement::identity(), bob)?;
/// let pendulum = builder.build();
/// let mut torque = [0.0];
/// bias(&pendulum, &mut pendulum.data(), &[0.1], &[0.0], &mut torque);
/// assert!((torque[0] - 2.0 * 9.80665 * 0.5 * 0.1_f64.sin()).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    parts: Vec<Part>,
    gravity: Vector3<f64>,
}

/// A body while masses may still be attached to it.
#[derive(Debug, Clone)]
struct Part {
    parent: usize,
    mount: MountedJoint,
    inertia: Inertia,
}

impl Default for ModelBuilder {
    fn default() -> Self {
        ModelBuilder { parts: Vec::new(), gravity: Vector3::new(0.0, 0.0, -STANDARD_GRAVITY) }
    }
}

impl ModelBuilder {
    /// No bodies; gravity (0, 0, -9.80665) m/s².
    pub fn new() -> Self {
        ModelBuilder::default()
    }

    /// Sets gravity in world coordinates, m/s².
    pub fn gravity(&mut self, gravity: impl Into<Vector3<f64>>) -> &mut Self {
        self.gravity = gravity.into();
        self
    }

    /// Adds a body that `joint` moves against `parent` (`None`: the ground). The joint frame sits at
    /// `placement` in the parent; `inertia` is written in the body frame.
    ///
    /// # Errors
    /// An axis without direction, a placement that is not rigid, impossible mass properties, or a parent
    /// that this builder did not return.
    pub fn add_body(
        &mut self,
        parent: Option<BodyId>,
        joint: Joint,
        placement: Placement,
        inertia: Inertia,
    ) -> Result<BodyId, ModelError> {
        let index = self.parts.len();
        if let Some(parent) = parent {
            self.known(parent)?;
        }
        let joint = joint.normalized().ok_or_else(|| {
            let axis = joint.axis().unwrap_or_else(Vector3::zeros).into();
            ModelError::Axis { body: index, axis }
        })?;
        check_placement(index, &placement)?;
        inertia.check().map_err(|cause| ModelError::Inertia { body: index, cause })?;
        let mount = MountedJoint::new(joint, placement);
        self.parts.push(Part { parent: parent.map_or(0, |id| id.0), mount, inertia });
        Ok(BodyId(index + 1))
    }

    /// Adds a body that moves against `parent` by several joints one after another, with bodies that have no mass
    /// in between. Returns all of them; the last one bears `inertia`.
    ///
    /// # Errors
    /// As [`ModelBuilder::add_body`].
    pub fn add_chain(
        &mut self,
        parent: Option<BodyId>,
        joints: &[Joint],
        placement: Placement,
        inertia: Inertia,
    ) -> Result<Vec<BodyId>, ModelError> {
        let mut bodies = Vec::new();
        for (i, joint) in joints.iter().enumerate() {
            let place = if i == 0 { placement } else { Placement::identity() };
            let mass = if i + 1 == joints.len() { inertia } else { Inertia::zero() };
            bodies.push(self.add_body(bodies.last().copied().or(parent), *joint, place, mass)?);
        }
        Ok(bodies)
    }

    /// Fixes another mass to a body; `inertia` is written in a frame at `placement` in the body.
    ///
    /// # Errors
    /// A placement that is not rigid, impossible mass properties, or a body that this builder did not
    /// return.
    pub fn add_inertia(
        &mut self,
        body: BodyId,
        placement: Placement,
        inertia: Inertia,
    ) -> Result<(), ModelError> {
        self.known(body)?;
        check_placement(body.index(), &placement)?;
        inertia.check().map_err(|cause| ModelError::Inertia { body: body.index(), cause })?;
        let part = &mut self.parts[body.index()];
        part.inertia = part.inertia + inertia.placed(&placement);
        Ok(())
    }

    /// The finished model.
    pub fn build(self) -> Model {
        let mut bodies = vec![Body::ground()];
        let (mut q, mut v, mut ball) = (0, 0, 0);
        for part in &self.parts {
            let joint = part.mount.joint;
            bodies.push(Body {
                parent: part.parent,
                mount: part.mount,
                inertia: part.inertia.spatial(),
                q,
                v,
                ball,
            });
            q += joint.positions();
            v += joint.speeds();
            ball += usize::from(joint == Joint::Spherical);
        }
        Model { bodies, gravity: self.gravity, positions: q, speeds: v }
    }

    fn known(&self, body: BodyId) -> Result<(), ModelError> {
        match body.index() < self.parts.len() {
            true => Ok(()),
            false => Err(ModelError::UnknownBody { body: body.index() }),
        }
    }
}

fn check_placement(body: usize, placement: &Placement) -> Result<(), ModelError> {
    let finite = placement.translation.iter().all(|x| x.is_finite());
    match finite && placement.rotation_error() <= ROTATION_TOLERANCE {
        true => Ok(()),
        false => Err(ModelError::Placement { body }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::InertiaError;
    use nalgebra::Matrix3;

    fn hinge() -> Joint {
        Joint::revolute([0.0, 0.0, 2.0])
    }

    #[test]
    fn a_tree_knows_its_parents_and_normalizes_its_axes() -> Result<(), ModelError> {
        let mut builder = ModelBuilder::new();
        let root = builder.add_body(None, hinge(), Placement::identity(), Inertia::zero())?;
        let left = builder.add_body(Some(root), hinge(), Placement::identity(), Inertia::zero())?;
        let right = builder.add_body(Some(root), hinge(), Placement::identity(), Inertia::zero())?;
        let model = builder.build();
        assert_eq!(model.bodies().collect::<Vec<_>>(), [root, left, right]);
        assert_eq!([root, left, right].map(|id| model.parent(id)), [None, Some(root), Some(root)]);
        assert_eq!([root, left, right].map(BodyId::index), [0, 1, 2]);
        assert_eq!(*model.joint(right), Joint::revolute([0.0, 0.0, 1.0]));
        Ok(())
    }

    #[test]
    fn a_fixed_mass_is_part_of_its_body() -> Result<(), Box<dyn std::error::Error>> {
        let load = Inertia::from_moments(2.0, [0.1, 0.0, 0.0], [0.5, 0.6, 0.7], [0.0; 3])?;
        let at = Placement::from_rpy([0.0, 0.3, 0.0], [0.1, 0.2, 0.3]);
        let (mut attached, mut placed) = (ModelBuilder::new(), ModelBuilder::new());
        let body = attached.add_body(None, hinge(), Placement::identity(), Inertia::zero())?;
        attached.add_inertia(body, at, load)?;
        placed.add_body(None, hinge(), Placement::identity(), load.placed(&at))?;
        let (attached, placed) = (attached.build(), placed.build());
        let (got, expected) = (attached.bodies[1].inertia, placed.bodies[1].inertia);
        assert!((got.moment - expected.moment).norm() < 1e-15);
        assert!((got.rotational.full() - expected.rotational.full()).abs().max() < 1e-15);
        assert_eq!(attached.mass(), 2.0);
        Ok(())
    }

    #[test]
    fn a_load_comes_and_goes_without_a_trace() -> Result<(), Box<dyn std::error::Error>> {
        let load = Inertia::from_moments(2.0, [0.1, 0.0, 0.0], [0.5, 0.6, 0.7], [0.0; 3])?;
        let (mut bare, mut loaded) = (ModelBuilder::new(), ModelBuilder::new());
        let body = bare.add_body(None, hinge(), Placement::identity(), Inertia::point(1.0, [0.3; 3])?)?;
        loaded.add_body(None, hinge(), Placement::identity(), Inertia::point(1.0, [0.3; 3])?)?;
        loaded.add_inertia(body, Placement::identity(), load)?;
        let (bare, loaded) = (bare.build(), loaded.build());
        let mut model = bare.clone();
        model.add_load(body, &load, 1.0);
        let (got, expected) = (model.bodies[1].inertia, loaded.bodies[1].inertia);
        assert!((got.moment - expected.moment).norm() < 1e-15);
        assert!((got.rotational.full() - expected.rotational.full()).abs().max() < 1e-15);
        model.copy_inertias(&bare);
        assert_eq!(model.bodies[1].inertia, bare.bodies[1].inertia);
        Ok(())
    }

    #[test]
    fn wrong_parts_are_refused_by_index() -> Result<(), ModelError> {
        let mut builder = ModelBuilder::new();
        let id = builder.add_body(None, hinge(), Placement::identity(), Inertia::zero())?;
        let mut add = |joint, placement, inertia| builder.add_body(Some(id), joint, placement, inertia).err();
        let here = Placement::identity();
        let flat = Joint::prismatic([0.0; 3]);
        assert_eq!(add(flat, here, Inertia::zero()), Some(ModelError::Axis { body: 1, axis: [0.0; 3] }));
        let twice = Placement { rotation: Matrix3::identity() * 2.0, ..here };
        assert_eq!(add(hinge(), twice, Inertia::zero()), Some(ModelError::Placement { body: 1 }));
        let negative = Inertia { mass: -1.0, ..Inertia::zero() };
        let cause = InertiaError::NegativeMass { mass: -1.0 };
        assert_eq!(add(hinge(), here, negative), Some(ModelError::Inertia { body: 1, cause }));
        let mut other = ModelBuilder::new();
        let stranger = other.add_body(Some(id), hinge(), here, Inertia::zero()).err();
        assert_eq!(stranger, Some(ModelError::UnknownBody { body: 0 }));
        Ok(())
    }
}
