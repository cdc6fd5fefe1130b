//! Bodies that turn in space, against closed forms.

use crate::assert_close;
use crate::conservation::fall;
use blocksim_multibody::{
    Inertia, Joint, Model, ModelBuilder, Placement, STANDARD_GRAVITY as G, aba, crba, home_positions,
    kinetic_energy, momentum, rnea,
};
use nalgebra::Vector3;
use std::error::Error;

type Outcome = Result<(), Box<dyn Error>>;

fn one_body(joints: &[Joint], inertia: Inertia, gravity: [f64; 3]) -> Result<Model, Box<dyn Error>> {
    let mut builder = ModelBuilder::new();
    builder.gravity(gravity);
    builder.add_chain(None, joints, Placement::identity(), inertia)?;
    Ok(builder.build())
}

#[test]
fn a_free_body_keeps_its_energy_and_its_angular_momentum() -> Outcome {
    let body = Inertia::from_moments(2.0, [0.1, -0.2, 0.05], [0.3, 0.5, 0.7], [0.02, -0.03, 0.05])?;
    let model = one_body(&Joint::free(), body, [0.0; 3])?;
    let mut data = model.data();
    let (q, v) = (home_positions(&model), vec![0.3, -0.2, 0.5, 4.0, 0.1, -0.2]);
    let (energy, before) = (kinetic_energy(&model, &mut data, &q, &v), momentum(&model, &mut data, &q, &v));
    let (q, v) = fall(&model, q, v, 1e-3, 5000);
    let (later, after) = (kinetic_energy(&model, &mut data, &q, &v), momentum(&model, &mut data, &q, &v));
    // the error of the integrator, of order four
    assert!((later / energy - 1.0).abs() < 1e-9, "{}", later / energy - 1.0);
    assert!((after.linear - before.linear).norm() < 1e-9 * before.linear.norm());
    assert!((after.angular - before.angular).norm() < 1e-9 * before.angular.norm());
    let length = q[3..].iter().map(|e| e * e).sum::<f64>().sqrt();
    assert!((length - 1.0).abs() < 1e-9, "{length}");
    Ok(())
}

#[test]
fn a_symmetric_body_nutates_as_euler_says() -> Outcome {
    // w1 = A cos(n t), w2 = A sin(n t) with n = w3 (I3 - I1) / I1
    let (i1, i3, spin, wobble) = (0.4, 0.7, 5.0, 0.8);
    let body = Inertia::from_moments(1.0, [0.0; 3], [i1, i1, i3], [0.0; 3])?;
    let model = one_body(&[Joint::Spherical], body, [0.0; 3])?;
    let (_, v) = fall(&model, vec![1.0, 0.0, 0.0, 0.0], vec![wobble, 0.0, spin], 1e-3, 2000);
    let angle: f64 = spin * (i3 - i1) / i1 * 2.0;
    let expected = [wobble * angle.cos(), wobble * angle.sin(), spin];
    assert_close(&v, &expected, 1e-10);
    Ok(())
}

#[test]
fn a_spinning_top_precesses_steadily() -> Outcome {
    // A top with its tip at the origin: mass m at a height l on its axis, I1 about the tip, I3 about the axis.
    let (m, l, i1, i3, tilt, spin) = (0.5, 0.12, 0.02, 0.004, 0.6_f64, 90.0);
    let about_com = i1 - m * l * l;
    let top = Inertia::from_moments(m, [0.0, 0.0, l], [about_com, about_com, i3], [0.0; 3])?;
    let model = one_body(&[Joint::Spherical], top, [0.0, 0.0, -G])?;
    // (I1 cos t) p^2 - I3 w3 p + m g l = 0 for the rate p of steady precession at a tilt t; the slow root.
    let (a, b, c) = (i1 * tilt.cos(), -i3 * spin, m * G * l);
    let precession = (-b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    // tilted about x of the world; the precession about z of the world, in the axes of the body
    let q = vec![(0.5 * tilt).cos(), (0.5 * tilt).sin(), 0.0, 0.0];
    let v = vec![0.0, precession * tilt.sin(), spin];
    let (q, _) = fall(&model, q, v, 2e-4, 5000);
    let axis = axis_of(&model, &q);
    // the axis starts at (0, -sin t, cos t) and turns about z
    let angle = precession * 1.0;
    let expected = Vector3::new(tilt.sin() * angle.sin(), -tilt.sin() * angle.cos(), tilt.cos());
    assert!((axis - expected).norm() < 1e-8, "{axis} is not {expected}");
    Ok(())
}

fn axis_of(model: &Model, q: &[f64]) -> Vector3<f64> {
    let mut data = model.data();
    blocksim_multibody::forward_kinematics(model, &mut data, q);
    model.bodies().last().map_or_else(Vector3::zeros, |body| data.placement(body).rotation.column(2).into())
}

#[test]
fn a_spherical_joint_about_one_axis_is_a_hinge() -> Outcome {
    let body = Inertia::from_moments(2.0, [0.1, -0.2, 0.05], [0.3, 0.5, 0.7], [0.02, -0.03, 0.05])?;
    let ball = one_body(&[Joint::Spherical], body, [0.0, 0.0, -G])?;
    let hinge = one_body(&[Joint::revolute([0.0, 1.0, 0.0])], body, [0.0, 0.0, -G])?;
    let (angle, w, a) = (0.7_f64, 1.3, -2.0);
    let (mut tau, mut expected) = ([0.0; 3], [0.0]);
    let q = [(0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0];
    rnea(&ball, &mut ball.data(), &q, &[0.0, w, 0.0], &[0.0, a, 0.0], &mut tau);
    rnea(&hinge, &mut hinge.data(), &[angle], &[w], &[a], &mut expected);
    assert!((tau[1] - expected[0]).abs() < 1e-14);
    Ok(())
}

#[test]
fn a_free_body_falls_and_a_cylinder_slides_and_turns() -> Outcome {
    let body = Inertia::from_moments(2.0, [0.0; 3], [0.3, 0.5, 0.7], [0.0; 3])?;
    let model = one_body(&Joint::free(), body, [0.0, 0.0, -G])?;
    let mut a = [0.0; 6];
    let tau = [4.0, 0.0, 0.0, 0.0, 0.0, 1.4];
    let q = [1.0, 2.0, 3.0, 0.4, 0.1, -0.3, 0.2];
    aba(&model, &mut model.data(), &q, &[0.0; 6], &tau, &[], &mut a);
    assert_close(&a, &[2.0, 0.0, -G, 0.0, 0.0, 2.0], 1e-15);
    let model = one_body(&Joint::cylindrical([0.0, 0.0, 1.0]), body, [0.0; 3])?;
    let mut m = [0.0; 4];
    crba(&model, &mut model.data(), &[0.3, 0.4], &mut m);
    assert_close(&m, &[2.0, 0.0, 0.0, 0.7], 1e-15);
    Ok(())
}

#[test]
fn a_chain_of_joints_is_the_same_as_its_joints_one_by_one() -> Outcome {
    let body = Inertia::from_moments(2.0, [0.1, -0.2, 0.05], [0.3, 0.5, 0.7], [0.02, -0.03, 0.05])?;
    let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let at = Placement::from_rpy([0.3, 0.0, 0.1], [0.4, -0.2, 1.0]);
    let (mut chain, mut single) = (ModelBuilder::new(), ModelBuilder::new());
    chain.add_chain(None, &Joint::universal(x, y), at, body)?;
    let fork = single.add_body(None, Joint::revolute(x), at, Inertia::zero())?;
    single.add_body(Some(fork), Joint::revolute(y), Placement::identity(), body)?;
    let (chain, single) = (chain.build(), single.build());
    let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
    aba(&chain, &mut chain.data(), &[0.4, -0.7], &[1.0, 2.0], &[0.1, 0.2], &[], &mut a);
    aba(&single, &mut single.data(), &[0.4, -0.7], &[1.0, 2.0], &[0.1, 0.2], &[], &mut b);
    assert_eq!(a, b);
    Ok(())
}
