//! Positions and speeds: how the first follow from the second.

use crate::joint::Joint;
use crate::model::Model;
use crate::quaternion;
use nalgebra::Vector3;

/// Derivatives of the positions at `q`, `v`: the speeds themselves, and `p (0, ω) / 2` for the quaternion of a
/// spherical joint. `dq` has [`Model::nq`] entries.
///
/// # Panics
/// If a slice does not fit the model.
pub fn positions_derivative(model: &Model, q: &[f64], v: &[f64], dq: &mut [f64]) {
    for body in model.bodies.iter().skip(1) {
        match body.joint() {
            Joint::Spherical => {
                let (p, omega) = (four(q, body.q), three(v, body.v));
                dq[body.q..body.q + 4].copy_from_slice(&quaternion::derivative(p, &omega));
            }
            _ => dq[body.q] = v[body.v],
        }
    }
}

/// Moves positions by a finite step (one entry per speed, rad or m): spherical joints turn about the vector of
/// their three entries and come out with unit quaternions.
///
/// # Panics
/// If a slice does not fit the model.
pub fn move_positions(model: &Model, q: &mut [f64], step: &[f64]) {
    for body in model.bodies.iter().skip(1) {
        match body.joint() {
            Joint::Spherical => {
                let turn = quaternion::exponential(&three(step, body.v));
                let moved = quaternion::normalized(quaternion::product(four(q, body.q), turn));
                q[body.q..body.q + 4].copy_from_slice(&moved);
            }
            _ => q[body.q] += step[body.v],
        }
    }
}

/// Coordinate zero of all joints: zeros, and the quaternion that turns nothing. [`Model::nq`] entries.
pub fn home_positions(model: &Model) -> Vec<f64> {
    let mut q = vec![0.0; model.nq()];
    for body in model.bodies.iter().skip(1).filter(|body| *body.joint() == Joint::Spherical) {
        q[body.q] = 1.0;
    }
    q
}

fn four(q: &[f64], at: usize) -> [f64; 4] {
    [q[at], q[at + 1], q[at + 2], q[at + 3]]
}

fn three(v: &[f64], at: usize) -> Vector3<f64> {
    Vector3::new(v[at], v[at + 1], v[at + 2])
}
