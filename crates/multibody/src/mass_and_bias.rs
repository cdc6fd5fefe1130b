//! Mass matrix and bias torques in one sweep, for callers that solve `M a = tau - h` themselves.

use crate::crba::fill_columns;
use crate::data::Data;
use crate::model::Model;
use crate::spatial::Motion;
use nalgebra::Vector3;

/// Mass matrix `m` (n x n, row-major, both triangles) and bias torques `h` (length n) at `q`, `v`.
///
/// The results of [`crba`](crate::crba) and [`bias`](crate::bias), with the kinematics computed once.
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn mass_and_bias(model: &Model, data: &mut Data, q: &[f64], v: &[f64], m: &mut [f64], h: &mut [f64]) {
    let n = model.dof();
    model.assert_fit(data, q.len(), &[("v", v.len()), ("h", h.len())]);
    assert!(m.len() == n * n, "the mass matrix has {} entries, not {n} x {n}", m.len());

    // v_0 = 0,  a_0 = -g
    data.bodies[0].v = Motion::default();
    data.bodies[0].a = Motion { angular: Vector3::zeros(), linear: -model.gravity };
    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        let joint = body.joint();
        // λX_i = X_T X_J(q)
        d.x = body.mount.placement(|k| q[body.q + k]);
        // v_i = ⁱX_λ v_λ + S q̇
        d.v = joint.add_motion(d.x.motion_to_child(&parent.v), |k| v[body.v + k]);
        // a_i = ⁱX_λ a_λ + v_i × S q̇
        d.a = d.x.motion_to_child(&parent.a) + joint.cross_motion(&d.v, |k| v[body.v + k]);
        // f_i = I_i a_i + v_i ×* I_i v_i
        d.f = body.inertia.times(&d.a) + d.v.cross_force(&body.inertia.times(&d.v));
        // Iᶜ_i = I_i
        d.composite = body.inertia;
    }

    m.fill(0.0);
    for (i, body) in model.bodies.iter().enumerate().skip(1).rev() {
        fill_columns(model, data, i, m);
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&mut before[body.parent], &rest[0]);
        // h_i = Sᵀ f_i
        body.joint().project(&d.f, |k, value| h[body.v + k] = value);
        if body.parent != 0 {
            // f_λ += λX_i* f_i
            parent.f += d.x.force_to_parent(&d.f);
            // Iᶜ_λ += λX_i* Iᶜ_i ⁱX_λ
            parent.composite += d.composite.in_parent(&d.x);
        }
    }
}
