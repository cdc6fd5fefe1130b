//! Robots with axes that slide: a SCARA robot against closed forms and against the same arm made of blocks.

use std::path::Path;

use blocksim_blocks::robotics::RobotDescription;
use blocksim_diagram::{Sources, parameter};
use blocksim_robotics::robot::Robot;
use blocksim_tests::{Desk, Run, compile_with, root, run, run_file};
use nalgebra::Vector3;

const MODEL: &str = "diagrams/scara/scara.ron";
/// Lengths of both links, m.
const LENGTHS: [f64; 2] = [0.35, 0.3];
const GRAVITY: f64 = 9.80665;

fn scara() -> Robot {
    let desk = Desk::new();
    let read: Result<RobotDescription, _> =
        parameter(&Sources::new(&desk), &root().join(MODEL), &[], "manipulator");
    read.expect("a description").robot("manipulator").expect("a robot")
}

fn column<'r>(run: &'r Run, name: &str) -> &'r [f64] {
    let at = run.recorded.iter().position(|recorded| recorded.path == name);
    let names = || run.recorded.iter().map(|recorded| recorded.path.as_str()).collect::<Vec<_>>();
    &run.columns[at.unwrap_or_else(|| panic!("{name} is not among {:?}", names()))]
}

/// Some motions: positions, speeds, accelerations.
fn motions() -> impl Iterator<Item = [[f64; 4]; 3]> {
    (0..50).map(|k| {
        let wave = |phase: f64, size: f64| size * (1.7 * f64::from(k) + phase).sin();
        let q = [wave(0.0, 2.0), wave(1.0, 2.4), -0.1 + wave(2.0, 0.1), wave(3.0, 6.0)];
        [
            q,
            [wave(4.0, 5.0), wave(5.0, 8.0), wave(6.0, 1.0), wave(7.0, 20.0)],
            [wave(8.0, 30.0), wave(9.0, 60.0), wave(10.0, 15.0), wave(11.0, 200.0)],
        ]
    })
}

#[test]
fn the_tool_is_where_plane_geometry_says() {
    let (robot, [l1, l2]) = (scara(), LENGTHS);
    let mut data = robot.model().data();
    for [[a, b, d, c], ..] in motions() {
        let tool = robot.tcp(&mut data, &[a, b, d, c]);
        let (x, y) = (l1 * a.cos() + l2 * (a + b).cos(), l1 * a.sin() + l2 * (a + b).sin());
        assert!((tool.translation - Vector3::new(x, y, 0.2 + d)).norm() < 1e-14, "{tool:?}");
        // The tool points down and turns with the sum of the angles.
        let turn = a + b + c;
        let ahead = Vector3::new(turn.cos(), turn.sin(), 0.0);
        assert!((tool.rotation.column(0) - ahead).norm() < 1e-14);
        assert!((tool.rotation.column(2) + Vector3::z()).norm() < 1e-14);
    }
}

/// The equations of motion of the arm, by hand: a plane arm of two links that bears spindle and hand at its end, and a
/// mass that is lifted.
#[test]
fn torques_and_forces_are_those_of_the_equations_by_hand() {
    let (robot, [l1, l2]) = (scara(), LENGTHS);
    let mut data = robot.model().data();
    let (m1, c1, i1) = (6.0, 0.17, 0.1);
    let (m2, c2, i2) = (4.0, 0.14, 0.04);
    let (borne, spindle, hand) = (0.8 + 0.5, 0.0002, 0.0004);
    for [[a, b, d, c], v, acceleration] in motions() {
        let mut tau = [0.0; 4];
        robot.joint_torques(&mut data, &[a, b, d, c], &v, &acceleration, &mut tau);
        let k = l1 * (m2 * c2 + borne * l2);
        let outer = i2 + m2 * c2 * c2 + borne * l2 * l2 + spindle + hand;
        let inner = i1 + m1 * c1 * c1 + (m2 + borne) * l1 * l1;
        let (across, pull) = (outer + k * b.cos(), k * b.sin());
        let (a2, b2, d2, c2) = (acceleration[0], acceleration[1], acceleration[2], acceleration[3]);
        let expected = [
            (inner + across + k * b.cos()) * a2 + across * b2 + hand * c2 - pull * v[1] * (2.0 * v[0] + v[1]),
            across * a2 + outer * b2 + hand * c2 + pull * v[0] * v[0],
            borne * (d2 + GRAVITY),
            hand * (a2 + b2 + c2),
        ];
        for (tau, expected) in tau.iter().zip(expected) {
            assert!((tau - expected).abs() < 1e-11 * (1.0 + expected.abs()), "{tau} is not {expected}");
        }
    }
}

/// A screw turns a motor: what it costs to move is counted along the slide.
#[test]
fn the_drive_of_a_slide_is_counted_along_it() {
    let text = "(links: [(
        slide: [0, 0, 1], limits: (lower: \"0 m\", upper: \"1 m\", speed: \"1 m/s\", acceleration: \"9 m/s^2\"),
        bodies: [(mass: \"10 kg\", com: [0, 0, 0], moi: [0, 0, 0])],
        drive: (
            motor: (inertia: \"1e-4 kg*m^2\", damping: \"2e-4 N*m*s/rad\"), gear: (ratio: 2, lead: \"20 mm\"),
            bearing: (breakaway: \"6 N\", breakaway_velocity: \"1 mm/s\", coulomb: \"5 N\", viscous: \"30 N*s/m\"),
        ),
    )])";
    let desk = Desk::new().with("slide.ron", text);
    let read: Result<RobotDescription, _> =
        parameter(&Sources::new(&desk), Path::new("slide.ron"), &[], "manipulator");
    let robot = read.expect("a description").robot("manipulator").expect("a robot");
    let mut force = [0.0];
    robot.motor_torques(&mut robot.model().data(), &[0.5], &[0.4], &[1.5], &mut force);
    // Two turns of the motor for 20 mm.
    let ratio = 2.0 * std::f64::consts::TAU / 0.02;
    let expected = 10.0 * (1.5 + GRAVITY) + 5.0 + 30.0 * 0.4 + ratio * ratio * (1e-4 * 1.5 + 2e-4 * 0.4);
    assert!((force[0] - expected).abs() < 1e-9 * expected, "{} is not {expected}", force[0]);
}

/// A diagram beside the model with the arm made by `blocks` and `connections`, driven by four sines.
fn driven(blocks: &str, connections: &str) -> Run {
    let sines: String = ["30 N*m", "15 N*m", "40 N", "0.05 N*m"]
        .iter()
        .zip(1..)
        .map(|(size, i)| format!("\"t{i}\": Sine(amplitude: \"{size}\", frequency: \"{} Hz\"),\n", 2 * i))
        .collect();
    let text = format!(
        "Diagram(
            parameters: {{ \"manipulator\": File(\"manipulator.ron\") }},
            simulation: (stop_time: \"0.15 s\", solver: Ode45(rtol: 1e-10, atol: 1e-10), output: Every(\"2 ms\")),
            record: [\"*.*\"],
            blocks: {{ \"world\": World(gravity: [0, 0, -1]), {sines} {blocks} }},
            connections: [{connections}],
        )"
    );
    let path = root().join("diagrams/scara/driven.ron");
    let desk = Desk::new().with(path.to_str().expect("a path"), &text);
    let (compiled, problems) = compile_with(&desk, &path, &[]);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

#[test]
fn the_robot_as_one_block_moves_as_the_chain_of_bodies_and_joints_does() {
    let links = [
        ("[0, 0, 0.35]", "RevoluteJoint(axis: [0, 0, 1], position: 0.2"),
        ("[0.35, 0, 0]", "RevoluteJoint(axis: [0, 0, 1], position: -0.5"),
        ("[0.3, 0, 0]", "PrismaticJoint(axis: [0, 0, 1], position: -0.12"),
        ("[0, 0, 0]", "RevoluteJoint(axis: [0, 0, 1], position: 1"),
    ];
    let (mut chain, mut joined) = (String::new(), vec!["\"world.frame <-> seat1.base\"".to_owned()]);
    for (i, (seat, joint)) in (1..).zip(links) {
        let (limits, body) = (
            format!("manipulator.links[{}].limits", i - 1),
            format!("manipulator.links[{}].bodies[0]", i - 1),
        );
        chain += &format!(
            "\"seat{i}\": Transform(translation: {seat}),
             \"joint{i}\": {joint}, lower: \"{limits}.lower\", upper: \"{limits}.upper\"),
             \"link{i}\": Body(mass: \"{body}.mass\", com: \"{body}.com\", moi: \"{body}.moi\"),\n"
        );
        let input = if i == 3 { "force" } else { "torque" };
        joined.push(format!("\"seat{i}.follower <-> joint{i}.base\", \"t{i}.y -> joint{i}.{input}\""));
        let next = if i == 4 { String::new() } else { format!(" <-> seat{}.base", i + 1) };
        joined.push(format!("\"joint{i}.follower <-> link{i}.frame{next}\""));
    }
    let chain = driven(&chain, &joined.join(", "));
    let mux: String = (1..=4).map(|i| format!("\"t{i}.y -> torque.u{i}\", ")).collect();
    let one = driven(
        "\"arm\": Robot(robot: \"manipulator\", position: [0.2, \"-0.5 rad\", \"-120 mm\", 1]), \"torque\": Mux(inputs: 4),",
        &format!("\"world.frame <-> arm.base\", {mux} \"torque.y -> arm.torque\""),
    );
    for i in 0..4 {
        let moved = column(&one, &format!("arm.q[{i}]"));
        let span = moved.iter().fold(0.0_f64, |m, q| m.max((q - moved[0]).abs()));
        assert!(span > 1e-3, "axis {i} moves by {span}");
        let names = if i == 2 { ["x", "v", "a"] } else { ["q", "w", "a"] };
        for ((one_name, name), tolerance) in ["q", "w", "a"].into_iter().zip(names).zip([1e-9, 1e-8, 1e-6]) {
            let (a, b) = (
                column(&one, &format!("arm.{one_name}[{i}]")),
                column(&chain, &format!("joint{}.{name}", i + 1)),
            );
            let error = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(a.len() == b.len() && error < tolerance, "{name}{i}: {error}");
        }
    }
}

#[test]
fn the_shipped_robot_goes_along_its_move() {
    let bare = run_file(MODEL, &["part=0.0001"]);
    let borne = run_file(MODEL, &[]);
    let largest = |run: &Run, name: &str| column(run, name).iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    // What the controller knows it compensates to the tolerance of the solver; the part of half a kilogram it does not.
    assert!(largest(&bare, "path.distance") < 1e-4, "{}", largest(&bare, "path.distance"));
    let off = largest(&borne, "path.distance");
    assert!(off > 5e-4 && off < 1e-2, "{off}");
    // At rest the part pulls against the spring of the error: m g = M w^2 e with all that the slide bears.
    let sag = column(&borne, "axes.off[2]").last().copied().expect("rows");
    let expected = 0.5 * GRAVITY / (1.3 * 60.0 * 60.0);
    assert!((sag - expected).abs() < 0.02 * expected, "{sag} is not {expected}");
    // The lines are straight and vertical.
    let rows = borne.time.len();
    let at = |axis: usize| column(&borne, &format!("place.set[{axis}]"));
    let lowest = at(2).iter().copied().fold(f64::INFINITY, f64::min);
    assert!((lowest - 0.05).abs() < 1e-6, "{lowest}");
    for row in (0..rows).filter(|row| at(2)[*row] < 0.1799) {
        assert!(
            (at(0)[row] - 0.380_986_871).abs() < 1e-6 && (at(1)[row] - 0.415_149_376).abs() < 1e-6,
            "{row}"
        );
    }
}

#[test]
fn lengths_and_angles_are_told_apart_with_a_remedy() {
    let refused = |link: &str| {
        let desk = Desk::new().with("arm.ron", &format!("(links: [({link})])"));
        let read: Result<RobotDescription, _> =
            parameter(&Sources::new(&desk), Path::new("arm.ron"), &[], "manipulator");
        match read {
            Err(problems) => problems[0].message.clone(),
            Ok(read) => {
                let error = read.robot("manipulator").expect_err("no robot");
                format!("{}: {}; {}", error.param, error.message, error.help.unwrap_or_default())
            }
        }
    };
    let limits = "limits: (lower: \"0 m\", upper: \"1 m\", speed: \"1 m/s\", acceleration: \"1 m/s^2\")";
    expect_test::expect![[r#"
        manipulator.links[0].limits: axis 1 turns, but this has the unit of an axis that slides; give it with rad or deg in the place of m, such as 30 deg, 2 rad/s or 50 N*m
        manipulator.links[0]: axis 1 both turns and slides; give `axis`, about which it turns, or `slide`, along which it slides
        manipulator.links[0]: axis 1 neither turns nor slides; give `axis`, about which it turns, or `slide`, along which it slides
        manipulator.links[0].start: axis 1 slides, but this has the unit of an axis that turns; give it with m in the place of rad, such as 100 mm, 0.2 m/s or 50 N
        manipulator.links[0].start: the axis starts at 2 m, outside 0 m to 1 m; correct `links[0].start` in the description of the robot
        manipulator.links[0].drive.gear.lead: a motor that moves a slide needs a lead; give the travel for one turn of screw or pinion, such as lead: "10 mm"
        manipulator.links[0].drive.bearing.coulomb: axis 1 slides, but this has the unit of an axis that turns; give it with m in the place of rad, such as 100 mm, 0.2 m/s or 50 N
        `upper` is that of an axis that turns, `lower` that of one that slides
        expected a value in rad or m, found one in kg
    "#]].assert_eq(
        &[
            refused(&format!("axis: [0, 0, 1], {limits}")),
            refused(&format!("axis: [0, 0, 1], slide: [0, 0, 1], {limits}")),
            refused(limits),
            refused(&format!("slide: [0, 0, 1], {limits}, start: \"10 deg\"")),
            refused(&format!("slide: [0, 0, 1], {limits}, start: \"2 m\"")),
            refused(&format!("slide: [0, 0, 1], {limits}, drive: (motor: (inertia: \"1 kg*m^2\"))")),
            refused(&format!(
                "slide: [0, 0, 1], {limits}, drive: (bearing: (breakaway: \"1 N*m\", breakaway_velocity: 1, coulomb: \"1 N*m\", viscous: 0))"
            ).replace("breakaway: \"1 N*m\"", "breakaway: \"1 N\"")),
            refused("slide: [0, 0, 1], limits: (lower: \"0 m\", upper: \"1 rad\", speed: 1, acceleration: 1)"),
            refused("slide: [0, 0, 1], limits: (lower: \"0 kg\", upper: \"1 m\", speed: 1, acceleration: 1)"),
        ]
        .map(|line| line + "\n")
        .concat(),
    );
}
