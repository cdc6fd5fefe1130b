use std::sync::Arc;

use crate::moves::arm::{robot, tool};
use crate::moves::lines::{BENT, request};
use blocksim_robotics::motion::{JointMove, JointMoveRequest, Synchronisation};
use blocksim_robotics::planner::{
    CartesianMove, Course, Orientation, Scrutiny, Sequence, SequenceError, Start, Step, Timing, inspect,
};
use blocksim_robotics::robot::Robot;
use nalgebra::Vector3;

/// A joint move, a line, an arc.
fn steps(robot: &Robot, zone: f64) -> Vec<Step> {
    let to_line = JointMoveRequest {
        start: vec![0.3, 0.0, 0.0, 0.1, 0.5, 0.0],
        target: BENT.to_vec(),
        velocity: 0.18,
        acceleration: 0.5,
        rule: Synchronisation::Feasible,
    };
    let joint = JointMove::plan(&to_line, &robot.limits()).unwrap();
    let mut line = request(robot, [0.0, -0.4, 0.0], Orientation::Fixed, Timing::Sin2);
    line.speeds.acceleration = 0.15;
    let line = CartesianMove::plan(robot, &line).unwrap();
    let corner = line.positions(line.duration());
    let from = tool(robot, &corner).translation;
    let mut arc = request(robot, [0.0; 3], Orientation::Fixed, Timing::Sin2);
    arc.start = Start::Joints(corner);
    arc.speeds.acceleration = 0.15;
    arc.via = Some(from + Vector3::new(0.0, 0.1, -0.1));
    arc.target = from + Vector3::new(0.0, 0.0, -0.2);
    let arc = CartesianMove::plan(robot, &arc).unwrap();
    vec![
        Step { course: Arc::new(joint), zone, wait: 0.0 },
        Step { course: Arc::new(line), zone, wait: 0.0 },
        Step { course: Arc::new(arc), zone, wait: 0.0 },
    ]
}

#[test]
fn without_zones_moves_follow_each_other() {
    let robot = robot();
    let all: f64 = steps(&robot, 0.0).iter().map(|step| step.course.duration()).sum();
    let sequence = Sequence::join(&robot, steps(&robot, 0.0)).unwrap();
    assert!((sequence.duration() - all).abs() < 1e-12);
}

#[test]
fn corners_are_rounded_within_their_zones_and_motion_is_continuous() {
    let robot = robot();
    let zone = 0.03;
    let stops = Sequence::join(&robot, steps(&robot, 0.0)).unwrap();
    let blended = Sequence::join(&robot, steps(&robot, zone)).unwrap();
    assert!(blended.duration() < stops.duration() - 0.1, "{} {}", blended.duration(), stops.duration());
    // at the end and the start of a blend, and everywhere between
    for t in blended.seams() {
        for axis in 0..6 {
            let (a, b) = (blended.at(axis, t - 1e-15), blended.at(axis, t + 1e-15));
            (0..3).for_each(|i| assert!((a[i] - b[i]).abs() < 1e-12 * 20.0, "axis {axis} at {t}"));
        }
    }
    let from = tool(&robot, &BENT).translation;
    let (begin, end) = (blended.begins()[1], blended.begins()[2]);
    let corner = from + Vector3::new(0.0, -0.4, 0.0);
    let mut nearest = f64::INFINITY;
    for k in 0..=2000 {
        let t = begin + (end + 1.0 - begin) * f64::from(k) / 2000.0;
        let tip = tool(&robot, &blended.positions(t)).translation;
        let (near_start, near_corner) = ((tip - from).norm() <= zone, (tip - corner).norm() <= 1.05 * zone);
        nearest = nearest.min((tip - corner).norm());
        if !near_start && !near_corner && t < end {
            let off = tip - from;
            assert!(off.x.hypot(off.z) < 1e-6, "off the line at {t}");
        }
    }
    assert!(nearest > 1e-3 && nearest < zone, "the corner is cut: {nearest}");
    let speed_at_corner = {
        let tip = |t: f64| tool(&robot, &blended.positions(t)).translation;
        (tip(end + 0.05) - tip(end + 0.05 - 1e-4)).norm() / 1e-4
    };
    assert!(speed_at_corner > 0.02, "no stop: {speed_at_corner}");
    let found = inspect(&robot, &blended, &Scrutiny::at(1000)).violations;
    assert!(found.is_empty(), "{found:?}");
}

/// What is largest, found by looking at very many times.
fn largest(course: &dyn Course, what: usize) -> Vec<f64> {
    let at = |axis: usize, k: u32| course.at(axis, course.duration() * f64::from(k) / 40_000.0)[what].abs();
    (0..course.axes()).map(|axis| (0..=40_000).map(|k| at(axis, k)).fold(0.0, f64::max)).collect()
}

/// However long the robot waits in between.
#[test]
fn what_is_largest_along_a_sequence_is_found() {
    let robot = robot();
    let moves = steps(&robot, 0.0);
    let of = |what: usize| -> Vec<f64> {
        let each: Vec<Vec<f64>> = moves.iter().map(|step| largest(&*step.course, what)).collect();
        (0..6).map(|axis| each.iter().map(|of| of[axis]).fold(0.0, f64::max)).collect()
    };
    let (speeds, accelerations) = (of(1), of(2));
    let mut torques: Vec<Vec<f64>> = Vec::new();
    for wait in [0.0, 3.0, 600.0, 1e5] {
        let mut waiting = steps(&robot, 0.0);
        (waiting[0].wait, waiting[1].wait) = (wait, 0.7 * wait);
        let sequence = Sequence::join(&robot, waiting).unwrap();
        let found = inspect(&robot, &sequence, &Scrutiny::default());
        assert!(found.violations.is_empty(), "{wait}: {:?}", found.violations);
        for (axis, found) in found.axes.iter().enumerate() {
            let near = |value: f64, exact: f64| (value - exact).abs() < 1e-6 * exact.max(1e-3);
            assert!(near(found.speed, speeds[axis]), "{wait}: {axis} {} {}", found.speed, speeds[axis]);
            let (value, exact) = (found.acceleration, accelerations[axis]);
            assert!(near(value, exact), "{wait}: {axis} {value} {exact}");
        }
        torques
            .push(found.axes.iter().map(|axis| axis.torque.map_or(0.0, |torque| torque.largest)).collect());
        let first = &torques[0];
        assert!(torques.iter().flatten().zip(first.iter().cycle()).all(|(a, b)| (a - b).abs() <= 1e-5 * b));
    }
}

#[test]
fn what_is_no_sequence_is_said() {
    let robot = robot();
    assert_eq!(Sequence::join(&robot, Vec::new()).unwrap_err(), SequenceError::Empty);
    assert_eq!(Sequence::join(&robot, steps(&robot, -1.0)).unwrap_err(), SequenceError::Zone { step: 0 });
    let mut gap = steps(&robot, 0.0);
    gap.remove(1);
    assert!(matches!(Sequence::join(&robot, gap), Err(SequenceError::Gap { step: 1, .. })));
}

#[test]
fn the_robot_rests_for_as_long_as_it_is_to_wait() {
    let robot = robot();
    let mut waiting = steps(&robot, 0.0);
    let durations: Vec<f64> = waiting.iter().map(|step| step.course.duration()).collect();
    (waiting[0].wait, waiting[2].wait) = (0.4, 0.25);
    let sequence = Sequence::join(&robot, waiting).unwrap();
    assert!((sequence.duration() - durations.iter().sum::<f64>() - 0.65).abs() < 1e-12);
    assert!((sequence.begins()[1] - durations[0] - 0.4).abs() < 1e-12);
    for t in [durations[0], durations[0] + 0.2, durations[0] + 0.4 - 1e-9] {
        for (axis, end) in BENT.iter().enumerate() {
            let [q, v, a] = sequence.at(axis, t);
            assert!(
                (q - end).abs() < 1e-12 && v.abs() < 1e-9 && a.abs() < 1e-9,
                "{axis} at {t}: {q} {v} {a}"
            );
        }
    }
    let with = |zone: f64, wait: f64| {
        let mut wrong = steps(&robot, 0.0);
        (wrong[1].zone, wrong[1].wait) = (zone, wait);
        Sequence::join(&robot, wrong).unwrap_err()
    };
    assert_eq!(with(0.01, 0.1), SequenceError::Wait { step: 1, zone: true });
    assert_eq!(with(0.0, -0.1), SequenceError::Wait { step: 1, zone: false });
    assert_eq!(with(0.0, f64::NAN), SequenceError::Wait { step: 1, zone: false });
}
