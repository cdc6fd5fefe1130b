//! Kinematics against finite differences on random trees.

use crate::assert_close;
use crate::trees::forest;
use blocksim_multibody::{
    BodyId, Model, bias_accelerations, forward_accelerations, forward_kinematics, forward_velocities,
    jacobian, move_positions, positions_derivative,
};
use nalgebra::{Matrix3, Vector3};

const POINT: Vector3<f64> = Vector3::new(0.2, -0.5, 0.3);

/// Rotation and position of `POINT` on `body`.
fn pose(model: &Model, q: &[f64], body: BodyId) -> (Matrix3<f64>, Vector3<f64>) {
    let mut data = model.data();
    forward_kinematics(model, &mut data, q);
    (data.placement(body).rotation, data.placement(body).point(&POINT))
}

/// ω of `Ṙ Rᵀ = [ω]×`.
fn rate(dr: &Matrix3<f64>, r: &Matrix3<f64>) -> [f64; 3] {
    let s = dr * r.transpose();
    [s.m32 - s.m23, s.m13 - s.m31, s.m21 - s.m12].map(|x| 0.5 * x)
}

#[test]
fn the_jacobian_is_the_slope_of_the_placement() {
    const STEP: f64 = 1e-5;
    for (model, mut random) in forest() {
        let n = model.dof();
        let q = random.positions(&model);
        for body in model.bodies() {
            let mut j = vec![0.0; 6 * n];
            jacobian(&model, &mut model.data(), &q, body, &POINT, &mut j);
            let (r, _) = pose(&model, &q, body);
            let mut slopes = vec![0.0; 6 * n];
            for i in 0..n {
                let moved = |step: f64| {
                    let (mut q, mut along) = (q.clone(), vec![0.0; n]);
                    along[i] = step;
                    move_positions(&model, &mut q, &along);
                    pose(&model, &q, body)
                };
                let ((r1, p1), (r0, p0)) = (moved(STEP), moved(-STEP));
                let angular = rate(&((r1 - r0) / (2.0 * STEP)), &r);
                let linear = (p1 - p0) / (2.0 * STEP);
                for row in 0..3 {
                    slopes[row * n + i] = angular[row];
                    slopes[(row + 3) * n + i] = linear[row];
                }
            }
            assert_close(&j, &slopes, 1e-9);
        }
    }
}

#[test]
fn velocities_are_the_jacobian_times_the_joint_speeds() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v) = (random.positions(&model), random.vector(n, 2.0));
        for body in model.bodies() {
            let mut j = vec![0.0; 6 * n];
            jacobian(&model, &mut data, &q, body, &POINT, &mut j);
            let expected: Vec<f64> =
                j.chunks(n).map(|row| row.iter().zip(&v).map(|(j, v)| j * v).sum()).collect();
            forward_velocities(&model, &mut data, &q, &v);
            let m = data.world_velocity(body, &POINT);
            let got: Vec<f64> = m.angular.iter().chain(&m.linear).copied().collect();
            assert_close(&got, &expected, 1e-13);
        }
    }
}

#[test]
fn accelerations_are_second_differences_of_the_position() {
    const STEP: f64 = 1e-4;
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v, a) = (random.positions(&model), random.vector(n, 1.0), random.vector(n, 1.0));
        let at = |t: f64, body| {
            let step: Vec<f64> = (0..n).map(|i| t * (v[i] + 0.5 * t * a[i])).collect();
            let mut q = q.clone();
            move_positions(&model, &mut q, &step);
            pose(&model, &q, body).1
        };
        forward_accelerations(&model, &mut data, &q, &v, &a);
        for body in model.bodies() {
            let second = (at(STEP, body) - at(0.0, body) * 2.0 + at(-STEP, body)) / (STEP * STEP);
            let got = data.placement(body).rotation * data.point_acceleration(body, &POINT);
            // rounding: 1e-15 / STEP² = 1e-7 against accelerations of about one
            assert!((got - second).norm() < 1e-5 * (1.0 + second.norm()), "{got} is not {second}");
        }
    }
}

#[test]
fn accelerations_are_the_jacobian_times_joint_accelerations_plus_the_bias() {
    for (model, mut random) in forest() {
        let n = model.dof();
        let mut data = model.data();
        let (q, v, a) = (random.positions(&model), random.vector(n, 2.0), random.vector(n, 5.0));
        for body in model.bodies() {
            let mut j = vec![0.0; 6 * n];
            jacobian(&model, &mut data, &q, body, &POINT, &mut j);
            bias_accelerations(&model, &mut data, &q, &v);
            let bias = data.world_acceleration(body, &POINT);
            forward_accelerations(&model, &mut data, &q, &v, &a);
            let whole = data.world_acceleration(body, &POINT);
            let expected: Vec<f64> = j
                .chunks(n)
                .zip(bias.angular.iter().chain(&bias.linear))
                .map(|(row, bias)| bias + row.iter().zip(&a).map(|(j, a)| j * a).sum::<f64>())
                .collect();
            let got: Vec<f64> = whole.angular.iter().chain(&whole.linear).copied().collect();
            assert_close(&got, &expected, 1e-12);
        }
    }
}

#[test]
fn positions_follow_speeds_as_a_finite_step_does() {
    const STEP: f64 = 1e-6;
    for (model, mut random) in forest() {
        let n = model.dof();
        let v = random.vector(n, 2.0);
        let mut q = random.positions(&model);
        // unit quaternions, so that the step does not change lengths
        move_positions(&model, &mut q, &vec![0.0; n]);
        let mut dq = vec![0.0; model.nq()];
        positions_derivative(&model, &q, &v, &mut dq);
        let at = |t: f64| {
            let mut q = q.clone();
            move_positions(&model, &mut q, &v.iter().map(|v| t * v).collect::<Vec<_>>());
            q
        };
        let slopes: Vec<f64> = at(STEP).iter().zip(&at(-STEP)).map(|(a, b)| (a - b) / (2.0 * STEP)).collect();
        assert_close(&dq, &slopes, 1e-8);
    }
}
