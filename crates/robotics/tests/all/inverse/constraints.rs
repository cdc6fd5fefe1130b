//! Each constraint of the general solver.

use crate::inverse::Outcome;
use crate::inverse::arms::{Random, flange, irb2600, ranges, torch};
use blocksim_multibody::{
    EulerZyx, Frame, Inertia, Joint, ModelBuilder, Placement, forward_kinematics, rotation_vector,
};
use blocksim_robotics::kinematics::{Constraint, JointRange, Options, SolveError, Solved, Solver, Status};
use nalgebra::{Matrix3, Vector3};
use std::error::Error;

const WORLD: Placement = Placement {
    rotation: Matrix3::new(1., 0., 0., 0., 1., 0., 0., 0., 1.),
    translation: Vector3::new(0., 0., 0.),
};

/// An outcome with the places of tool and elbow.
type Found = (Solved, Placement, Placement);

/// Solves from 20 random positions.
fn solve(wish: impl Fn(Frame, Frame) -> Vec<Constraint>) -> Result<Vec<Found>, Box<dyn Error>> {
    let (model, last) = irb2600()?;
    let tool = flange(last).at(torch());
    let elbow = Frame::of(model.bodies().nth(2).ok_or("no elbow")?);
    let (ranges, mut random, mut data) = (ranges(), Random(20), model.data());
    let mut solver = Solver::new(&model, &ranges)?;
    let mut outcomes = Vec::new();
    for _ in 0..20 {
        let solved = solver.solve(&wish(tool, elbow), &random.pose(&ranges), &Options::default())?;
        forward_kinematics(&model, &mut data, &solved.q);
        assert_eq!(solved.status, Status::Success, "{solved:?}");
        assert!(solved.reports.iter().all(|report| report.satisfied));
        outcomes.push((solved, tool.in_world(&data), elbow.in_world(&data)));
    }
    Ok(outcomes)
}

#[test]
fn an_orientation_is_reached_within_its_tolerance() -> Outcome {
    let target = EulerZyx { alpha: 0.4, beta: 2.0, gamma: -0.3 }.rotation();
    for tolerance in [0.0, 0.1] {
        let outcomes = solve(|frame, _| {
            let reference = Frame::ground();
            vec![Constraint::Orientation { frame, reference, target, tolerance, weight: 1.0 }]
        })?;
        for (_, tool, _) in outcomes {
            let angle = rotation_vector(&(tool.rotation * target.transpose())).norm();
            assert!(angle <= tolerance + 2e-8, "{angle}");
        }
    }
    Ok(())
}

#[test]
fn a_tool_aims_from_a_box_at_a_point() -> Outcome {
    let point = Vector3::new(2.0, 0.3, 0.2);
    let corner = Placement::from_rpy([0.9, -0.4, 0.8], [0.0, 0.0, 0.5]);
    let (lower, upper) = (Vector3::new(-0.1, -0.1, f64::NEG_INFINITY), Vector3::new(0.1, 0.1, 0.2));
    let outcomes = solve(|frame, _| {
        let reference = Frame::ground();
        let weights = Vector3::repeat(1.0);
        let inside = Constraint::CartesianBounds { frame, reference, target: corner, lower, upper, weights };
        vec![inside, Constraint::aiming(frame, Frame::ground(), point)]
    })?;
    for (_, tool, _) in outcomes {
        let x = corner.inverse().point(&tool.translation);
        assert!((0..3).all(|i| x[i] >= lower[i] - 1e-8 && x[i] <= upper[i] + 1e-8), "{x}");
        let way = (point - tool.translation).normalize();
        assert!((tool.rotation.column(2) - way).norm() < 2e-8);
    }
    Ok(())
}

#[test]
fn a_target_may_be_written_in_a_frame_that_moves() -> Outcome {
    // the tool half a metre from the elbow, at most 0.9 m from the ground's origin
    let outcomes = solve(|frame, reference| {
        let target = Vector3::new(0.6, 0.1, 0.3);
        let ground = Frame::ground().at(Placement::from_translation([0.9, 0.0, 0.9]));
        vec![
            Constraint::Position { frame, reference, target, tolerance: 0.2, weight: 2.0 },
            Constraint::DistanceBounds { frame, reference: ground, lower: 0.3, upper: 0.5, weight: 1.0 },
        ]
    })?;
    for (_, tool, elbow) in outcomes {
        let seen = elbow.inverse().point(&tool.translation);
        assert!((seen - Vector3::new(0.6, 0.1, 0.3)).norm() < 0.2 + 2e-8);
        let distance = (tool.translation - Vector3::new(0.9, 0.0, 0.9)).norm();
        assert!((0.3 - 2e-8..0.5 + 2e-8).contains(&distance), "{distance}");
    }
    Ok(())
}

#[test]
fn joint_bounds_are_kept_and_weights_decide_where_wishes_collide() -> Outcome {
    let mut builder = ModelBuilder::new();
    let slide = builder.add_body(None, Joint::prismatic([1.0, 0.0, 0.0]), WORLD, Inertia::zero())?;
    let model = builder.build();
    let mut solver = Solver::new(&model, &[JointRange::FREE])?;
    let bounds =
        |weight| Constraint::JointBounds { lower: vec![-1.0], upper: vec![1.0], weights: vec![weight] };
    let wish = [Constraint::position(Frame::of(slide), Frame::ground(), [2.0, 0.0, 0.0]), bounds(3.0)];
    let options = Options { restarts: 0, iterations: 200, ..Options::default() };
    let solved = solver.solve(&wish, &[0.0], &options)?;
    // (2 - q)² + 3 (q - 1)² is least at 5/4
    assert!((solved.q[0] - 1.25).abs() < 1e-6, "{solved:?}");
    assert_eq!(solved.status, Status::BestAvailable);
    assert!((solved.reports[0].violation[0] - 0.75).abs() < 1e-6);
    assert!((solved.reports[1].violation[0] - 0.25).abs() < 1e-6);
    // ranges always hold
    let mut ranged = Solver::new(&model, &[JointRange { lower: -1.0, upper: 1.0 }])?;
    assert_eq!(ranged.solve(&wish, &[5.0], &options)?.q, [1.0]);
    Ok(())
}

#[test]
fn bad_questions_are_refused_with_a_reason() -> Outcome {
    let (model, last) = irb2600()?;
    let (frame, reference) = (Frame::of(last), Frame::ground());
    let mut solver = Solver::new(&model, &ranges())?;
    let mut refuse = |constraint: Constraint| {
        let outcome = solver.solve(&[constraint], &[0.0; 6], &Options::default());
        outcome.map_err(|error| error.to_string()).map(|_| ()).expect_err("it is bad")
    };
    let cases = [
        (Constraint::position(frame, reference, [f64::NAN, 0.0, 0.0]), "the target is not finite"),
        (
            Constraint::Position { frame, reference, target: Vector3::x(), tolerance: -1.0, weight: 1.0 },
            "a tolerance must be zero or a positive number",
        ),
        (
            Constraint::Position { frame, reference, target: Vector3::x(), tolerance: 0.0, weight: f64::NAN },
            "a weight must be zero or a positive number",
        ),
        (
            Constraint::pose(frame, reference, Placement { rotation: Matrix3::zeros(), ..WORLD }),
            "the rotation is not orthonormal",
        ),
        (
            Constraint::DistanceBounds { frame, reference, lower: 2.0, upper: 1.0, weight: 1.0 },
            "bounds 1 are not in order; give the lower bound first",
        ),
        (
            Constraint::JointBounds { lower: vec![0.0; 5], upper: vec![0.0; 6], weights: vec![1.0; 6] },
            "lower bounds: 5 entries for 6 joints",
        ),
    ];
    for (constraint, expected) in cases {
        let message = refuse(constraint);
        assert!(message.contains(expected), "{message}");
    }
    let length = solver.solve(&[], &[0.0; 5], &Options::default()).map(|_| ());
    assert_eq!(length, Err(SolveError::WrongLength { list: "start", given: 5, joints: 6 }));
    let nan = solver.solve(&[], &[f64::NAN; 6], &Options::default()).map(|_| ());
    assert_eq!(nan, Err(SolveError::NotFinite { what: "a position", constraint: None }));
    let mut crossed = ranges();
    crossed[3] = JointRange { lower: 1.0, upper: f64::NAN };
    let crossed = Solver::new(&model, &crossed).map(|_| ());
    assert_eq!(crossed, Err(SolveError::BoundsCrossed { constraint: None, entry: 3 }));
    assert_eq!(Solver::new(&ModelBuilder::new().build(), &[]).map(|_| ()), Err(SolveError::NoJoint));
    Ok(())
}
