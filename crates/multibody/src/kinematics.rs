//! Where the bodies are and how they move.

use crate::body::BodyId;
use crate::data::Data;
use crate::model::Model;
use crate::placement::Placement;
use crate::spatial::{Force, Motion};
use nalgebra::Vector3;

/// Placements of all bodies in the world at `q` (length n); read them with [`Data::placement`].
///
/// # Panics
/// If `q` or `data` does not fit the model.
pub fn forward_kinematics(model: &Model, data: &mut Data, q: &[f64]) {
    model.assert_fit(data, q.len(), &[]);
    data.bodies[0].world = Placement::identity();
    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        // ⁰X_i = ⁰X_λ X_T X_J(q)
        d.x = body.mount.placement(|k| q[body.q + k]);
        d.world = parent.world * d.x;
    }
}

/// Placements and spatial velocities of all bodies at `q`, `v` (length n); read them with
/// [`Data::placement`] and [`Data::velocity`].
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn forward_velocities(model: &Model, data: &mut Data, q: &[f64], v: &[f64]) {
    model.assert_fit(data, q.len(), &[("v", v.len())]);
    forward_kinematics(model, data, q);
    data.bodies[0].v = Motion::default();
    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        // v_i = ⁱX_λ v_λ + S q̇
        d.v = body.joint().add_motion(d.x.motion_to_child(&parent.v), |k| v[body.v + k]);
    }
}

/// Placements, velocities and accelerations (without gravity) of all bodies at `q`, `v`, `a`; read them with
/// [`Data::placement`], [`Data::velocity`], [`Data::acceleration`], [`Data::point_acceleration`] and
/// [`Data::world_acceleration`].
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn forward_accelerations(model: &Model, data: &mut Data, q: &[f64], v: &[f64], a: &[f64]) {
    model.assert_fit(data, q.len(), &[("a", a.len())]);
    accelerations(model, data, q, v, |i| a[i]);
}

/// As [`forward_accelerations`] with all joint accelerations zero: what [`Data::world_acceleration`] then gives is
/// `J̇ v` of [`jacobian`].
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn bias_accelerations(model: &Model, data: &mut Data, q: &[f64], v: &[f64]) {
    accelerations(model, data, q, v, |_| 0.0);
}

#[inline(always)]
fn accelerations(model: &Model, data: &mut Data, q: &[f64], v: &[f64], a: impl Fn(usize) -> f64) {
    forward_velocities(model, data, q, v);
    data.bodies[0].a = Motion::default();
    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        // a_i = ⁱX_λ a_λ + S q̈ + v_i × S q̇
        d.a = body.joint().add_motion(d.x.motion_to_child(&parent.a), |k| a(body.v + k))
            + body.joint().cross_motion(&d.v, |k| v[body.v + k]);
    }
}

/// Jacobian of the point `point` (body coordinates, m) of `body` at `q`: 6 x [`Model::dof`], row-major, angular
/// rows first, in world coordinates: `(ω; ṗ) = J v`. Updates [`Data::placement`].
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn jacobian(
    model: &Model,
    data: &mut Data,
    q: &[f64],
    body: BodyId,
    point: &Vector3<f64>,
    jacobian: &mut [f64],
) {
    forward_kinematics(model, data, q);
    jacobian.fill(0.0);
    add_jacobian(model, data, body, point, 1.0, jacobian);
}

/// Adds `factor` times the [`jacobian`] of a point, from the current placements: of the last
/// [`forward_kinematics`] or another function that updates them.
///
/// # Panics
/// If `jacobian` or `data` does not fit the model.
pub fn add_jacobian(
    model: &Model,
    data: &Data,
    body: BodyId,
    point: &Vector3<f64>,
    factor: f64,
    jacobian: &mut [f64],
) {
    let n = model.dof();
    assert!(jacobian.len() == 6 * n, "the Jacobian has {} entries, not 6 x {n}", jacobian.len());
    let target = data.bodies[body.0].world.point(point);
    let mut i = body.0;
    while i != 0 {
        let world = &data.bodies[i].world;
        let body = &model.bodies[i];
        for k in 0..body.joint().speeds() {
            let s = body.joint().subspace(k);
            // J_i = (R s_ω, R s_v + R s_ω × (target - p_i))
            let angular = world.direction(&s.angular);
            let linear = world.direction(&s.linear) + angular.cross(&(target - world.translation));
            for row in 0..3 {
                jacobian[row * n + body.v + k] += factor * angular[row];
                jacobian[(row + 3) * n + body.v + k] += factor * linear[row];
            }
        }
        i = body.parent;
    }
}

/// Adds to `tau` what a force on `body` does at all joints: `tau += Jᵀ f`. The force is written in world axes
/// and acts at the point `point` (body coordinates, m); placements are those of the last
/// [`forward_kinematics`]. With it, every algorithm takes forces from outside: they are part of `tau`.
///
/// # Panics
/// If `tau` or `data` does not fit the model.
pub fn add_force(
    model: &Model,
    data: &Data,
    body: BodyId,
    point: &Vector3<f64>,
    force: &Force,
    tau: &mut [f64],
) {
    model.assert_fit(data, model.nq(), &[("tau", tau.len())]);
    let world = &data.bodies[body.0].world;
    // in body coordinates about the origin of the body
    let linear = world.rotation.tr_mul(&force.linear);
    let mut f = Force { angular: world.rotation.tr_mul(&force.angular) + point.cross(&linear), linear };
    let mut i = body.0;
    while i != 0 {
        let body = &model.bodies[i];
        body.joint().project(&f, |k, value| tau[body.v + k] += value);
        f = data.bodies[i].x.force_to_parent(&f);
        i = body.parent;
    }
}
