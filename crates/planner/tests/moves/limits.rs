use crate::arm::{robot, tool};
use crate::lines::{BENT, request};
use blocksim_multibody::EulerZyx;
use blocksim_planner::{
    CartesianMove, CartesianRequest, Course, Orientation, Quantity, Speeds, Start, Timing, Turning, inspect,
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
    assert!(inspect(&robot, &planned, 1000).violations.iter().all(|v| v.worst < v.limit * 1.001));
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
    let findings = inspect(&robot, &planned, 800);
    let first = findings.violations.first().expect("a violation");
    assert_eq!((first.quantity, first.axis), (Quantity::Upper, Some(4)), "{first}");
    // there, and not before
    let before = planned.at(4, first.t - 0.01)[0];
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
    let too_fast = CartesianMove::plan(&robot, &request).unwrap();
    let findings = inspect(&robot, &too_fast, 1000);
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
            let findings = inspect(&robot, &planned, 500);
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
    let findings = inspect(&robot, &planned, 1000);
    assert!(findings.violations.is_empty(), "{:?}", findings.violations);
    assert!((findings.tool_speed - 0.25).abs() < 1e-6, "{}", findings.tool_speed);
    let narrow = findings.narrowest.unwrap();
    assert!(narrow.margin > 0.05 && narrow.t <= planned.duration());
}
