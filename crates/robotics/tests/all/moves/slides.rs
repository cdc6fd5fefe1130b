//! Robots with axes that slide, against closed forms.

use blocksim_multibody::{Inertia, Placement};
use blocksim_robotics::motion::{AxisKind, AxisLimits};
use blocksim_robotics::planner::{
    CartesianMove, CartesianRequest, Course, Orientation, PlanError, Quantity, Reason, Scrutiny, Speeds,
    Start, Timing, Turning, inspect, review,
};
use blocksim_robotics::robot::{Drive, Link, LinkSolid, Parts, Robot, TcpLimits};
use nalgebra::Vector3;

use crate::moves::arm;

fn slide(axis: [f64; 3], lower: f64, upper: f64) -> Link {
    Link {
        name: String::new(),
        origin: Placement::identity(),
        axis,
        limits: AxisLimits { kind: AxisKind::Sliding, lower, upper, speed: 2.0, acceleration: 10.0 },
        start: 0.5 * (lower + upper),
        solids: Vec::new(),
        drive: Drive::default(),
    }
}

fn turn(axis: [f64; 3], origin: [f64; 3]) -> Link {
    Link {
        name: String::new(),
        origin: Placement::from_translation(origin),
        axis,
        limits: AxisLimits {
            kind: AxisKind::Turning,
            lower: -3.0,
            upper: 3.0,
            speed: 3.0,
            acceleration: 20.0,
        },
        start: 0.0,
        solids: Vec::new(),
        drive: Drive::default(),
    }
}

fn robot(links: Vec<Link>, flange: [f64; 3]) -> Robot {
    Robot::new(Parts {
        name: String::new(),
        gravity: [0.0, 0.0, -9.81],
        base: Placement::identity(),
        reference: Placement::identity(),
        links,
        flange: Placement::from_translation(flange),
        tool: Placement::identity(),
        tcp_limits: TcpLimits { speed: 3.0, acceleration: 8.0 },
    })
    .unwrap()
}

/// Three slides: the tool is at their positions, 0.2 m below.
fn gantry() -> Robot {
    let links = vec![
        slide([1.0, 0.0, 0.0], 0.0, 4.0),
        slide([0.0, 1.0, 0.0], -1.0, 1.0),
        slide([0.0, 0.0, 1.0], 0.5, 1.5),
    ];
    robot(links, [0.0, 0.0, -0.2])
}

fn line(start: Start, target: [f64; 3]) -> CartesianRequest {
    CartesianRequest {
        start,
        via: None,
        target: Vector3::from(target),
        orientation: Orientation::Fixed,
        speeds: Speeds { velocity: 1.0, acceleration: 0.5, timing: Timing::Trapezoid },
        turning: Turning::default(),
        resolution: 0.01,
    }
}

#[test]
fn a_gantry_goes_along_a_line_as_its_slides_do() {
    let robot = gantry();
    for start in [
        Start::Joints(vec![0.5, -0.8, 0.6]),
        Start::Point(Vector3::new(0.5, -0.8, 0.4)),
        Start::Pose(Placement::from_translation([0.5, -0.8, 0.4])),
    ] {
        let planned = CartesianMove::plan(&robot, &line(start, [3.5, 0.9, 1.2])).unwrap();
        let (from, to) = (Vector3::new(0.5, -0.8, 0.6), Vector3::new(3.5, 0.9, 1.4));
        let length: f64 = (to - from).norm();
        // 1 m/s and 4 m/s²
        assert!((planned.duration() - (length + 0.25)).abs() < 1e-9);
        let along = (to - from) / length;
        for k in 0..=100 {
            let t = planned.duration() * f64::from(k) / 100.0;
            let (rise, fall) = (t.min(0.25), (planned.duration() - t).min(0.25));
            let s = 2.0 * rise * rise + (t - 0.25).max(0.0) - ((0.25 - fall) - 2.0 * (0.0625 - fall * fall));
            for axis in 0..3 {
                let [q, v, _] = planned.at(axis, t);
                assert!((q - from[axis] - s * along[axis]).abs() < 1e-8, "{t}: {q}");
                assert!((v - 4.0 * rise.min(fall) * along[axis]).abs() < 1e-8, "{t}: {v}");
            }
        }
        let findings = inspect(&robot, &planned, &Scrutiny::default());
        assert!(findings.violations.is_empty(), "{:?}", findings.violations);
        assert!((findings.tool_acceleration - 4.0).abs() < 1e-6 && (findings.tool_speed - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_gantry_cannot_leave_its_strokes() {
    let robot = gantry();
    // within the ball of all strokes, beyond the second slide
    let planned =
        CartesianMove::plan(&robot, &line(Start::Joints(vec![0.5, -0.8, 0.6]), [0.5, 1.2, 0.4])).unwrap();
    let found = inspect(&robot, &planned, &Scrutiny::default()).violations;
    let first = &found[0];
    assert_eq!((first.quantity, first.axis, first.limit), (Quantity::Upper, Some(1), 1.0));
    assert!((first.worst - 1.2).abs() < 1e-9 && first.to_string().contains("up to 1200 mm"), "{first}");
    let far = CartesianMove::plan(&robot, &line(Start::Joints(vec![0.5, -0.8, 0.6]), [9.0, 0.0, 0.4]));
    let PlanError { member, reason } = far.unwrap_err();
    assert_eq!(member, "target");
    // A ball about the middle of the first stroke, (2, 0, 0), with half of the strokes, 2 + 1 + 0.5, the height of 1 of the
    // middle of the third, and the tip of 0.2.
    let Reason::Unreachable { distance: Some(distance), .. } = reason else { panic!("{reason:?}") };
    assert!((distance - (7.0_f64.hypot(0.4) - 4.7)).abs() < 1e-12, "{distance}");
}

#[test]
fn an_arm_on_a_track_reaches_along_the_track() {
    let six = arm::robot();
    let mut parts = six.parts().clone();
    parts.links.insert(0, slide([0.0, 1.0, 0.0], -3.0, 3.0));
    let robot = Robot::new(parts).unwrap();
    let q = [0.0, 0.0, 0.2, 0.3, 0.0, 0.9, 0.0];
    let from = arm::tool(&robot, &q);
    // 2.5 m along the track of the base, which is turned: the arm alone does not reach that far
    let along = robot.parts().base.rotation * Vector3::new(0.0, 2.5, 0.0);
    let alone =
        CartesianMove::plan(&six, &line(Start::Joints(q[1..].to_vec()), (from.translation + along).into()));
    assert!(matches!(alone.unwrap_err().reason, Reason::Unreachable { .. }));
    let mut request = line(Start::Joints(q.to_vec()), (from.translation + along).into());
    request.speeds.velocity = 0.5;
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    let end = arm::tool(&robot, &planned.positions(planned.duration()));
    assert!((end.translation - from.translation - along).norm() < 1e-9);
    assert!((end.rotation - from.rotation).norm() < 1e-9);
    let findings = inspect(&robot, &planned, &Scrutiny::default());
    assert!(findings.violations.is_empty(), "{:?}", findings.violations);
}

#[test]
fn a_polar_arm_goes_by_its_angles_and_its_stroke() {
    // turn about z, lift about y, and a boom of 1 m to 2.5 m
    let mut boom = slide([1.0, 0.0, 0.0], 0.5, 2.0);
    boom.origin = Placement::from_translation([0.3, 0.0, 0.0]);
    let links = vec![turn([0.0, 0.0, 1.0], [0.0, 0.0, 0.0]), turn([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]), boom];
    let robot = robot(links, [0.2, 0.0, 0.0]);
    let mut request = line(Start::Joints(vec![0.0, 0.0, 1.0]), [0.9, 1.4, 1.6]);
    request.orientation = Orientation::Free;
    request.speeds.velocity = 0.5;
    let planned = CartesianMove::plan(&robot, &request).unwrap();
    let from = Vector3::new(1.5, 0.0, 1.0);
    for k in 0..=50 {
        let t = planned.duration() * f64::from(k) / 50.0;
        let place =
            from + (Vector3::new(0.9, 1.4, 1.6) - from) * (planned.law().at(t)[0] / planned.path().length());
        let [x, y, z] = [place.x, place.y, place.z - 1.0];
        let ground = x.hypot(y);
        let expected = [y.atan2(x), -z.atan2(ground), ground.hypot(z) - 0.5];
        for (axis, expected) in expected.iter().enumerate() {
            assert!((planned.at(axis, t)[0] - expected).abs() < 1e-6, "axis {axis} at {t}");
        }
    }
    // 0.1 m more than the boom has
    let further = CartesianRequest { target: Vector3::new(2.6, 0.0, 1.0), ..request.clone() };
    let planned = CartesianMove::plan(&robot, &further).unwrap();
    let found = inspect(&robot, &planned, &Scrutiny::default()).violations;
    assert!(found.len() == 1 && found[0].axis == Some(2) && (found[0].worst - 2.1).abs() < 1e-9, "{found:?}");
    let far =
        CartesianMove::plan(&robot, &CartesianRequest { target: Vector3::new(4.6, 0.0, 1.0), ..request });
    assert!(matches!(far.unwrap_err().reason, Reason::Unreachable { .. }));
}

/// On a lift of mass m that moves up with a, the force is m (g + a).
#[test]
fn the_force_of_a_lift_is_told_where_its_motor_cannot_give_it() {
    let lift = |limit: f64| {
        let mut link = slide([0.0, 0.0, 1.0], 0.0, 2.0);
        let inertia = Inertia::point(50.0, [0.1, 0.0, 0.0]).unwrap();
        link.solids = vec![LinkSolid { placement: Placement::identity(), inertia }];
        link.drive = Drive { limit, ..Drive::default() };
        robot(vec![link], [0.0; 3])
    };
    let up =
        |robot: &Robot| CartesianMove::plan(robot, &line(Start::Joints(vec![0.2]), [0.0, 0.0, 1.2])).unwrap();
    let weak = lift(600.0);
    let planned = up(&weak);
    let found = review(&weak, &planned, None, &Scrutiny::default(), Some(1.0));
    let [finding] = &found.all[..] else { panic!("{found:?}") };
    assert_eq!((finding.code, finding.axis, finding.limit), ("axis_torque", Some(0), 600.0));
    assert!((finding.worst - 50.0 * (9.81 + 4.0)).abs() < 1e-6, "{finding:?}");
    assert!(finding.message.contains("up to 690.5 N (115.1 %)"), "{}", finding.message);
    let effort = found.findings.axes[0].torque.unwrap();
    assert!(effort.t <= 0.25 && !found.passes());
    let strong = lift(700.0);
    let found = review(&strong, &up(&strong), None, &Scrutiny::default(), None);
    assert!(found.passes() && found.all.is_empty(), "{found:?}");
    // Whoever knows no limit asks for none.
    let unknown = lift(f64::INFINITY);
    assert_eq!(
        review(&unknown, &up(&unknown), None, &Scrutiny::default(), None).findings.axes[0].torque,
        None
    );
}
