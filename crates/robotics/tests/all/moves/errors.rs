use crate::moves::arm::{robot, tool};
use crate::moves::lines::{BENT, request};
use blocksim_multibody::{EulerZyx, Placement};
use blocksim_robotics::kinematics::InverseError;
use blocksim_robotics::planner::{CartesianMove, CartesianRequest, Orientation, Reason, Start, Timing};
use nalgebra::Vector3;

fn refused(change: impl Fn(&mut CartesianRequest)) -> (String, &'static str, Reason) {
    let robot = robot();
    let mut request = request(&robot, [0.1, -0.2, -0.2], Orientation::Fixed, Timing::Sin2);
    change(&mut request);
    let error = CartesianMove::plan(&robot, &request).expect_err("a refusal");
    assert!(!error.help().is_empty());
    (error.to_string(), error.member, error.reason)
}

#[test]
fn numbers_that_are_none_and_out_of_range_are_named() {
    assert_eq!(refused(|r| r.target.x = f64::NAN).1, "target");
    assert_eq!(refused(|r| r.start = Start::Joints(vec![f64::INFINITY; 6])).1, "start");
    assert_eq!(refused(|r| r.start = Start::Point(Vector3::new(0.0, f64::NAN, 0.0))).1, "start");
    assert_eq!(
        refused(|r| r.start = Start::Joints(vec![0.0; 5])).0,
        "the start has 5 positions, but the robot has 6 axes"
    );
    assert_eq!(refused(|r| r.via = Some(Vector3::repeat(f64::NAN))).1, "via");
    assert_eq!(
        refused(|r| r.speeds.velocity = 3.0).0,
        "the velocity is 3000 mm/s, allowed is 0.001 to 2500 mm/s"
    );
    assert_eq!(refused(|r| r.speeds.velocity = 0.0).1, "velocity");
    assert_eq!(
        refused(|r| r.speeds.acceleration = 40.0).0,
        "the acceleration is 4000 %, allowed is 0.001 to 100 %"
    );
    assert_eq!(refused(|r| r.speeds.timing = Timing::SCurve { jerk: -1.0 }).1, "jerk");
    assert_eq!(refused(|r| r.resolution = 0.0).1, "resolution");
    assert_eq!(
        refused(|r| r.resolution = 1e-9).0,
        "the resolution is 1.000e-6 mm, allowed is 0.001 to 10000 mm"
    );
    let fine = refused(|r| (r.target.z, r.resolution) = (r.target.z - 0.3, 1e-6));
    assert!(matches!(fine.2, Reason::TooManyWaypoints { .. }), "{}", fine.0);
}

#[test]
fn a_start_outside_the_limits_is_named_with_axis_value_and_limit() {
    let (message, ..) = refused(|r| {
        let mut q = BENT;
        q[2] = 80f64.to_radians();
        r.start = Start::Joints(q.to_vec());
    });
    assert_eq!(message, "axis 3 starts at 80 deg, which is above its limit 75 deg");
}

#[test]
fn a_way_without_length_and_a_straight_arc_are_refused() {
    let at = tool(&robot(), &BENT).translation;
    assert_eq!(refused(|r| r.target = at).2, Reason::Nothing);
    assert_eq!(refused(|r| r.target = at + Vector3::repeat(1e-8)).2, Reason::Nothing);
    assert_eq!(refused(|r| r.via = Some(0.5 * (at + r.target))).2, Reason::Straight);
}

#[test]
fn a_target_out_of_reach_is_told_as_such_with_its_distance() {
    let far = Vector3::new(3.0, 0.0, 1.0);
    let (message, member, reason) = refused(|r| r.target = far);
    let Reason::Unreachable { at, distance: Some(distance), .. } = reason else { panic!("{message}") };
    assert_eq!((at, member), (1.0, "target"), "{message}");
    // as the closed form has it
    let robot = robot();
    let place = Placement { translation: far, ..tool(&robot, &BENT) };
    let target = robot.reference().placement * place;
    let Err(InverseError::Unreachable { distance: expected }) =
        robot.closed_form().expect("one").inverse(&target, &BENT)
    else {
        panic!("in reach")
    };
    assert!((distance - expected).abs() < 1e-9, "{distance} {expected}");
    for orientation in [Orientation::Free, Orientation::Axis] {
        let (message, member, _) = refused(|r| (r.target, r.orientation) = (far, orientation));
        assert!(
            member == "target" && message.starts_with("the arm does not reach the target: "),
            "{message}"
        );
    }
    let start =
        Placement { rotation: EulerZyx::default().rotation(), translation: Vector3::new(9.0, 0.0, 0.0) };
    for start in [Start::Pose(start), Start::Point(start.translation)] {
        let (message, member, _) = refused(|r| r.start = start.clone());
        assert!(member == "start" && message.contains("mm out of reach"), "{message}");
    }
}

#[test]
fn a_free_tip_reaches_as_far_as_the_stretched_arm() {
    // Straight out from axis 2, in the plane of axis 1: upper arm, forearm with its offset, hand.
    let robot = robot();
    let shoulder = Vector3::new(0.15, 0.0, 0.445);
    let out = Vector3::new(3.0, 0.0, 1.0).normalize();
    let hand = 0.1195_f64.hypot(0.352 + 0.085);
    let reach = 0.9 + 0.115_f64.hypot(0.795) + hand;
    let by = |more: f64| {
        let mut request = request(&robot, [0.0; 3], Orientation::Free, Timing::Sin2);
        request.target = shoulder + out * (reach + more);
        CartesianMove::plan(&robot, &request)
    };
    let error = by(1e-3).expect_err("too far");
    let Reason::Unreachable { at: 1.0, distance: Some(distance), .. } = error.reason else {
        panic!("{error}")
    };
    assert!((distance - 1e-3).abs() < 1e-9, "{distance}");
    let near = by(-1e-3).map_or_else(|error| error.reason, |_| Reason::Nothing);
    assert!(!matches!(near, Reason::Unreachable { distance: Some(_), .. }), "{near:?}");
}

#[test]
fn a_line_through_the_base_is_refused() {
    for orientation in [Orientation::Fixed, Orientation::Free, Orientation::Axis] {
        let robot = robot();
        let mut request = request(&robot, [0.0; 3], orientation, Timing::Sin2);
        let at = tool(&robot, &BENT).translation;
        request.target = Vector3::new(-at.x, -at.y, at.z);
        match CartesianMove::plan(&robot, &request) {
            Err(error) => assert!(error.to_string().contains("% of the path"), "{error}"),
            Ok(planned) => {
                let findings = blocksim_robotics::planner::inspect(
                    &robot,
                    &planned,
                    &blocksim_robotics::planner::Scrutiny::at(1000),
                );
                assert!(!findings.violations.is_empty(), "{orientation:?}");
            }
        }
    }
}
