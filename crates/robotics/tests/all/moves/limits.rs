use crate::moves::arm::{robot, tool};
use crate::moves::lines::{BENT, request};
use blocksim_multibody::{EulerZyx, Placement};
use blocksim_robotics::planner::{
    CartesianMove, CartesianRequest, Course, Orientation, Quantity, Scrutiny, Speeds, Start, Timing, Turning,
    inspect,
};
use nalgebra::Vector3;

#[test]
fn the_fastest_move_uses_a_limit_at_all_times_and_exceeds_none() {
    let robot = robot();
    let mut request = request(&robot, [0.1, -0.45, -0.35], Orientation::Fixed, Timing::TimeOptimal);
    request.speeds = Speeds { velocity: 2.5, acceleration: 1.0, timing: Timing::TimeOptimal };
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    let limits = robot.limits();
    let (mut idle, mut over) = (0, 0.0_f64);
    for k in 1..1000 {
        let t = planned.duration() * f64::from(k) / 1000.0;
        let [_, v, u] = planned.law().at(t);
        let mut used = (v / 2.5).max(u.abs() / 8.0);
        for (axis, limits) in limits.iter().enumerate() {
            let [_, v, a] = planned.at(axis, t);
            used = used.max(v.abs() / limits.speed).max(a.abs() / limits.acceleration);
        }
        over = over.max(used);
        idle += usize::from(used < 0.98);
    }
    assert!(over < 1.0 + 1e-3, "{over}");
    assert!(idle < 10, "{idle} of 1000 times without a limit");
    assert!(
        inspect(&robot, &planned, &Scrutiny::at(1000)).violations.iter().all(|v| v.worst < v.limit * 1.001)
    );
}

#[test]
fn a_line_that_leaves_the_range_of_an_axis_is_told_with_its_place() {
    // a short way down with a tool that bends axis 5 towards its limit of 120 deg
    let robot = robot();
    let q = [0.0, 0.3, 0.2, 0.0, 1.9, 0.0];
    let request = CartesianRequest {
        start: Start::Joints(q.to_vec()),
        via: None,
        target: tool(&robot, &q).translation + Vector3::new(0.3, 0.1, 0.25),
        orientation: Orientation::Axis,
        speeds: Speeds { velocity: 0.1, acceleration: 0.2, timing: Timing::Sin2 },
        turning: Turning::default(),
        resolution: 0.001,
    };
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    let findings = inspect(&robot, &planned, &Scrutiny::at(800));
    let first = findings.violations.first().expect("a violation");
    assert_eq!((first.quantity, first.axis), (Quantity::Upper, Some(4)), "{first}");
    // there, and not before
    let before = planned.at(4, first.spot.t - 0.01)[0];
    assert!(before < first.limit && first.value > first.limit && first.value - first.limit < 0.01);
    assert_eq!(first.source().unwrap(), "links[4].limits.upper");
    assert!(first.to_string().contains("axis 5 leaves its range"), "{first}");
}

#[test]
fn too_fast_a_line_is_told_with_a_velocity_that_fits() {
    let robot = robot();
    let turned = EulerZyx { alpha: 1.2, beta: 0.0, gamma: 0.0 }.rotation() * tool(&robot, &BENT).rotation;
    let mut request = request(&robot, [0.0, -0.2, 0.0], Orientation::Interpolated(turned), Timing::Sin2);
    request.speeds.velocity = 2.5;
    request.speeds.acceleration = 1.0;
    request.turning = Turning { velocity: 20.0, acceleration: 200.0 };
    let too_fast = CartesianMove::plan(&robot, &request).unwrap();
    let findings = inspect(&robot, &too_fast, &Scrutiny::at(1000));
    let first = findings.violations.first().expect("a violation");
    assert!(matches!(first.quantity, Quantity::Speed | Quantity::Acceleration), "{first}");
    assert!(first.help(Some(2.5)).contains("lower"), "{}", first.help(Some(2.5)));
}

#[test]
fn near_a_singular_pose_a_line_is_told() {
    // axis 5 passes zero: with the tool axis prescribed axes 4 and 6 are in line there
    let robot = robot();
    let q = [0.0, 0.2, 0.1, 0.02, 0.12, 0.0];
    let down = |by: f64| CartesianRequest {
        start: Start::Joints(q.to_vec()),
        via: None,
        target: tool(&robot, &q).translation + Vector3::new(0.0, 0.0, by),
        orientation: Orientation::Fixed,
        speeds: Speeds { velocity: 0.05, acceleration: 0.2, timing: Timing::Sin2 },
        turning: Turning::default(),
        resolution: 0.001,
    };
    let told = [-0.3, 0.3].iter().any(|by| match CartesianMove::plan(&robot, &down(*by)) {
        Err(error) => error.to_string().contains("singular"),
        Ok(planned) => {
            let findings = inspect(&robot, &planned, &Scrutiny::at(500));
            findings
                .violations
                .iter()
                .any(|v| matches!(v.quantity, Quantity::Singularity | Quantity::Acceleration))
        }
    });
    assert!(told);
}

#[test]
fn a_slow_line_in_the_open_has_margins_everywhere() {
    let robot = robot();
    let planned =
        CartesianMove::plan(&robot, &request(&robot, [0.1, -0.45, -0.35], Orientation::Fixed, Timing::Sin2))
            .unwrap();
    let findings = inspect(&robot, &planned, &Scrutiny::at(1000));
    assert!(findings.violations.is_empty(), "{:?}", findings.violations);
    assert!((findings.tool_speed - 0.25).abs() < 1e-6, "{}", findings.tool_speed);
    let narrow = findings.narrowest.unwrap();
    assert!(narrow.margin > 0.05 && narrow.t <= planned.duration());
}

/// The largest second difference of the places of the tool, m/s²: what the tool does, whatever the planner states.
fn largest_second_difference(robot: &blocksim_robotics::robot::Robot, course: &dyn Course) -> f64 {
    const H: f64 = 1e-4;
    let at = |t: f64| tool(robot, &course.positions(t)).translation;
    let count = 4000;
    let times = (1..count).map(|k| course.duration() * f64::from(k) / f64::from(count));
    times.map(|t| (at(t - H) - 2.0 * at(t) + at(t + H)).norm() / (H * H)).fold(0.0, f64::max)
}

#[test]
fn the_acceleration_of_the_tool_is_what_differences_of_its_path_say() {
    use blocksim_robotics::motion::{JointMove, JointMoveRequest, Synchronisation};
    let robot = robot();
    let request = JointMoveRequest {
        start: vec![0.0; 6],
        target: [60.0, 30.0, -20.0, 45.0, 60.0, 90.0].map(f64::to_radians).to_vec(),
        velocity: 0.4,
        acceleration: 0.3,
        rule: Synchronisation::Feasible,
    };
    let fast = JointMove::plan(&request, &robot.limits()).unwrap();
    let findings = inspect(&robot, &fast, &Scrutiny::default());
    let measured = largest_second_difference(&robot, &fast);
    assert!((findings.tool_acceleration / measured - 1.0).abs() < 1e-3, "{measured} {findings:?}");
    let exceeded: Vec<_> = findings.violations.iter().map(|v| v.quantity).collect();
    assert_eq!(exceeded, [Quantity::ToolAcceleration], "{:?}", findings.violations);
    let told = &findings.violations[0];
    assert!(told.value > 8.0 && told.limit == 8.0 && told.worst == findings.tool_acceleration, "{told}");
    // The remedy is enough, and not more than that: accelerations go with the square of the velocity. Also where the limit of an
    // axis has made the move slower than its velocity asks for.
    for velocity in [0.4, 0.9] {
        let request = JointMoveRequest { velocity, ..request.clone() };
        let planned = JointMove::plan(&request, &robot.limits()).unwrap();
        assert_eq!(planned.stretch() > 1.0, velocity > 0.5);
        let found = inspect(&robot, &planned, &Scrutiny::default()).violations;
        let told = found.iter().find(|v| v.quantity == Quantity::ToolAcceleration).unwrap();
        let help = told.help(None);
        let percent: f64 = help.split(' ').find_map(|word| word.parse().ok()).unwrap();
        let slower = JointMoveRequest { velocity: velocity * percent / 100.0, ..request };
        let slower =
            inspect(&robot, &JointMove::plan(&slower, &robot.limits()).unwrap(), &Scrutiny::default());
        assert!(slower.violations.is_empty() && slower.tool_acceleration > 7.8, "{help}: {slower:?}");
    }
}

#[test]
fn on_an_arc_the_acceleration_of_the_tool_is_that_across_and_along() {
    // with a trapezoid at full speed v it is v²/r, at the ends of the ramps that and a together
    let robot = robot();
    let mut request = request(&robot, [0.0, -0.4, 0.0], Orientation::Fixed, Timing::Trapezoid);
    let from = tool(&robot, &BENT).translation;
    request.via = Some(from + Vector3::new(0.0, -0.2, 0.2));
    request.speeds = Speeds { velocity: 0.3, acceleration: 0.1, timing: Timing::Trapezoid };
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    let findings = inspect(&robot, &planned, &Scrutiny::default());
    let (across, along): (f64, f64) = (0.3 * 0.3 / 0.2, 0.8);
    assert!((findings.tool_acceleration - across.hypot(along)).abs() < 1e-6, "{findings:?}");
}

#[test]
fn the_fastest_move_keeps_its_limits_where_the_wrist_is_nearly_straight() {
    let robot = robot();
    // Across in front of the robot, past a pose in which axis 5 is bent this little: axes 4 and 6 turn by half a turn there.
    for bent in [0.3, 0.04, 0.01, 0.003, 0.0015] {
        let middle = tool(&robot, &[0.0, 0.2, 0.3, 0.0, bent, 0.0]);
        let aside = |by: f64| middle.translation + Vector3::new(0.0, by, 0.0);
        let request = CartesianRequest {
            start: Start::Pose(Placement { translation: aside(-0.3), ..middle }),
            via: None,
            target: aside(0.3),
            orientation: Orientation::Fixed,
            speeds: Speeds { velocity: 2.5, acceleration: 1.0, timing: Timing::TimeOptimal },
            turning: Turning::default(),
            resolution: 0.001,
        };
        let planned = CartesianMove::plan(&robot, &request).unwrap();
        let narrow = planned.narrowest().unwrap().margin;
        let limits = robot.limits();
        let mut over = 0.0_f64;
        for k in 0..=200_000 {
            let t = planned.duration() * f64::from(k) / 200_000.0;
            for (axis, limits) in limits.iter().enumerate() {
                let [_, v, a] = planned.at(axis, t);
                over = over.max(v.abs() / limits.speed).max(a.abs() / limits.acceleration);
            }
            let [_, v, a] = planned.law().at(t);
            over = over.max(v / 2.5).max(a.abs() / 8.0);
        }
        assert!(over < 1.0 + 1e-6 && over > 0.99, "{bent}, margin {narrow}: {over}");
    }
}

#[test]
fn a_line_that_turns_the_tool_keeps_the_bounds_of_turning() {
    let robot = robot();
    let turned = EulerZyx { alpha: 1.2, beta: 0.0, gamma: 0.0 }.rotation() * tool(&robot, &BENT).rotation;
    let angle =
        blocksim_multibody::rotation_vector(&(turned * tool(&robot, &BENT).rotation.transpose())).norm();
    for timing in [Timing::Sin2, Timing::Trapezoid, Timing::SCurve { jerk: 50.0 }, Timing::TimeOptimal] {
        let mut request = request(&robot, [0.0, -0.2, 0.0], Orientation::Interpolated(turned), timing);
        request.speeds = Speeds { velocity: 0.3, acceleration: 0.5, timing };
        request.turning = Turning { velocity: 0.4, acceleration: 1.0 };
        let planned = CartesianMove::plan(&robot, &request).unwrap();
        // of the orientation itself, by differences
        let (count, h) = (2000, 1e-4);
        let at = |t: f64| tool(&robot, &planned.positions(t)).rotation;
        let turns =
            |t: f64| blocksim_multibody::rotation_vector(&(at(t + h) * at(t - h).transpose())) / (2.0 * h);
        let times = (1..count).map(|k| planned.duration() * f64::from(k) / f64::from(count));
        let fastest = times.clone().map(|t| turns(t).norm()).fold(0.0, f64::max);
        assert!(fastest < 0.4 * (1.0 + 1e-5), "{timing:?}: {fastest} of {angle}");
        let steepest = times.map(|t| (turns(t + h) - turns(t - h)).norm() / (2.0 * h)).fold(0.0, f64::max);
        assert!(steepest < 1.0 + 1e-3, "{timing:?}: {steepest}");
        let notes = planned.notes();
        assert!(notes.len() == 1 && notes[0].to_string().contains("66.6"), "{notes:?} {angle}");
    }
}
