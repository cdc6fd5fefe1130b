use crate::moves::arm::{robot, tool};
use crate::moves::lines::{BENT, request};
use blocksim_multibody::EulerZyx;
use blocksim_robotics::planner::{
    CartesianMove, CartesianRequest, Course, Orientation, Quantity, Reason, Scrutiny, Start, Timing, choose,
    configuration_word, configurations, inspect,
};
use blocksim_robotics::robot::Robot;

const BY: [f64; 3] = [0.1, -0.45, -0.35];

/// A robot whose axis 4 has just no room for the way in the nearest configuration, but for that with the wrist flipped.
fn narrow() -> (Robot, CartesianRequest) {
    let wide = robot();
    let mut request = request(&wide, BY, Orientation::Fixed, Timing::Sin2);
    let planned = CartesianMove::plan(&wide, &request).expect("a move");
    let all = (0..=100).map(|k| planned.at(3, planned.duration() * f64::from(k) / 100.0)[0]);
    let (low, high) = all.fold((BENT[3], BENT[3]), |(low, high), q| (low.min(q), high.max(q)));
    let mut parts = wide.parts().clone();
    let limits = &mut parts.links[3].limits;
    (limits.lower, limits.upper) = match low < BENT[3] - 0.05 {
        true => (0.5 * (low + BENT[3]), high + std::f64::consts::PI + 0.1),
        false => (low - std::f64::consts::PI - 0.1, 0.5 * (high + BENT[3])),
    };
    for (link, q) in parts.links.iter_mut().zip(BENT) {
        link.start = q;
    }
    request.start = Start::Pose(tool(&wide, &BENT));
    (Robot::new(parts).expect("a robot"), request)
}

#[test]
fn where_the_nearest_configuration_leaves_its_limits_another_is_taken_for_the_whole_path() {
    let (robot, request) = narrow();
    let chosen = choose(&robot, &request, None).unwrap();
    assert!(chosen.passes, "{chosen:?}");
    let first = chosen.tried.first().expect("one that was nearer");
    assert!(
        first.reason.contains("axis 4 leaves its") && first.reason.contains("% of the path"),
        "{first:?}"
    );
    let (word, nearest) =
        (configuration_word(chosen.configuration.unwrap()), configuration_word(first.configuration));
    assert_ne!(word, nearest);
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    let positions = |v: &&blocksim_robotics::planner::Violation| {
        matches!(v.quantity, Quantity::Lower | Quantity::Upper | Quantity::Jump)
    };
    assert_eq!(inspect(&robot, &planned, &Scrutiny::at(500)).violations.iter().find(positions), None);
    assert!(
        (tool(&robot, &planned.positions(0.0)).translation - tool(&robot, &BENT).translation).norm() < 1e-9
    );
    assert_eq!(planned.positions(0.0), chosen.q);
}

#[test]
fn a_configuration_can_be_demanded_and_joint_angles_are_kept() {
    let (robot, mut request) = narrow();
    for (word, wanted) in configurations() {
        match choose(&robot, &request, Some(wanted)) {
            Ok(chosen) => assert_eq!(configuration_word(chosen.configuration.unwrap()), word),
            Err(error) => {
                let known =
                    matches!(error.reason, Reason::NoneStarts { .. } | Reason::OtherConfigurations { .. });
                assert!(known, "{word}: {error}");
            }
        }
    }
    request.start = Start::Joints(BENT.to_vec());
    let kept = choose(&robot, &request, None).unwrap();
    assert_eq!((kept.q.as_slice(), kept.configuration), (&BENT[..], None));
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    let violations = inspect(&robot, &planned, &Scrutiny::at(500)).violations;
    assert!(violations.iter().any(|v| v.axis == Some(3)), "{violations:?}");
}

#[test]
fn a_turn_on_the_spot_has_its_own_speed_and_keeps_the_tip_where_it_is() {
    let robot = robot();
    let from = tool(&robot, &BENT);
    let turned = EulerZyx { alpha: 0.6, beta: 0.0, gamma: 0.0 }.rotation() * from.rotation;
    for timing in [Timing::Sin2, Timing::Trapezoid, Timing::SCurve { jerk: 40.0 }, Timing::TimeOptimal] {
        let request = request(&robot, [0.0; 3], Orientation::Interpolated(turned), timing);
        let planned = CartesianMove::plan(&robot, &request).unwrap();
        if timing == Timing::Sin2 {
            // sin² with 90 deg/s and 180 deg/s²: v = √(a d / 2), T = d / v + 2 v / a
            let (a, d) = (std::f64::consts::PI, 0.6);
            let v = (a * d / 2.0_f64).sqrt();
            assert!((planned.duration() - (d / v + 2.0 * v / a)).abs() < 1e-12);
        }
        for k in 0..=200 {
            let t = planned.duration() * f64::from(k) / 200.0;
            let at = tool(&robot, &planned.positions(t));
            let way = planned.way(t).unwrap();
            assert!(way.turn && (at.translation - from.translation).norm() < 1e-6, "{timing:?} at {t}");
            let angle =
                blocksim_multibody::rotation_vector(&(at.rotation * from.rotation.transpose())).norm();
            assert!((angle - way.done).abs() < 1e-6, "{timing:?} at {t}: {angle} {}", way.done);
        }
        let end = tool(&robot, &planned.positions(planned.duration()));
        assert!((end.rotation - turned).norm() < 1e-9);
        assert!(inspect(&robot, &planned, &Scrutiny::at(500)).tool_speed < 1e-5);
    }
}
