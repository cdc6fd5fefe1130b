//! One list of all that is to be known of a move.

use std::sync::Arc;

use crate::moves::arm::{robot, tool};
use crate::moves::lines::{BENT, request};
use blocksim_robotics::planner::{
    CartesianMove, Course, Orientation, Quantity, Reason, Scrutiny, Sequence, Severity, Step, Timing,
    inspect, review,
};

#[test]
fn a_corner_that_is_rounded_less_than_asked_is_noted_with_what_is_reached() {
    let robot = robot();
    let first =
        CartesianMove::plan(&robot, &request(&robot, [0.0, -0.1, 0.0], Orientation::Fixed, Timing::Sin2));
    let first = first.unwrap();
    let mut next = request(&robot, [0.0, 0.0, 0.0], Orientation::Fixed, Timing::Sin2);
    let end = first.positions(first.duration());
    let corner = tool(&robot, &end).translation;
    next.start = blocksim_robotics::planner::Start::Joints(end);
    next.target = corner + nalgebra::Vector3::new(0.0, 0.0, 0.1);
    let second = CartesianMove::plan(&robot, &next).unwrap();
    let half = 0.5 * first.duration().min(second.duration());
    // where the tool is half a move before its end
    let reached = (tool(&robot, &first.positions(first.duration() - half)).translation - corner).norm();
    let steps = vec![
        Step { course: Arc::new(first), zone: 0.2, wait: 0.0 },
        Step { course: Arc::new(second), zone: 0.0, wait: 0.0 },
    ];
    let joined = Sequence::join(&robot, steps).unwrap();
    let found = review(&robot, &joined, None, &Scrutiny::default(), None);
    let [note] = &found.all[..] else { panic!("{:?}", found.all) };
    assert_eq!((note.code, note.severity, note.limit), ("corner_shortened", Severity::Note, 0.2));
    assert!((note.worst - reached).abs() < 1e-3, "{} {reached}", note.worst);
    assert!(note.message.contains("of a zone of 200 mm"), "{}", note.message);
    assert!(found.passes());
    assert_eq!(note.spot.step, Some(1));
}

#[test]
fn a_zone_behind_the_last_move_is_no_silent_stop() {
    let robot = robot();
    let only =
        CartesianMove::plan(&robot, &request(&robot, [0.0, -0.1, 0.0], Orientation::Fixed, Timing::Sin2));
    let steps = vec![Step { course: Arc::new(only.unwrap()), zone: 0.03, wait: 0.0 }];
    let joined = Sequence::join(&robot, steps).unwrap();
    let found = review(&robot, &joined, None, &Scrutiny::default(), None);
    let [note] = &found.all[..] else { panic!("{:?}", found.all) };
    assert_eq!((note.code, note.severity, note.limit), ("zone_at_the_end", Severity::Note, 0.03));
    assert_eq!(note.message.split(',').next(), Some("the zone of 30 mm behind move 1 has no effect"));
    assert_eq!((note.spot.t, note.spot.step), (joined.duration(), Some(0)));
    assert!(found.passes());
}

#[test]
fn a_threshold_of_singular_poses_is_that_of_whoever_looks() {
    let robot = robot();
    let planned =
        CartesianMove::plan(&robot, &request(&robot, [0.1, -0.45, -0.35], Orientation::Fixed, Timing::Sin2))
            .unwrap();
    let margin = planned.narrowest().unwrap().margin;
    let at = |narrow: f64| {
        let scrutiny = Scrutiny { narrow, ..Scrutiny::at(500) };
        inspect(&robot, &planned, &scrutiny).violations.iter().any(|v| v.quantity == Quantity::Singularity)
    };
    assert!(!at(0.9 * margin) && at(1.1 * margin));
}

#[test]
fn ranges_that_are_stated_hold_at_both_ends() {
    let robot = robot();
    let with = |velocity: f64, acceleration: f64, resolution: f64| {
        let mut request = request(&robot, [0.0, -0.1, 0.0], Orientation::Fixed, Timing::Sin2);
        (request.speeds.velocity, request.speeds.acceleration) = (velocity, acceleration);
        request.resolution = resolution;
        CartesianMove::plan(&robot, &request)
    };
    assert!(with(0.1, 0.5, 0.001).is_ok() && with(1e-6, 1e-5, 0.001).is_ok());
    for (member, refused) in [
        ("velocity", with(1e-12, 0.5, 0.001)),
        ("acceleration", with(0.1, 1e-9, 0.001)),
        ("resolution", with(0.1, 0.5, 1e-9)),
        ("velocity", with(2.6, 0.5, 0.001)),
    ] {
        let error = refused.unwrap_err();
        assert_eq!(error.member, member);
        assert!(matches!(error.reason, Reason::OutOfRange { .. }), "{error}");
    }
}

#[test]
fn a_turn_on_the_spot_is_described_in_degrees() {
    let robot = robot();
    // Straight through a wrist that cannot: the turn would take axis 5 beyond what it can do.
    let at = tool(&robot, &BENT);
    let turned = blocksim_multibody::EulerZyx { alpha: 0.0, beta: 2.8, gamma: 0.0 }.rotation() * at.rotation;
    let mut request = request(&robot, [0.0, 0.0, 0.0], Orientation::Interpolated(turned), Timing::Sin2);
    request.target = at.translation;
    let text = match CartesianMove::plan(&robot, &request) {
        Err(error) => error.to_string(),
        Ok(planned) => {
            let found = inspect(&robot, &planned, &Scrutiny::default()).violations;
            found.iter().map(|v| v.to_string()).collect::<Vec<_>>().join("; ")
        }
    };
    assert!(text.contains("deg turned") && !text.contains("s = "), "{text}");
}
