//! Forward dynamics: the articulated-body algorithm (Featherstone 2008, table 7.1).
//!
//! Articulated inertias are kept as three 3x3 blocks, two of them symmetric.

use crate::data::{BallData, BodyData, Data};
use crate::joint::Joint;
use crate::model::Model;
use crate::placement::Placement;
use crate::spatial::{Force, Motion, SpatialInertia};
use crate::symmetric::Symmetric;
use nalgebra::{Matrix3, Vector3};

/// Inertia of a body with everything that hangs on it by free joints: `[I H; Hᵀ M]`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ArticulatedInertia {
    /// I: moment per angular acceleration, kg m².
    rotational: Symmetric,
    /// H: moment per linear acceleration, kg m.
    coupling: Matrix3<f64>,
    /// M: force per linear acceleration, kg.
    mass: Symmetric,
}

impl ArticulatedInertia {
    #[inline(always)]
    fn rigid(i: &SpatialInertia) -> Self {
        let m = i.mass;
        ArticulatedInertia {
            rotational: i.rotational,
            // H = [h]×
            coupling: i.moment.cross_matrix(),
            mass: Symmetric { xx: m, yy: m, zz: m, yz: 0.0, zx: 0.0, xy: 0.0 },
        }
    }

    /// `Iᴬ m` = (I ω + H v, Hᵀ ω + M v).
    #[inline(always)]
    fn times(&self, m: &Motion) -> Force {
        Force {
            angular: self.rotational.times(&m.angular) + self.coupling * m.linear,
            linear: self.coupling.tr_mul(&m.angular) + self.mass.times(&m.linear),
        }
    }

    /// `Iᴬ s`.
    #[inline(always)]
    fn column(&self, joint: &Joint) -> Force {
        match joint {
            Joint::Prismatic { axis } => {
                Force { angular: self.coupling * axis, linear: self.mass.times(axis) }
            }
            Joint::Revolute { axis } => {
                Force { angular: self.rotational.times(axis), linear: self.coupling.tr_mul(axis) }
            }
            Joint::Spherical => Force::default(),
        }
    }

    /// `Iᴬ - U D⁻¹ Uᵀ` of a spherical joint, where `U = (I, Hᵀ)`.
    fn minus_ball(&self, d_inverse: &Symmetric) -> Self {
        let (i, h, d) = (self.rotational.full(), &self.coupling, d_inverse.full());
        let (di, dh) = (d * i, d * h);
        ArticulatedInertia {
            rotational: Symmetric::from_upper(&(i - i * di)),
            coupling: h - i * dh,
            mass: Symmetric::from_upper(&(self.mass.full() - h.tr_mul(&dh))),
        }
    }

    /// `Iᴬ - U Uᵀ / D`.
    #[inline(always)]
    fn minus_outer(&self, k: f64, u: &Force) -> Self {
        ArticulatedInertia {
            rotational: self.rotational.minus_outer(k, &u.angular),
            coupling: self.coupling - (u.angular * k) * u.linear.transpose(),
            mass: self.mass.minus_outer(k, &u.linear),
        }
    }

    /// `ᵖX꜀* Iᴬ ᶜXₚ`.
    #[inline(always)]
    fn in_parent(&self, x: &Placement) -> Self {
        let (r, p) = (&x.rotation, &x.translation);
        // M' = R M Rᵀ,  G = R H Rᵀ,  H' = G + [p]× M'
        let mass = self.mass.rotated(r);
        let g = r * self.coupling * r.transpose();
        let coupling = g + p.cross_matrix() * mass.full();
        // I' = R I Rᵀ + [p]× Gᵀ - H' [p]×
        let rotational = self.rotational.rotated(r)
            + Symmetric::from_upper(&(p.cross_matrix() * g.transpose() - coupling * p.cross_matrix()));
        ArticulatedInertia { rotational, coupling, mass }
    }
}

impl std::ops::AddAssign for ArticulatedInertia {
    #[inline(always)]
    fn add_assign(&mut self, b: ArticulatedInertia) {
        self.rotational += b.rotational;
        self.coupling += b.coupling;
        self.mass += b.mass;
    }
}

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
