//! One algorithm against another on random trees.

use crate::assert_close;
use crate::trees::forest;
use blocksim_multibody::{
    Force, PARAMETERS_PER_BODY, aba, add_force, bias, crba, jacobian, kinetic_energy, mass_and_bias,
    move_positions, potential_energy, regressor, rnea,
};
use nalgebra::{DMatrix, DVector, Vector3};

#[test]
fn inverse_dynamics_is_mass_times_acceleration_plus_bias() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v, a) = (random.positions(&model), random.vector(n, 2.0), random.vector(n, 5.0));
        let (mut m, mut h, mut tau) = (vec![0.0; n * n], vec![0.0; n], vec![0.0; n]);
        crba(&model, &mut data, &q, &mut m);
        bias(&model, &mut data, &q, &v, &mut h);
        rnea(&model, &mut data, &q, &v, &a, &mut tau);
        let expected = DMatrix::from_row_slice(n, n, &m) * DVector::from_vec(a) + DVector::from_vec(h);
        assert_close(&tau, expected.as_slice(), 1e-12);
    }
}

#[test]
fn the_regressor_times_the_inertial_parameters_is_inverse_dynamics() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v, a) = (random.positions(&model), random.vector(n, 2.0), random.vector(n, 5.0));
        let columns = PARAMETERS_PER_BODY * model.bodies().count();
        let (mut y, mut tau) = (vec![0.0; n * columns], vec![0.0; n]);
        regressor(&model, &mut data, &q, &v, &a, &mut y);
        rnea(&model, &mut data, &q, &v, &a, &mut tau);
        let got = DMatrix::from_row_slice(n, columns, &y) * DVector::from_vec(model.inertial_parameters());
        assert_close(got.as_slice(), &tau, 1e-12);
    }
}

#[test]
fn columns_of_the_mass_matrix_are_torques_for_unit_accelerations() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, rest) = (random.positions(&model), vec![0.0; n]);
        let (mut m, mut weight) = (vec![0.0; n * n], vec![0.0; n]);
        crba(&model, &mut data, &q, &mut m);
        bias(&model, &mut data, &q, &rest, &mut weight);
        let mut columns = vec![0.0; n * n];
        for (j, column) in columns.chunks_mut(n).enumerate() {
            let mut unit = rest.clone();
            unit[j] = 1.0;
            rnea(&model, &mut data, &q, &rest, &unit, column);
            column.iter_mut().zip(&weight).for_each(|(x, w)| *x -= w);
        }
        assert_close(&columns, &m, 1e-12);
    }
}

#[test]
fn the_shared_sweep_gives_the_mass_matrix_and_the_bias() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v) = (random.positions(&model), random.vector(n, 2.0));
        let (mut m, mut h) = (vec![0.0; n * n], vec![0.0; n]);
        let (mut expected_m, mut expected_h) = (vec![0.0; n * n], vec![0.0; n]);
        mass_and_bias(&model, &mut data, &q, &v, &mut m, &mut h);
        crba(&model, &mut data, &q, &mut expected_m);
        bias(&model, &mut data, &q, &v, &mut expected_h);
        assert_close(&m, &expected_m, 1e-14);
        assert_close(&h, &expected_h, 1e-13);
    }
}

#[test]
fn forward_dynamics_inverts_inverse_dynamics() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v, tau) = (random.positions(&model), random.vector(n, 2.0), random.vector(n, 50.0));
        let (mut a, mut back) = (vec![0.0; n], vec![0.0; n]);
        aba(&model, &mut data, &q, &v, &tau, &[], &mut a);
        rnea(&model, &mut data, &q, &v, &a, &mut back);
        assert_close(&back, &tau, 1e-12);
    }
}

#[test]
fn reflected_inertia_adds_to_the_diagonal_of_the_mass_matrix() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v, tau) = (random.positions(&model), random.vector(n, 2.0), random.vector(n, 50.0));
        let armature: Vec<f64> = random.vector(n, 10.0).iter().map(|x| x.abs()).collect();
        let (mut a, mut back) = (vec![0.0; n], vec![0.0; n]);
        aba(&model, &mut data, &q, &v, &tau, &armature, &mut a);
        rnea(&model, &mut data, &q, &v, &a, &mut back);
        for i in 0..n {
            back[i] += armature[i] * a[i];
        }
        assert_close(&back, &tau, 1e-12);
    }
}

#[test]
fn the_mass_matrix_is_symmetric_and_positive_definite_and_gives_the_kinetic_energy() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v) = (random.positions(&model), random.vector(n, 2.0));
        let mut m = vec![0.0; n * n];
        crba(&model, &mut data, &q, &mut m);
        let m = DMatrix::from_row_slice(n, n, &m);
        assert_eq!(m, m.transpose());
        assert!(m.clone().cholesky().is_some());
        let speed = DVector::from_column_slice(&v);
        let expected = 0.5 * speed.dot(&(m * &speed));
        assert_close(&[kinetic_energy(&model, &mut data, &q, &v)], &[expected], 1e-13);
    }
}

#[test]
fn gravity_torques_are_the_slope_of_the_potential_energy() {
    const STEP: f64 = 1e-5;
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let q = random.positions(&model);
        let mut h = vec![0.0; n];
        bias(&model, &mut data, &q, &vec![0.0; n], &mut h);
        let mut energy_at = |i: usize, step: f64| {
            let (mut moved, mut along) = (q.clone(), vec![0.0; n]);
            along[i] = step;
            move_positions(&model, &mut moved, &along);
            potential_energy(&model, &mut data, &moved)
        };
        let slope: Vec<f64> =
            (0..n).map(|i| (energy_at(i, STEP) - energy_at(i, -STEP)) / (2.0 * STEP)).collect();
        // a central difference of this step errs by about 1e-10 of the energy, seldom small against h
        assert_close(&slope, &h, 1e-8);
    }
}

#[test]
fn a_force_from_outside_is_worth_its_power_at_every_joint() {
    let point = Vector3::new(0.2, -0.5, 0.3);
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let q = random.positions(&model);
        let force = Force { angular: random.triple().into(), linear: random.triple().into() };
        for body in model.bodies() {
            let (mut columns, mut tau) = (vec![0.0; 6 * n], vec![0.0; n]);
            jacobian(&model, &mut data, &q, body, &point, &mut columns);
            add_force(&model, &data, body, &point, &force, &mut tau);
            let f: Vec<f64> = force.angular.iter().chain(&force.linear).copied().collect();
            let expected = DMatrix::from_row_slice(6, n, &columns).transpose() * DVector::from_vec(f);
            assert!((DVector::from_vec(tau) - &expected).amax() < 1e-13 * (1.0 + expected.amax()));
        }
    }
}
