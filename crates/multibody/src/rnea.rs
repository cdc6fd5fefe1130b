//! Inverse dynamics: the recursive Newton-Euler algorithm (Featherstone 2008, table 5.1).

use crate::data::Data;
use crate::model::Model;
use crate::spatial::{Force, Motion};
use nalgebra::Vector3;

/// Joint torques (forces) `tau` that produce the accelerations `a` at `q`, `v`.
///
/// Units follow the joints: rad or m, N m or N. Afterwards [`Data::joint_force`] holds what the joints
/// transmit. O(n).
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn rnea(model: &Model, data: &mut Data, q: &[f64], v: &[f64], a: &[f64], tau: &mut [f64]) {
    model.assert_fit(data, q.len(), &[("v", v.len()), ("a", a.len()), ("tau", tau.len())]);
    newton_euler(model, data, q, v, |i| a[i], tau);
}

/// Torques `h` at zero joint acceleration: Coriolis, centrifugal and gravity forces; one per speed.
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn bias(model: &Model, data: &mut Data, q: &[f64], v: &[f64], h: &mut [f64]) {
    model.assert_fit(data, q.len(), &[("v", v.len()), ("h", h.len())]);
    newton_euler(model, data, q, v, |_| 0.0, h);
}

#[inline(always)]
fn newton_euler(
    model: &Model,
    data: &mut Data,
    q: &[f64],
    v: &[f64],
    a: impl Fn(usize) -> f64,
    tau: &mut [f64],
) {
    // v_0 = 0,  a_0 = -g
    data.bodies[0].v = Motion::default();
    data.bodies[0].a = Motion { angular: Vector3::zeros(), linear: -model.gravity };
    data.bodies[0].f = Force::default();

    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        let joint = body.joint();
        // λX_i = X_T X_J(q)
        d.x = body.mount.placement(|k| q[body.q + k]);
        // v_i = ⁱX_λ v_λ + S q̇
        d.v = joint.add_motion(d.x.motion_to_child(&parent.v), |k| v[body.v + k]);
        // a_i = ⁱX_λ a_λ + S q̈ + v_i × S q̇
        d.a = joint.add_motion(d.x.motion_to_child(&parent.a), |k| a(body.v + k))
            + joint.cross_motion(&d.v, |k| v[body.v + k]);
        // f_i = I_i a_i + v_i ×* I_i v_i
        d.f = body.inertia.times(&d.a) + d.v.cross_force(&body.inertia.times(&d.v));
    }

    for (i, body) in model.bodies.iter().enumerate().skip(1).rev() {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&mut before[body.parent], &rest[0]);
        // τ_i = Sᵀ f_i
        body.joint().project(&d.f, |k, value| tau[body.v + k] = value);
        // f_λ += λX_i* f_i
        parent.f += d.x.force_to_parent(&d.f);
    }
}
