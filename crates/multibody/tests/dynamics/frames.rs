//! Frames of a robot, their Jacobians and Denavit-Hartenberg parameters.

use crate::arm;
use crate::trees::Random;
use blocksim_multibody::{
    BodyId, Data, DhError, EulerZyx, Frame, Inertia, Joint, Model, ModelBuilder, Placement,
    denavit_hartenberg, forward_kinematics, frame_jacobian, relative_jacobian, rotation_vector,
};
use nalgebra::{Matrix3, Vector3};
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI};

type Outcome = Result<(), Box<dyn Error>>;

/// The flange as the maker draws it: z out of it, x down at home.
fn flange(model: &Model) -> Result<Frame, &'static str> {
    let last = model.bodies().last().ok_or("no flange")?;
    Ok(Frame::of(last).at(Placement::from_rpy([0.0; 3], [0.0, FRAC_PI_2, 0.0])))
}

/// Tool centre point of the stand-in gun: origin in the flange, turned about y.
fn tool() -> Placement {
    Placement::from_rpy([0.1195, 0.0, 0.352], [0.0, 0.945973, 0.0])
}

fn apart(a: &Placement, b: &Placement) -> f64 {
    (a.rotation - b.rotation).abs().max().max((a.translation - b.translation).amax())
}

#[test]
fn flange_and_tool_at_home_are_where_the_data_sheet_draws_them() -> Outcome {
    let model = arm::bare()?;
    let flange = flange(&model)?;
    let mut data = model.data();
    forward_kinematics(&model, &mut data, &[0.0; 6]);
    let home = Placement {
        rotation: Matrix3::new(0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0),
        translation: Vector3::new(1.030, 0.0, 1.460),
    };
    assert!(apart(&flange.in_world(&data), &home) < 1e-15);
    let angles = EulerZyx::from_rotation(&flange.in_world(&data).rotation);
    assert!(angles.is_locked() && (angles.beta - FRAC_PI_2).abs() < 1e-15);
    let tip = flange.at(tool()).in_world(&data);
    assert!((tip.translation - Vector3::new(1.382, 0.0, 1.3405)).norm() < 1e-15);
    // on a pedestal of half a metre, seen from a work object
    let base = Frame::ground().at(Placement::from_translation([0.0, 0.0, -0.5]));
    let object = base.at(Placement::from_translation([1.0, 0.2, 0.0]));
    let seen = flange.at(tool()).relative_to(&object, &data).translation;
    assert!((seen - Vector3::new(0.382, -0.2, 1.8405)).norm() < 1e-15);
    Ok(())
}

#[test]
fn the_flange_turns_about_axis_one_by_its_angle() -> Outcome {
    let model = arm::bare()?;
    let flange = flange(&model)?;
    let mut data = model.data();
    for q1 in [-3.0, -0.7, 0.4, 2.0] {
        forward_kinematics(&model, &mut data, &[q1, 0.3, -0.2, 0.0, 0.5, 0.0]);
        let p = flange.in_world(&data).translation;
        // planar arm: upper arm, forearm with its offset, hand
        let (a, b, c) = (0.3_f64, 0.3_f64 - 0.2, 0.3_f64 - 0.2 + 0.5);
        let r = 0.15 + 0.9 * a.sin() + 0.115 * b.sin() + 0.795 * b.cos() + 0.085 * c.cos();
        let z = 0.445 + 0.9 * a.cos() + 0.115 * b.cos() - 0.795 * b.sin() - 0.085 * c.sin();
        assert!((p - Vector3::new(r * q1.cos(), r * q1.sin(), z)).norm() < 1e-15);
    }
    Ok(())
}

#[test]
fn the_jacobian_of_a_frame_is_its_motion() -> Outcome {
    let model = arm::bare()?;
    let tool = flange(&model)?.at(tool());
    let elbow =
        Frame::of(model.bodies().nth(2).ok_or("no elbow")?).at(Placement::from_rpy([0.1; 3], [0.3; 3]));
    let ground = Frame::ground().at(Placement::from_rpy([0.4, 0.1, 0.0], [0.2, -0.4, 1.0]));
    let mut random = Random(7);
    for _ in 0..50 {
        let (q, v) = (random.vector(6, 2.0), random.vector(6, 1.0));
        for reference in [Frame::ground(), ground, elbow] {
            let at = |step: f64| {
                let moved: Vec<f64> = q.iter().zip(&v).map(|(q, v)| q + step * v).collect();
                let mut data = model.data();
                forward_kinematics(&model, &mut data, &moved);
                tool.relative_to(&reference, &data)
            };
            let step = 1e-6;
            let (ahead, behind) = (at(step), at(-step));
            let linear = (ahead.translation - behind.translation) / (2.0 * step);
            let angular = rotation_vector(&(ahead.rotation * behind.rotation.transpose())) / (2.0 * step);
            let mut data = model.data();
            forward_kinematics(&model, &mut data, &q);
            let mut j = [0.0; 36];
            relative_jacobian(&model, &data, &tool, &reference, &mut j);
            let expected = [angular.x, angular.y, angular.z, linear.x, linear.y, linear.z];
            assert_motion(&j, &v, &expected);
            if reference.body.is_none() {
                frame_jacobian(&model, &data, &tool, &reference, &mut j);
                assert_motion(&j, &v, &expected);
            }
        }
    }
    Ok(())
}

fn assert_motion(j: &[f64; 36], v: &[f64], expected: &[f64; 6]) {
    for row in 0..6 {
        let got: f64 = (0..6).map(|k| j[6 * row + k] * v[k]).sum();
        assert!((got - expected[row]).abs() < 1e-8, "row {row}: {got} is not {}", expected[row]);
    }
}

#[test]
fn the_jacobian_in_tool_axes_is_the_velocity_of_the_body_there() -> Outcome {
    let model = arm::bare()?;
    let last = model.bodies().last().ok_or("no flange")?;
    let (q, v) = ([0.3, -0.4, 0.5, 0.6, -0.7, 0.8], [1.0, -0.9, 0.8, 2.0, -1.5, 3.0]);
    let mut data = model.data();
    blocksim_multibody::forward_velocities(&model, &mut data, &q, &v);
    let motion = *data.velocity(last);
    let mut j = [0.0; 36];
    frame_jacobian(&model, &data, &Frame::of(last), &Frame::of(last), &mut j);
    let [a, l] = [motion.angular, motion.linear];
    for (row, expected) in [a.x, a.y, a.z, l.x, l.y, l.z].into_iter().enumerate() {
        let got: f64 = (0..6).map(|k| j[6 * row + k] * v[k]).sum();
        assert!((got - expected).abs() < 1e-14);
    }
    Ok(())
}

#[test]
fn the_irb_2600_has_the_denavit_hartenberg_table_of_its_drawing() -> Outcome {
    let model = arm::bare()?;
    let table = denavit_hartenberg(&model, &Frame::ground(), &flange(&model)?)?;
    let h = FRAC_PI_2;
    let expected = [
        (0.0, 0.445, 0.150, -h),
        (-h, 0.0, 0.900, 0.0),
        (0.0, 0.0, 0.115, -h),
        (0.0, 0.795, 0.0, h),
        (0.0, 0.0, 0.0, -h),
        (PI, 0.085, 0.0, 0.0),
    ];
    for (row, (theta, d, a, alpha)) in table.rows.iter().zip(expected) {
        let error = [row.theta - theta, row.d - d, row.a - a, row.alpha - alpha];
        assert!(error.iter().all(|e| e.abs() < 1e-15), "{row:?}");
    }
    assert!(apart(&table.base, &Placement::identity()) < 1e-15);
    assert!(apart(&table.end, &Placement::identity()) < 1e-15);
    Ok(())
}

#[test]
fn denavit_hartenberg_parameters_place_any_chain_of_axes() -> Outcome {
    let mut random = Random(11);
    for trial in 0..300 {
        let (model, last) = chain(&mut random, trial)?;
        let base = Frame::ground().at(random_placement(&mut random, trial % 2 == 0));
        let end = Frame::of(last).at(random_placement(&mut random, trial % 3 == 0));
        let table = denavit_hartenberg(&model, &base, &end)?;
        let mut data: Data = model.data();
        for _ in 0..5 {
            let q = random.vector(model.dof(), 2.0);
            forward_kinematics(&model, &mut data, &q);
            let error = apart(&table.placement(&q), &end.relative_to(&base, &data));
            assert!(error < 1e-12, "trial {trial}: {error:e} {table:?}");
        }
        assert!(table.rows.iter().all(|row| row.a >= -1e-12));
    }
    Ok(())
}

#[test]
fn a_chain_without_denavit_hartenberg_parameters_is_named() -> Outcome {
    let mut builder = ModelBuilder::new();
    let ball = builder.add_body(None, Joint::Spherical, Placement::identity(), Inertia::zero())?;
    let model = builder.build();
    let of = |base: &Frame, end: &Frame| denavit_hartenberg(&model, base, end);
    assert_eq!(of(&Frame::ground(), &Frame::of(ball)), Err(DhError::Spherical { body: 0 }));
    assert_eq!(of(&Frame::of(ball), &Frame::of(ball)), Err(DhError::BaseMoves));
    assert_eq!(of(&Frame::ground(), &Frame::ground()), Err(DhError::NoJoint));
    Ok(())
}

fn random_placement(random: &mut Random, identity: bool) -> Placement {
    let x = random.vector(6, 1.0);
    let p = Placement::from_rpy([x[0], x[1], x[2]], [x[3], x[4], x[5]]);
    if identity { Placement::identity() } else { p }
}

/// Five axes: skew ones in odd trials, parallel and meeting ones in even trials.
fn chain(random: &mut Random, trial: usize) -> Result<(Model, BodyId), Box<dyn Error>> {
    let mut builder = ModelBuilder::new();
    let mut last = None;
    for _ in 0..5 {
        let x = random.vector(5, 1.0);
        let axis = match trial % 2 {
            0 => {
                let mut axis = [0.0; 3];
                axis[(x[0].abs() * 2.999) as usize] = x[1].signum();
                axis
            }
            _ => [x[0], x[1], x[2]],
        };
        let place = match trial % 2 {
            0 => Placement::from_translation([(2.0 * x[2]).trunc() / 2.0, (2.0 * x[3]).trunc() / 2.0, 0.0]),
            _ => random_placement(random, false),
        };
        let joint = if x[4] > 0.6 { Joint::prismatic(axis) } else { Joint::revolute(axis) };
        last = Some(builder.add_body(last, joint, place, Inertia::zero())?);
    }
    Ok((builder.build(), last.ok_or("no axis")?))
}
