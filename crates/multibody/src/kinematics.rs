//! Where the bodies are and how they move.

use crate::body::BodyId;
use crate::data::Data;
use crate::model::Model;
use crate::placement::Placement;
use crate::spatial::Motion;
use nalgebra::Vector3;

/// Placements of all bodies in the world at `q` (length n); read them with [`Data::placement`].
///
/// # Panics
/// If `q` or `data` does not fit the model.
pub fn forward_kinematics(model: &Model, data: &mut Data, q: &[f64]) {
    model.assert_fit(data, &[("q", q.len())]);
    data.bodies[0].world = Placement::identity();
    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        // ⁰X_i = ⁰X_λ X_T X_J(q)
        d.x = body.mount.placement(q[i - 1]);
        d.world = parent.world * d.x;
    }
}

/// Placements and spatial velocities of all bodies at `q`, `v` (length n); read them with
/// [`Data::placement`] and [`Data::velocity`].
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn forward_velocities(model: &Model, data: &mut Data, q: &[f64], v: &[f64]) {
    model.assert_fit(data, &[("v", v.len())]);
    forward_kinematics(model, data, q);
    data.bodies[0].v = Motion::default();
    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        // v_i = ⁱX_λ v_λ + S q̇
        d.v = body.joint().add_motion(d.x.motion_to_child(&parent.v), v[i - 1]);
    }
}

/// Placements, velocities and accelerations (without gravity) of all bodies at `q`, `v`, `a` (length n);
/// read them with [`Data::placement`], [`Data::velocity`], [`Data::acceleration`] and
/// [`Data::point_acceleration`].
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn forward_accelerations(model: &Model, data: &mut Data, q: &[f64], v: &[f64], a: &[f64]) {
    model.assert_fit(data, &[("a", a.len())]);
    forward_velocities(model, data, q, v);
    data.bodies[0].a = Motion::default();
    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        // a_i = ⁱX_λ a_λ + S q̈ + v_i × S q̇
        d.a = body.joint().add_motion(d.x.motion_to_child(&parent.a), a[i - 1])
            + body.joint().cross_motion(&d.v, v[i - 1]);
    }
}

/// Jacobian of the point `point` (body coordinates, m) of `body` at `q`: 6 x n, row-major, angular rows
/// first, in world coordinates: `(ω; ṗ) = J v`. Updates [`Data::placement`].
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
    let n = model.dof();
    assert!(jacobian.len() == 6 * n, "the Jacobian has {} entries, not 6 x {n}", jacobian.len());
    forward_kinematics(model, data, q);
    jacobian.fill(0.0);
    let target = data.bodies[body.0].world.point(point);
    let mut i = body.0;
    while i != 0 {
        let world = &data.bodies[i].world;
        let s = model.bodies[i].joint().subspace();
        // J_i = (R s_ω, R s_v + R s_ω × (target - p_i))
        let angular = world.direction(&s.angular);
        let linear = world.direction(&s.linear) + angular.cross(&(target - world.translation));
        for row in 0..3 {
            jacobian[row * n + i - 1] = angular[row];
            jacobian[(row + 3) * n + i - 1] = linear[row];
        }
        i = model.bodies[i].parent;
    }
}
