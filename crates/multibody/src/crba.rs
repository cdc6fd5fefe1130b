//! The joint-space mass matrix: the composite-rigid-body algorithm (Featherstone 2008, table 6.2).

use crate::data::Data;
use crate::model::Model;

/// Mass matrix `m` at `q`: n x n, row-major, both triangles filled; kg m², kg m or kg by the joints.
///
/// O(n d) with d the depth of the tree.
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn crba(model: &Model, data: &mut Data, q: &[f64], m: &mut [f64]) {
    let n = model.dof();
    model.assert_fit(data, q.len(), &[]);
    assert!(m.len() == n * n, "the mass matrix has {} entries, not {n} x {n}", m.len());

    for (i, body) in model.bodies.iter().enumerate().skip(1) {
        let d = &mut data.bodies[i];
        d.x = body.mount.placement(|k| q[body.q + k]);
        // Iᶜ_i = I_i
        d.composite = body.inertia;
    }
    m.fill(0.0);
    for (i, body) in model.bodies.iter().enumerate().skip(1).rev() {
        fill_columns(model, data, i, m);
        if body.parent != 0 {
            let (before, rest) = data.bodies.split_at_mut(i);
            let d = &rest[0];
            // Iᶜ_λ += λX_i* Iᶜ_i ⁱX_λ
            before[body.parent].composite += d.composite.in_parent(&d.x);
        }
    }
}

/// Entries of joint `i` with itself and its ancestors, from the composite inertia of body `i`.
#[inline(always)]
pub(crate) fn fill_columns(model: &Model, data: &Data, i: usize, m: &mut [f64]) {
    for k in 0..model.bodies[i].joint().speeds() {
        fill_column(model, data, i, k, m);
    }
}

#[inline(always)]
fn fill_column(model: &Model, data: &Data, i: usize, k: usize, m: &mut [f64]) {
    let n = model.dof();
    let body = &model.bodies[i];
    let row = body.v + k;
    // F = Iᶜ_i S_i,  M_ii = S_iᵀ F
    let mut force = body.joint().inertia_force(&data.bodies[i].composite, k);
    body.joint().project(&force, |other, entry| m[row * n + body.v + other] = entry);
    let mut j = i;
    while model.bodies[j].parent != 0 {
        // F = λ(j)X_j* F,  j = λ(j)
        force = data.bodies[j].x.force_to_parent(&force);
        j = model.bodies[j].parent;
        // M_ij = M_ji = Fᵀ S_j
        let ancestor = &model.bodies[j];
        ancestor.joint().project(&force, |other, entry| {
            m[row * n + ancestor.v + other] = entry;
            m[(ancestor.v + other) * n + row] = entry;
        });
    }
}
