//! What motion without actuators must conserve.

use crate::trees::Random;
use blocksim_multibody::{
    Inertia, Joint, Model, ModelBuilder, Placement, aba, center_of_mass, kinetic_energy, momentum,
    positions_derivative, potential_energy,
};
use nalgebra::Vector3;
use std::error::Error;

type Outcome = Result<(), Box<dyn Error>>;

/// A chain of three bodies on a carrier that is free in all six directions: three massless sliders, two
/// massless rings, the carrier, then a hinge, a slider and a hinge.
fn free_chain(gravity: [f64; 3]) -> Result<Model, Box<dyn Error>> {
    let mut random = Random(7);
    let mut builder = ModelBuilder::new();
    builder.gravity(gravity);
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let mut last = None;
    for joint in [x, y, z].map(Joint::prismatic).into_iter().chain([z, y].map(Joint::revolute)) {
        last = Some(builder.add_body(last, joint, Placement::identity(), Inertia::zero())?);
    }
    for joint in [Joint::revolute(x), Joint::revolute(y), Joint::prismatic(z), Joint::revolute(x)] {
        last = Some(builder.add_body(last, joint, random.placement(), random.inertia()?)?);
    }
    Ok(builder.build())
}

/// A free body (translations and a quaternion) that carries a hinge, a ball and a slider.
fn floating_chain() -> Result<Model, Box<dyn Error>> {
    let mut random = Random(23);
    let mut builder = ModelBuilder::new();
    builder.gravity([0.0; 3]);
    let carrier = random.inertia()?;
    let mut last = builder.add_chain(None, &Joint::free(), Placement::identity(), carrier)?.pop();
    for joint in [Joint::revolute([1.0, 0.0, 0.0]), Joint::Spherical, Joint::prismatic([0.0, 0.0, 1.0])] {
        last = Some(builder.add_body(last, joint, random.placement(), random.inertia()?)?);
    }
    Ok(builder.build())
}

/// A chain of two hinges on the ground.
fn hanging_chain() -> Result<Model, Box<dyn Error>> {
    let mut random = Random(11);
    let mut builder = ModelBuilder::new();
    let mut last = None;
    for joint in [Joint::revolute([0.0, 1.0, 0.0]), Joint::revolute([1.0, 1.0, 0.0])] {
        last = Some(builder.add_body(last, joint, random.placement(), random.inertia()?)?);
    }
    Ok(builder.build())
}

/// `(q, v)` after `steps` classical Runge-Kutta steps of length `dt` (s) without torques.
pub fn fall(model: &Model, mut q: Vec<f64>, mut v: Vec<f64>, dt: f64, steps: usize) -> (Vec<f64>, Vec<f64>) {
    let n = model.dof();
    let mut data = model.data();
    let tau = vec![0.0; n];
    let mut slope = |q: &[f64], v: &[f64]| {
        let mut a = vec![0.0; n];
        aba(model, &mut data, q, v, &tau, &[], &mut a);
        let mut dq = vec![0.0; q.len()];
        positions_derivative(model, q, v, &mut dq);
        (dq, a)
    };
    let ahead =
        |x: &[f64], dx: &[f64], h: f64| -> Vec<f64> { x.iter().zip(dx).map(|(x, dx)| x + h * dx).collect() };
    for _ in 0..steps {
        let (q1, v1) = slope(&q, &v);
        let (q2, v2) = slope(&ahead(&q, &q1, dt / 2.0), &ahead(&v, &v1, dt / 2.0));
        let (q3, v3) = slope(&ahead(&q, &q2, dt / 2.0), &ahead(&v, &v2, dt / 2.0));
        let (q4, v4) = slope(&ahead(&q, &q3, dt), &ahead(&v, &v3, dt));
        for i in 0..model.nq() {
            q[i] += dt / 6.0 * (q1[i] + 2.0 * q2[i] + 2.0 * q3[i] + q4[i]);
        }
        for i in 0..n {
            v[i] += dt / 6.0 * (v1[i] + 2.0 * v2[i] + 2.0 * v3[i] + v4[i]);
        }
    }
    (q, v)
}

fn start(model: &Model) -> (Vec<f64>, Vec<f64>) {
    let mut random = Random(3);
    (random.vector(model.nq(), 0.5), random.vector(model.dof(), 1.0))
}

#[test]
fn a_falling_chain_keeps_its_energy() -> Outcome {
    let model = hanging_chain()?;
    let mut data = model.data();
    let mut energy = |q: &[f64], v: &[f64]| {
        kinetic_energy(&model, &mut data, q, v) + potential_energy(&model, &mut data, q)
    };
    let (q0, v0) = start(&model);
    let before = energy(&q0, &v0);
    let (q, v) = fall(&model, q0.clone(), v0.clone(), 1e-3, 2000);
    let drift = (energy(&q, &v) - before).abs() / before.abs();
    assert!(drift < 1e-9, "drift {drift:e}");
    // the drift is the integrator's, of order four: half the step, at most a sixteenth of the error
    let (q, v) = fall(&model, q0.clone(), v0.clone(), 1e-2, 200);
    let coarse = (energy(&q, &v) - before).abs();
    let (q, v) = fall(&model, q0, v0, 5e-3, 400);
    let fine = (energy(&q, &v) - before).abs();
    assert!(coarse / fine > 12.0, "{coarse:e} against {fine:e}");
    Ok(())
}

#[test]
fn a_free_chain_keeps_its_momentum_without_gravity() -> Outcome {
    keeps_its_momentum(&free_chain([0.0; 3])?)?;
    keeps_its_momentum(&floating_chain()?)
}

fn keeps_its_momentum(model: &Model) -> Outcome {
    let mut data = model.data();
    let (q, v) = start(model);
    let before = momentum(model, &mut data, &q, &v);
    let (q, v) = fall(model, q, v, 1e-3, 1000);
    let after = momentum(model, &mut data, &q, &v);
    assert!((after.linear - before.linear).norm() < 1e-9 * before.linear.norm());
    assert!((after.angular - before.angular).norm() < 1e-9 * before.angular.norm());
    Ok(())
}

#[test]
fn the_centre_of_mass_of_a_free_chain_follows_a_parabola() -> Outcome {
    let gravity = [0.3, -0.2, -9.0];
    let model = free_chain(gravity)?;
    let mut data = model.data();
    let (q, v) = start(&model);
    let time = 0.5;
    let velocity = momentum(&model, &mut data, &q, &v).linear / model.mass();
    let expected = center_of_mass(&model, &mut data, &q)
        + velocity * time
        + Vector3::from(gravity) * (time * time / 2.0);
    let (q, _) = fall(&model, q, v, 1e-3, 500);
    let error = (center_of_mass(&model, &mut data, &q) - expected).norm();
    assert!(error < 1e-9, "{error:e}");
    Ok(())
}
