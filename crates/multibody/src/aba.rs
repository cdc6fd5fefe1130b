//! Forward dynamics: the articulated-body algorithm (Featherstone 2008, table 7.1).

use crate::articulated::ArticulatedInertia;
use crate::data::{BallData, BodyData, Data};
use crate::joint::Joint;
use crate::model::Model;
use crate::spatial::{Force, Motion};
use nalgebra::Vector3;

/// Joint accelerations `a` that the torques (forces) `tau` produce at `q`, `v`.
///
/// `armature` is the inertia that drives reflect to each speed (kg m² or kg), added to the diagonal of the
/// mass matrix; empty for none. A joint that moves no inertia at all gives an acceleration that is not
/// finite. O(n).
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn aba(
    model: &Model,
    data: &mut Data,
    q: &[f64],
    v: &[f64],
    tau: &[f64],
    armature: &[f64],
    a: &mut [f64],
) {
    model.assert_fit(data, q.len(), &[("v", v.len()), ("tau", tau.len()), ("a", a.len())]);
    assert!(
        armature.is_empty() || armature.len() == model.dof(),
        "armature has {} entries, the model {} speeds",
        armature.len(),
        model.dof()
    );

    // v_0 = 0,  a_0 = -g
    data.bodies[0].v = Motion::default();
    data.bodies[0].a = Motion { angular: Vector3::zeros(), linear: -model.gravity };
    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        // λX_i = X_T X_J(q)
        d.x = body.mount.placement(|k| q[body.q + k]);
        // v_i = ⁱX_λ v_λ + S q̇
        d.v = body.joint().add_motion(d.x.motion_to_child(&parent.v), |k| v[body.v + k]);
        // c_i = v_i × S q̇, kept in a_i until the last sweep
        d.a = body.joint().cross_motion(&d.v, |k| v[body.v + k]);
        // Iᴬ_i = I_i
        d.articulated = ArticulatedInertia::rigid(&body.inertia);
        // pᴬ_i = v_i ×* I_i v_i
        d.f = d.v.cross_force(&body.inertia.times(&d.v));
    }

    for (i, body) in model.bodies.iter().enumerate().skip(1).rev() {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&mut before[body.parent], &mut rest[0]);
        if *body.joint() == Joint::Spherical {
            let ball = &mut data.balls[body.ball];
            free_ball(d, ball, |k| tau[body.v + k], |k| armature.get(body.v + k).copied().unwrap_or(0.0));
            if body.parent != 0 {
                // Iᵃ = Iᴬ - U D⁻¹ Uᵀ,  pᵃ = pᴬ + Iᵃ c + U D⁻¹ u
                let inertia = d.articulated.minus_ball(&ball.d_inverse);
                let turn = ball.d_inverse.times(&ball.tau);
                let push = d.articulated.times(&Motion { angular: turn, linear: Vector3::zeros() });
                let force = d.f + inertia.times(&d.a) + push;
                parent.articulated += inertia.in_parent(&d.x);
                parent.f += d.x.force_to_parent(&force);
            }
            continue;
        }
        // U = Iᴬ S
        d.u = d.articulated.column(body.joint());
        // D = Sᵀ U + armature
        let mut inertia = armature.get(body.v).copied().unwrap_or(0.0);
        body.joint().project(&d.u, |_, value| inertia += value);
        d.d_inverse = 1.0 / inertia;
        // u = τ - Sᵀ pᴬ
        d.tau = tau[body.v];
        body.joint().project(&d.f, |_, value| d.tau -= value);
        if body.parent != 0 {
            // Iᵃ = Iᴬ - U Uᵀ / D
            let inertia = d.articulated.minus_outer(d.d_inverse, &d.u);
            // pᵃ = pᴬ + Iᵃ c + U u / D
            let k = d.d_inverse * d.tau;
            let push = Force { angular: d.u.angular * k, linear: d.u.linear * k };
            let force = d.f + inertia.times(&d.a) + push;
            // Iᴬ_λ += λX_i* Iᵃ ⁱX_λ
            parent.articulated += inertia.in_parent(&d.x);
            // pᴬ_λ += λX_i* pᵃ
            parent.f += d.x.force_to_parent(&force);
        }
    }

    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let (before, rest) = data.bodies.split_at_mut(i);
        let (parent, d) = (&before[body.parent], &mut rest[0]);
        // a' = ⁱX_λ a_λ + c_i
        let carried = d.x.motion_to_child(&parent.a) + d.a;
        // q̈ = D⁻¹ (u - Uᵀ a')
        if *body.joint() == Joint::Spherical {
            let ball = &data.balls[body.ball];
            let held = ball.rotational.times(&carried.angular) + ball.coupling * carried.linear;
            let turn = ball.d_inverse.times(&(ball.tau - held));
            (0..3).for_each(|k| a[body.v + k] = turn[k]);
        } else {
            a[body.v] = d.d_inverse * (d.tau - carried.dot(&d.u));
        }
        // a_i = a' + S q̈
        d.a = body.joint().add_motion(carried, |k| a[body.v + k]);
    }
}

/// `D⁻¹` and `u` of a spherical joint.
fn free_ball(d: &BodyData, ball: &mut BallData, tau: impl Fn(usize) -> f64, armature: impl Fn(usize) -> f64) {
    let mut inertia = d.articulated.rotational;
    ball.rotational = inertia;
    ball.coupling = d.articulated.coupling;
    inertia.xx += armature(0);
    inertia.yy += armature(1);
    inertia.zz += armature(2);
    ball.d_inverse = inertia.inverse();
    ball.tau = Vector3::new(tau(0), tau(1), tau(2)) - d.f.angular;
}
