use crate::moves::arm::{robot, tool};
use blocksim_multibody::{EulerZyx, rotation_vector};
use blocksim_robotics::kinematics::{Constraint, Options, Solver, Status, follow_point};
use blocksim_robotics::planner::{
    CartesianMove, CartesianRequest, Course, Orientation, Speeds, Start, Timing, Turning,
};
use blocksim_robotics::robot::Robot;
use nalgebra::Vector3;

/// A bent pose, far from singular ones.
pub const BENT: [f64; 6] = [0.1, 0.2, 0.1, 0.3, 0.8, -0.2];

pub fn request(robot: &Robot, by: [f64; 3], orientation: Orientation, timing: Timing) -> CartesianRequest {
    CartesianRequest {
        start: Start::Joints(BENT.to_vec()),
        via: None,
        target: tool(robot, &BENT).translation + Vector3::from(by),
        orientation,
        speeds: Speeds { velocity: 0.25, acceleration: 0.4, timing },
        turning: Turning::default(),
        resolution: 0.0005,
    }
}

fn orientations(robot: &Robot) -> [Orientation; 4] {
    let turned = EulerZyx { alpha: 0.3, beta: 0.2, gamma: -0.25 }.rotation() * tool(robot, &BENT).rotation;
    [Orientation::Free, Orientation::Fixed, Orientation::Interpolated(turned), Orientation::Axis]
}

const TIMINGS: [Timing; 4] =
    [Timing::Sin2, Timing::Trapezoid, Timing::SCurve { jerk: 40.0 }, Timing::TimeOptimal];

const BY: [f64; 3] = [0.1, -0.45, -0.35];

#[test]
fn the_tip_is_on_the_line_and_oriented_as_asked_at_all_times() {
    let robot = robot();
    let from = tool(&robot, &BENT);
    for orientation in orientations(&robot) {
        for timing in TIMINGS {
            let request = request(&robot, BY, orientation, timing);
            let planned = CartesianMove::plan(&robot, &request).unwrap();
            let along = (request.target - from.translation).normalize();
            // beside the waypoints, too
            for k in 0..=997 {
                let t = planned.duration() * f64::from(k) / 997.0;
                let at = tool(&robot, &planned.positions(t));
                let way = at.translation - from.translation;
                let s = planned.way(t).unwrap().done;
                assert!((way - along * s).norm() < 1e-6, "{orientation:?} {timing:?} at {t}");
                let turned = match orientation {
                    Orientation::Free => 0.0,
                    Orientation::Fixed => rotation_vector(&(at.rotation * from.rotation.transpose())).norm(),
                    Orientation::Axis => at.rotation.column(2).cross(&from.rotation.column(2)).norm(),
                    Orientation::Interpolated(to) => {
                        let all = rotation_vector(&(to * from.rotation.transpose()));
                        let now = rotation_vector(&(at.rotation * from.rotation.transpose()));
                        (now - all * (s / planned.path().length())).norm()
                    }
                };
                assert!(turned < 1e-6, "{orientation:?} {timing:?} at {t}: {turned}");
            }
            let end = tool(&robot, &planned.positions(planned.duration()));
            assert!((end.translation - request.target).norm() < 1e-9);
        }
    }
}

#[test]
fn speeds_and_accelerations_are_the_derivatives() {
    let robot = robot();
    for orientation in orientations(&robot) {
        for timing in [Timing::Sin2, Timing::SCurve { jerk: 40.0 }] {
            let planned = CartesianMove::plan(&robot, &request(&robot, BY, orientation, timing)).unwrap();
            let h = 1e-4;
            for k in 1..100 {
                let t = planned.duration() * f64::from(k) / 100.0;
                for axis in 0..6 {
                    let [_, v, a] = planned.at(axis, t);
                    let [q0, v0, _] = planned.at(axis, t - h);
                    let [q1, v1, _] = planned.at(axis, t + h);
                    assert!(((q1 - q0) / (2.0 * h) - v).abs() < 1e-6, "axis {axis} at {t}");
                    // in a corner of the acceleration the difference is off by h times the jerk
                    assert!(((v1 - v0) / (2.0 * h) - a).abs() < 2e-2, "{orientation:?} axis {axis} at {t}");
                }
            }
        }
    }
}

/// The motion of the tool by the Jacobian is that along the path.
#[test]
fn the_tool_moves_along_the_path_with_its_speed() {
    let robot = robot();
    for orientation in orientations(&robot) {
        let planned = CartesianMove::plan(&robot, &request(&robot, BY, orientation, Timing::Sin2)).unwrap();
        let (h, along) = (1e-5, Vector3::from(BY).normalize());
        for k in 1..50 {
            let t = planned.duration() * f64::from(k) / 50.0;
            let tip = |t: f64| tool(&robot, &planned.positions(t)).translation;
            let speed = (tip(t + h) - tip(t - h)) / (2.0 * h);
            let [_, v, _] = planned.law().at(t);
            assert!((speed - along * v).norm() < 1e-6, "{orientation:?} at {t}");
        }
    }
}

#[test]
fn position_speed_and_acceleration_are_continuous_to_1e12() {
    let robot = robot();
    for orientation in orientations(&robot) {
        for timing in [Timing::Sin2, Timing::SCurve { jerk: 40.0 }] {
            let planned = CartesianMove::plan(&robot, &request(&robot, BY, orientation, timing)).unwrap();
            let joints = planned.joints();
            let knots = (1..joints.intervals()).map(|k| planned.law().time_of(joints.place(k)));
            for t in planned.seams().into_iter().chain(knots) {
                for axis in 0..6 {
                    let h = 1e-15 * planned.duration().max(1.0);
                    let (before, after) = (planned.at(axis, t - h), planned.at(axis, t + h));
                    for (a, b) in before.iter().zip(after) {
                        assert!((a - b).abs() < 1e-12, "{timing:?} axis {axis} at {t}: {a} {b}");
                    }
                }
            }
        }
    }
}

/// Waypoint by waypoint, as with a general solver: each from the one before.
fn apart_from_solver(wish: impl Fn(&Robot, Vector3<f64>, &[f64]) -> Vec<Constraint>) -> f64 {
    let robot = robot();
    let request = request(&robot, BY, Orientation::Free, Timing::Sin2);
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    let joints = planned.joints();
    let mut solver = Solver::new(robot.model(), &robot.ranges()).unwrap();
    let options = Options { restarts: 0, ..Options::default() };
    let mut q = BENT.to_vec();
    let mut worst = 0.0_f64;
    for k in 1..=joints.intervals() {
        let point = planned.path().at(joints.place(k)).placement.translation;
        let solved = solver.solve(&wish(&robot, point, &q), &q, &options).unwrap();
        assert_eq!(solved.status, Status::Success, "waypoint {k}");
        q = solved.q;
        for (axis, q) in q.iter().enumerate() {
            worst = worst.max((q - joints.knot(k, axis)[0]).abs());
        }
    }
    worst
}

#[test]
fn the_free_orientation_is_what_the_solver_finds_waypoint_by_waypoint() {
    // its steps are of first order
    let position = |robot: &Robot, point: Vector3<f64>, _: &[f64]| {
        vec![Constraint::position(robot.tool(), robot.reference(), point)]
    };
    assert!(apart_from_solver(position) < 0.01);
    // aiming at the tip adds nothing on the path, and a little to the way of the solver to it
    let all = |robot: &Robot, point: Vector3<f64>, q: &[f64]| {
        follow_point(robot.tool(), robot.reference(), point, q, 0.1).to_vec()
    };
    assert!(apart_from_solver(all) < 0.15);
}

#[test]
fn an_arc_keeps_its_distance_from_the_centre() {
    let robot = robot();
    let from = tool(&robot, &BENT).translation;
    for orientation in orientations(&robot) {
        let mut request = request(&robot, [0.0, 0.4, 0.0], orientation, Timing::Sin2);
        request.via = Some(from + Vector3::new(0.0, 0.2, -0.2));
        let planned = CartesianMove::plan(&robot, &request).unwrap();
        assert!((planned.path().length() - 0.2 * std::f64::consts::PI).abs() < 1e-9);
        for k in 0..=777 {
            let tip = tool(&robot, &planned.positions(planned.duration() * f64::from(k) / 777.0)).translation;
            let radius = tip - from - Vector3::new(0.0, 0.2, 0.0);
            assert!((radius.norm() - 0.2).abs() < 1e-6 && radius.x.abs() < 1e-6);
        }
    }
}

#[test]
fn a_line_starts_from_a_pose_and_from_a_point() {
    let robot = robot();
    let at = tool(&robot, &BENT);
    let mut request = request(&robot, BY, Orientation::Fixed, Timing::Sin2);
    request.start = Start::Pose(at);
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    assert!((tool(&robot, &planned.positions(0.0)).rotation - at.rotation).abs().max() < 1e-9);
    request.start = Start::Point(at.translation);
    request.orientation = Orientation::Free;
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    assert!((tool(&robot, &planned.positions(0.0)).translation - at.translation).norm() < 1e-7);
}

#[test]
fn the_thesis_profile_has_its_times() {
    let robot = robot();
    // 0.5 m with 0.25 m/s and 3.2 m/s²: t_acc = 2 v / a, t_end = d / v + t_acc
    let planned =
        CartesianMove::plan(&robot, &request(&robot, [0.3, -0.4, 0.0], Orientation::Free, Timing::Sin2))
            .unwrap();
    assert!((planned.duration() - (0.5 / 0.25 + 0.5 / 3.2)).abs() < 1e-9);
    // a short way: v = √(a d / 2)
    let planned =
        CartesianMove::plan(&robot, &request(&robot, [0.01, 0.0, 0.0], Orientation::Free, Timing::Sin2))
            .unwrap();
    let v = (3.2 * 0.01 / 2.0_f64).sqrt();
    assert!((planned.duration() - (0.01 / v + 2.0 * v / 3.2)).abs() < 1e-9);
}
