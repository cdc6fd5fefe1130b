//! How a kinematic tree is built.

use crate::body::{Body, BodyId};
use crate::error::ModelError;
use crate::inertia::Inertia;
use crate::joint::{Joint, MountedJoint};
use crate::model::{Model, STANDARD_GRAVITY};
use crate::placement::Placement;
use nalgebra::Vector3;

/// How far `RᵀR` of a placement may be from the identity: rotations typed with seven digits pass.
const ROTATION_TOLERANCE: f64 = 1e-6;

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
