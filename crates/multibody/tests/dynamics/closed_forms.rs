//! Small mechanisms whose equations fit on a line.

use crate::assert_close;
use blocksim_multibody::{
    Inertia, Joint, Model, ModelBuilder, Placement, STANDARD_GRAVITY as G, aba, bias, crba, mass_and_bias,
    rnea,
};
use std::error::Error;

type Outcome = Result<(), Box<dyn Error>>;

/// Swings about -y with its centre of mass at `com` below the pivot: q = 0 hangs, q > 0 swings to +x.
fn bar(mass: f64, com: f64, iyy: f64) -> Result<Inertia, Box<dyn Error>> {
    Ok(Inertia::from_moments(mass, [0.0, 0.0, -com], [iyy, iyy, 0.01 * iyy], [0.0; 3])?)
}

fn swing() -> Joint {
    Joint::revolute([0.0, -1.0, 0.0])
}

#[test]
fn a_physical_pendulum() -> Outcome {
    let (mass, com, iyy) = (3.0, 0.4, 0.25);
    let mut builder = ModelBuilder::new();
    builder.add_body(None, swing(), Placement::identity(), bar(mass, com, iyy)?)?;
    let model = builder.build();
    let mut data = model.data();
    for q in [-2.0, -0.3, 0.0, 0.5, 1.5] {
        let (mut m, mut h, mut a) = ([0.0], [0.0], [0.0]);
        mass_and_bias(&model, &mut data, &[q], &[1.7], &mut m, &mut h);
        assert_close(&m, &[iyy + mass * com * com], 1e-15);
        assert!((h[0] - mass * G * com * q.sin()).abs() < 1e-14);
        // with an actuator torque and a rotor of 0.1 kg m²
        aba(&model, &mut data, &[q], &[1.7], &[0.9], &[0.1], &mut a);
        let expected = (0.9 - mass * G * com * q.sin()) / (iyy + mass * com * com + 0.1);
        assert!((a[0] - expected).abs() < 1e-14);
    }
    Ok(())
}

#[test]
fn a_double_pendulum() -> Outcome {
    // lengths l, centres of mass c, masses m, inertias j; the second angle is relative to the first
    let (l1, c1, c2, m1, m2, j1, j2) = (0.7, 0.3, 0.45, 2.0, 1.3, 0.11, 0.07);
    let mut builder = ModelBuilder::new();
    let upper = builder.add_body(None, swing(), Placement::identity(), bar(m1, c1, j1)?)?;
    let elbow = Placement::from_translation([0.0, 0.0, -l1]);
    builder.add_body(Some(upper), swing(), elbow, bar(m2, c2, j2)?)?;
    let model = builder.build();
    let mut data = model.data();
    for (q, v) in [([0.4, -0.9], [1.1, 0.6]), ([2.5, 1.2], [-2.0, 3.0]), ([-1.0, 0.0], [0.0, -1.5])] {
        let (mut m, mut h) = ([0.0; 4], [0.0; 2]);
        crba(&model, &mut data, &q, &mut m);
        bias(&model, &mut data, &q, &v, &mut h);
        // Lagrange's equations of the planar double pendulum
        let (k, w) = (m2 * l1 * c2, m2 * l1 * c2 * q[1].sin());
        let m22 = j2 + m2 * c2 * c2;
        let m12 = m22 + k * q[1].cos();
        let m11 = j1 + m1 * c1 * c1 + m2 * l1 * l1 + m22 + 2.0 * k * q[1].cos();
        let g2 = m2 * G * c2 * (q[0] + q[1]).sin();
        let g1 = (m1 * c1 + m2 * l1) * G * q[0].sin() + g2;
        let expected = [-w * v[1] * (2.0 * v[0] + v[1]) + g1, w * v[0] * v[0] + g2];
        assert_close(&m, &[m11, m12, m12, m22], 1e-14);
        assert_close(&h, &expected, 1e-14);
    }
    Ok(())
}

/// A turntable about z that carries a bead on a radial rail.
fn bead_on_a_turntable(mass: f64, table: f64) -> Result<Model, Box<dyn Error>> {
    let mut builder = ModelBuilder::new();
    let disk = Inertia::from_moments(1.0, [0.0; 3], [0.5 * table, 0.5 * table, table], [0.0; 3])?;
    let turn = builder.add_body(None, Joint::revolute([0.0, 0.0, 1.0]), Placement::identity(), disk)?;
    let bead = Inertia::point(mass, [0.0; 3])?;
    builder.add_body(Some(turn), Joint::prismatic([2.0, 0.0, 0.0]), Placement::identity(), bead)?;
    Ok(builder.build())
}

#[test]
fn a_bead_on_a_turntable_feels_coriolis_and_centrifugal_forces() -> Outcome {
    let (mass, table) = (0.8, 0.35);
    let model = bead_on_a_turntable(mass, table)?;
    let mut data = model.data();
    let (r, w, dr) = (0.6, 3.0, -0.5);
    let (mut m, mut h) = ([0.0; 4], [0.0; 2]);
    mass_and_bias(&model, &mut data, &[0.9, r], &[w, dr], &mut m, &mut h);
    assert_close(&m, &[table + mass * r * r, 0.0, 0.0, mass], 1e-15);
    assert_close(&h, &[2.0 * mass * r * dr * w, -mass * r * w * w], 1e-15);
    Ok(())
}

#[test]
fn a_joint_transmits_the_weight_and_the_inertial_force_of_what_it_carries() -> Outcome {
    let (mass, table) = (0.8, 0.35);
    let model = bead_on_a_turntable(mass, table)?;
    let mut data = model.data();
    let bead = model.bodies().last().ok_or("no bead")?;
    let (r, w) = (0.6, 3.0);
    rnea(&model, &mut data, &[0.9, r], &[w, 0.0], &[0.0, 0.0], &mut [0.0; 2]);
    let force = data.joint_force(bead);
    assert_close(force.linear.as_slice(), &[-mass * r * w * w, 0.0, mass * G], 1e-15);
    assert!(force.angular.norm() < 1e-14);
    Ok(())
}

#[test]
fn a_model_without_bodies_has_nothing_to_compute() {
    let model = ModelBuilder::new().build();
    let mut data = model.data();
    assert_eq!(model.dof(), 0);
    rnea(&model, &mut data, &[], &[], &[], &mut []);
    mass_and_bias(&model, &mut data, &[], &[], &mut [], &mut []);
    aba(&model, &mut data, &[], &[], &[], &[], &mut []);
}
