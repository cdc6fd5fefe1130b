//! Energies, momentum and centre of mass of a whole tree.

use crate::data::Data;
use crate::kinematics::{forward_kinematics, forward_velocities};
use crate::model::Model;
use crate::spatial::Force;
use nalgebra::Vector3;

/// Momentum of all bodies in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Momentum {
    /// Angular momentum about the world's origin, kg m²/s.
    pub angular: Vector3<f64>,
    /// Linear momentum, kg m/s.
    pub linear: Vector3<f64>,
}

/// Kinetic energy at `q`, `v` (length n): `½ Σ v_i · I_i v_i`, J. Updates placements and velocities.
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn kinetic_energy(model: &Model, data: &mut Data, q: &[f64], v: &[f64]) -> f64 {
    forward_velocities(model, data, q, v);
    let pairs = model.bodies.iter().zip(&data.bodies).skip(1);
    pairs.map(|(body, d)| 0.5 * d.v.dot(&body.inertia.times(&d.v))).sum()
}

/// Potential energy at `q` (length n) against the world's origin: `-Σ m_i g · c_i`, J. Updates placements.
///
/// # Panics
/// If `q` or `data` does not fit the model.
pub fn potential_energy(model: &Model, data: &mut Data, q: &[f64]) -> f64 {
    forward_kinematics(model, data, q);
    -model.gravity.dot(&first_moment(model, data))
}

/// Centre of mass of all bodies at `q` (length n), world coordinates, m; the origin if nothing has mass.
/// Updates placements.
///
/// # Panics
/// If `q` or `data` does not fit the model.
pub fn center_of_mass(model: &Model, data: &mut Data, q: &[f64]) -> Vector3<f64> {
    forward_kinematics(model, data, q);
    let mass = model.mass();
    if mass > 0.0 { first_moment(model, data) / mass } else { Vector3::zeros() }
}

/// Momentum at `q`, `v` (length n) about the world's origin. Updates placements and velocities.
///
/// # Panics
/// If a slice or `data` does not fit the model.
pub fn momentum(model: &Model, data: &mut Data, q: &[f64], v: &[f64]) -> Momentum {
    forward_velocities(model, data, q, v);
    let mut sum = Force::default();
    for (body, d) in model.bodies.iter().zip(&data.bodies).skip(1) {
        // Σ ⁰X_i* I_i v_i
        sum += d.world.force_to_parent(&body.inertia.times(&d.v));
    }
    Momentum { angular: sum.angular, linear: sum.linear }
}

/// `Σ m_i c_i` in world coordinates, kg m, from current placements.
fn first_moment(model: &Model, data: &Data) -> Vector3<f64> {
    let pairs = model.bodies.iter().zip(&data.bodies).skip(1);
    pairs
        .map(|(body, d)| d.world.direction(&body.inertia.moment) + d.world.translation * body.inertia.mass)
        .sum()
}
