//! The workspace of the algorithms.

use crate::articulated::ArticulatedInertia;
use crate::body::BodyId;
use crate::placement::Placement;
use crate::spatial::{Force, Motion};
use crate::spatial_inertia::SpatialInertia;
use crate::symmetric::Symmetric;
use nalgebra::{Matrix3, Vector3};

/// Workspace for one model, made by [`Model::data`](crate::Model::data).
///
/// Holds nothing between calls but what its getters return; any algorithm may be called at any time. The
/// getters panic on a body of another, larger model.
#[derive(Debug, Clone)]
pub struct Data {
    /// One entry per body; entry 0 is the ground.
    pub(crate) bodies: Vec<BodyData>,
    /// One entry per spherical joint.
    pub(crate) balls: Vec<BallData>,
}

/// Intermediate results of the articulated-body algorithm at a spherical joint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct BallData {
    /// `(Sᵀ Iᴬ S + armature)⁻¹`.
    pub d_inverse: Symmetric,
    /// `Sᵀ Iᴬ`: how accelerations of the parent turn the joint.
    pub rotational: Symmetric,
    /// The linear part of `Sᵀ Iᴬ`.
    pub coupling: Matrix3<f64>,
    /// `τ - Sᵀ pᴬ`.
    pub tau: Vector3<f64>,
}

/// Intermediate results of one body, in its coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyData {
    /// Placement in the parent.
    pub x: Placement,
    /// Placement in the world.
    pub world: Placement,
    /// Spatial velocity.
    pub v: Motion,
    /// Spatial acceleration; gravity is included where the algorithm says so.
    pub a: Motion,
    /// Force through the joint; the bias force in the articulated-body algorithm.
    pub f: Force,
    /// Composite inertia of the subtree.
    pub composite: SpatialInertia,
    /// Articulated inertia of the subtree.
    pub articulated: ArticulatedInertia,
    /// `Iᴬ S`.
    pub u: Force,
    /// `1 / (Sᵀ Iᴬ S + armature)`.
    pub d_inverse: f64,
    /// `τ - Sᵀ pᴬ`.
    pub tau: f64,
}

impl Data {
    pub(crate) fn new(bodies: usize, balls: usize) -> Self {
        let rest = BodyData {
            x: Placement::identity(),
            world: Placement::identity(),
            v: Motion::default(),
            a: Motion::default(),
            f: Force::default(),
            composite: SpatialInertia::default(),
            articulated: ArticulatedInertia::default(),
            u: Force::default(),
            d_inverse: 0.0,
            tau: 0.0,
        };
        Data { bodies: vec![rest; bodies], balls: vec![BallData::default(); balls] }
    }

    /// Placement of a body in the world, as of the last [`forward_kinematics`](crate::forward_kinematics) or
    /// another function that says so.
    pub fn placement(&self, body: BodyId) -> &Placement {
        &self.bodies[body.0].world
    }

    /// Spatial velocity of a body in its own coordinates, as of the last
    /// [`forward_velocities`](crate::forward_velocities).
    pub fn velocity(&self, body: BodyId) -> &Motion {
        &self.bodies[body.0].v
    }

    /// Spatial acceleration of a body in its own coordinates, without gravity, as of the last
    /// [`forward_accelerations`](crate::forward_accelerations).
    pub fn acceleration(&self, body: BodyId) -> &Motion {
        &self.bodies[body.0].a
    }

    /// Acceleration of the point of the body that is at `point` (body coordinates, m), in body coordinates,
    /// as an observer on the ground measures it: `v̇ + ω × v` of that point; valid as [`Data::acceleration`].
    pub fn point_acceleration(&self, body: BodyId, point: &Vector3<f64>) -> Vector3<f64> {
        let BodyData { v, a, .. } = &self.bodies[body.0];
        let speed = v.linear + v.angular.cross(point);
        a.linear + a.angular.cross(point) + v.angular.cross(&speed)
    }

    /// Velocity of the point of the body that is at `point` (body coordinates, m), in world axes: angular
    /// velocity and velocity of the point, as of the last [`forward_velocities`](crate::forward_velocities).
    pub fn world_velocity(&self, body: BodyId, point: &Vector3<f64>) -> Motion {
        let BodyData { v, world, .. } = &self.bodies[body.0];
        let linear = v.linear + v.angular.cross(point);
        Motion { angular: world.direction(&v.angular), linear: world.direction(&linear) }
    }

    /// Angular acceleration and acceleration of a point as an observer on the ground measures them, in world
    /// axes; `point` as in [`Data::world_velocity`], valid as [`Data::acceleration`].
    pub fn world_acceleration(&self, body: BodyId, point: &Vector3<f64>) -> Motion {
        let BodyData { a, world, .. } = &self.bodies[body.0];
        let linear = self.point_acceleration(body, point);
        Motion { angular: world.direction(&a.angular), linear: world.direction(&linear) }
    }

    /// Force that the joint transmits from the parent to a body, in body coordinates about the body's
    /// origin, as of the last [`rnea`](crate::rnea) or [`bias`](crate::bias).
    pub fn joint_force(&self, body: BodyId) -> &Force {
        &self.bodies[body.0].f
    }
}
