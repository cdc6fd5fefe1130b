//! Robots as one description, against the same arms made of blocks.

use std::path::Path;

use blocksim_blocks::robotics::RobotDescription;
use blocksim_diagram::{Sources, parameter};
use blocksim_robotics::robot::Robot;
use blocksim_tests::{Desk, Run, compile_file, compile_with, root, run};
use expect_test::expect;

const MODEL: &str = "diagrams/irb2600/irb2600.ron";

/// The robot of the flagship, with overrides.
fn flagship(overrides: &[&str]) -> Robot {
    let (desk, overrides) = (Desk::new(), overrides.iter().map(|o| (*o).to_owned()).collect::<Vec<_>>());
    let sources = Sources::new(&desk);
    let description: RobotDescription = parameter(&sources, &root().join(MODEL), &overrides, "manipulator")
        .unwrap_or_else(|problems| panic!("{problems:?}"));
    description.robot("manipulator").unwrap_or_else(|error| panic!("{error:?}"))
}

#[test]
fn the_tool_is_where_the_data_sheet_says() {
    let robot = flagship(&[]);
    assert_eq!((robot.axes(), robot.name()), (6, "ABB IRB 2600-12/1.85"));
    let mut data = robot.model().data();
    let tcp = robot.tcp(&mut data, &[0.0; 6]);
    // The flange at home (1.030, 0, 1.460) m, the tool 119.5 mm below and 352 mm in front of it.
    assert!((tcp.translation - nalgebra::Vector3::new(1.382, 0.0, 1.3405)).norm() < 1e-12, "{tcp:?}");
    assert!(robot.closed_form().is_some(), "an ortho-parallel arm with a spherical wrist");
    assert!((robot.limits()[4].upper.to_degrees() - 120.0).abs() < 1e-12);
    assert_eq!(robot.tcp_limits().speed, 2.5);
}

/// The dynamics of the description against those of the diagram: what its joints measure while the robot moves is the
/// torque that the inverse dynamics asks for.
#[test]
fn the_joints_of_the_diagram_measure_what_inverse_dynamics_asks_for() {
    let robot = flagship(&[]);
    let (compiled, problems) = compile_file(MODEL, &["drive=torque"]);
    let mut schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    schedule.settings.stop_time = 1.3;
    let run = run(schedule);
    assert!(run.error.is_none(), "{:?}", run.error);
    let column = |name: &str| {
        let at = run.recorded.iter().position(|recorded| recorded.path == name);
        &run.columns[at.unwrap_or_else(|| panic!("{name} is recorded"))]
    };
    let of = |group: &str| -> Vec<&Vec<f64>> {
        let scope = |axis: usize| if axis <= 3 { "principal" } else { "minor" };
        (1..=6).map(|axis| column(&format!("measurements/{group}/{}.axis{axis}", scope(axis)))).collect()
    };
    let q: Vec<_> = (1..=6).map(|axis| column(&format!("measurements/angles/axis{axis}.actual"))).collect();
    let [v, a, measured] = ["velocities", "accelerations", "torques"].map(of);
    let mut data = robot.model().data();
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for row in 0..run.time.len() {
        let at = |columns: &[&Vec<f64>]| -> Vec<f64> { columns.iter().map(|column| column[row]).collect() };
        let mut tau = [0.0; 6];
        robot.joint_torques(&mut data, &at(&q), &at(&v), &at(&a), &mut tau);
        for (tau, measured) in tau.iter().zip(at(&measured)) {
            worst = worst.max((tau - measured).abs());
            largest = largest.max(measured.abs());
        }
    }
    assert!(run.time.len() > 1000 && largest > 500.0, "{} rows, {largest} N*m", run.time.len());
    assert!(worst < 1e-9 * largest, "{worst} N*m of {largest}");
}

#[test]
fn what_makes_no_robot_is_told_with_the_member_and_a_remedy() {
    let refused = |text: &str| {
        let desk = Desk::new().with("arm.ron", text);
        let sources = Sources::new(&desk);
        let read: Result<RobotDescription, _> = parameter(&sources, Path::new("arm.ron"), &[], "manipulator");
        match read {
            Err(problems) => problems[0].message.clone(),
            Ok(read) => {
                let error = read.robot("manipulator").expect_err("no robot");
                format!("{}: {}; {}", error.param, error.message, error.help.unwrap_or_default())
            }
        }
    };
    let link = |changes: &str| {
        let limits =
            "limits: (lower: \"-1 rad\", upper: \"1 rad\", speed: \"1 rad/s\", acceleration: \"1 rad/s^2\")";
        refused(&format!("(links: [(axis: [0, 0, 1], {limits}, {changes})])"))
    };
    expect![[r#"
        manipulator.links: the robot has no links; give at least one link with an axis
        `limits` is missing
        `tools` is not known here
        manipulator.links[0].start: the axis starts at 1.5707963267948966 rad, outside -1 rad to 1 rad; correct `links[0].start` in the description of the robot
        manipulator.links[0].start: axis 1 turns, but this has the unit of an axis that slides; give it with rad or deg in the place of m, such as 30 deg, 2 rad/s or 50 N*m
        manipulator.links[0].drive.gear: 10 lobes and 10 pins give no reduction; a disc has at least one lobe, its ring more pins than it has lobes
        manipulator.links[0].drive.gear.efficiency_forward: `drive.gear.efficiency_forward` is 1.2; it must be above 0 and at most 1; correct `links[0].drive.gear.efficiency_forward` in the description of the robot
        manipulator.links[0].bodies[0]: the mass is -1 kg, it must not be negative; moi are Ixx, Iyy, Izz, poi are Iyz, Izx, Ixy of the tensor about the centre of mass
        expected a list of three numbers, found a list of 2
        manipulator.links[0].bodies[0]: no rigid body has the principal moments 0.000000, 0.000000 and 1.000000 kg m²: the largest must not exceed the sum of the others; is the tensor about the centre of mass, with products of the right sign?; moi are Ixx, Iyy, Izz, poi are Iyz, Izx, Ixy of the tensor about the centre of mass
    "#]].assert_eq(
        &[
            refused("(links: [])"),
            refused("(links: [(axis: [0, 0, 1])])"),
            refused("(links: [], tools: 1)"),
            link("start: \"90 deg\""),
            link("start: \"1 m\""),
            link("drive: (gear: (disc_teeth: 10, ring_teeth: 10))"),
            link("drive: (gear: (efficiency_forward: 1.2))"),
            link("bodies: [(mass: \"-1 kg\", com: [0, 0, 0], moi: [0, 0, 0])]"),
            link("bodies: [(mass: \"1 kg\", com: [0, 0], moi: [0, 0, 0])]"),
            link("bodies: [(mass: \"1 kg\", com: [0, 0, 0], moi: [\"1 kg*m^2\", 0, 0])]"),
        ]
        .map(|line| line + "\n")
        .concat(),
    );
}

#[test]
fn a_parameter_that_a_diagram_lacks_is_told() {
    let desk = Desk::new();
    let read: Result<RobotDescription, _> =
        parameter(&Sources::new(&desk), &root().join(MODEL), &[], "manipulater");
    assert_eq!(read.expect_err("no such").remove(0).help.as_deref(), Some("did you mean `manipulator`?"));
}

/// A diagram beside the flagship with the arm made by `blocks` and `connections`, driven by six sines.
fn driven(blocks: &str, connections: &str) -> Run {
    let sines: String = (1..=6)
        .map(|i| {
            let amplitude = [300, 800, 400, 30, 20, 5][i - 1];
            format!("\"t{i}\": Sine(amplitude: \"{amplitude} N*m\", frequency: \"{i} Hz\"),\n")
        })
        .collect();
    let text = format!(
        "Diagram(
            parameters: {{ \"robot\": File(\"../../params/irb2600.ron\"), \"manipulator\": File(\"manipulator.ron\") }},
            simulation: (stop_time: \"0.1 s\", solver: Ode45(rtol: 1e-10, atol: 1e-10), output: Every(\"2 ms\")),
            record: [\"*.*\"],
            blocks: {{ \"world\": World(gravity: \"manipulator.gravity\"), {sines} {blocks} }},
            connections: [{connections}],
        )"
    );
    let path = root().join("diagrams/irb2600/driven.ron");
    let desk = Desk::new().with(path.to_str().expect("a path"), &text);
    let (compiled, problems) = compile_with(&desk, &path, &[]);
    let run = run(compiled.schedule.unwrap_or_else(|| panic!("{problems}")));
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

fn column<'r>(run: &'r Run, name: &str) -> &'r [f64] {
    let at = run.recorded.iter().position(|recorded| recorded.path == name);
    let names = || run.recorded.iter().map(|recorded| recorded.path.as_str()).collect::<Vec<_>>();
    &run.columns[at.unwrap_or_else(|| panic!("{name} is not among {:?}", names()))]
}

/// Largest difference of two columns.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_robot_as_one_block_moves_as_the_chain_of_bodies_and_joints_does() {
    let directions = ["[0, 0, 1]", "[0, 1, 0]", "[0, 1, 0]", "[1, 0, 0]", "[0, 1, 0]", "[1, 0, 0]"];
    let mut chain = String::new();
    let mut joined = vec!["\"world.frame <-> seat1.base\"".to_owned()];
    for i in 1..=6 {
        chain += &format!(
            "\"seat{i}\": Transform(translation: \"robot.geometry.axis{i}\"),
             \"joint{i}\": RevoluteJoint(axis: {}, position: 0, velocity: 0, lower: \"robot.axis{i}.limits.lower\", upper: \"robot.axis{i}.limits.upper\"),
             \"link{i}\": Body(mass: \"robot.link{i}.mass\", com: \"robot.link{i}.com\", moi: \"robot.link{i}.moi\", poi: \"robot.link{i}.poi\"),\n",
            directions[i - 1]
        );
        joined.push(format!("\"seat{i}.follower <-> joint{i}.base\", \"t{i}.y -> joint{i}.torque\""));
        let next = if i == 6 { "flange.base".to_owned() } else { format!("seat{}.base", i + 1) };
        joined.push(format!("\"joint{i}.follower <-> link{i}.frame <-> {next}\""));
    }
    chain += "\"flange\": Transform(rpy: [0, \"90 deg\", 0]),
              \"torch\": Body(mass: \"robot.torch.mass\", com: \"robot.torch.com\", moi: \"robot.torch.moi\", poi: \"robot.torch.poi\"),";
    joined.push("\"flange.follower <-> torch.frame\"".to_owned());
    let chain = driven(&chain, &joined.join(", "));

    let mux: String = (1..=6).map(|i| format!("\"t{i}.y -> torque.u{i}\", ")).collect();
    let one = driven(
        "\"arm\": Robot(robot: \"manipulator\"), \"torque\": Mux(inputs: 6), \"q\": Demux(outputs: 6), \"w\": Demux(outputs: 6),
         \"a\": Demux(outputs: 6),",
        &format!("\"world.frame <-> arm.base\", {mux} \"torque.y -> arm.torque\", \"arm.q -> q.u\", \"arm.w -> w.u\", \"arm.a -> a.u\""),
    );
    for i in 1..=6 {
        let moved = column(&one, &format!("q.y{i}"));
        assert!(moved.iter().fold(0.0_f64, |m, q| m.max(q.abs())) > 1e-3, "axis {i} moves");
        for (name, tolerance) in [("q", 1e-9), ("w", 1e-8), ("a", 1e-6)] {
            let error =
                apart(column(&one, &format!("{name}.y{i}")), column(&chain, &format!("joint{i}.{name}")));
            assert!(error < tolerance, "{name}{i}: {error}");
        }
    }
}

#[test]
fn the_blocks_of_the_robot_agree_with_each_other_while_it_moves() {
    let mux: String = (1..=6).map(|i| format!("\"t{i}.y -> torque.u{i}\", ")).collect();
    let run = driven(
        "\"arm\": Robot(robot: \"manipulator\", position: [0.1, 0.2, -0.3, 0.4, 0.5, 0.6]), \"torque\": Mux(inputs: 6),
         \"forward\": ForwardKinematics(robot: \"manipulator\"), \"inverse\": InverseKinematics(robot: \"manipulator\"),
         \"dynamics\": InverseDynamics(robot: \"manipulator\"), \"gravity\": GravityCompensation(robot: \"manipulator\"),
         \"jacobian\": Jacobian(robot: \"manipulator\"), \"at_rest\": InverseDynamics(robot: \"manipulator\"),
         \"still\": Constant(value: [\"0 rad/s\", \"0 rad/s\", \"0 rad/s\", \"0 rad/s\", \"0 rad/s\", \"0 rad/s\"]),
         \"steady\": Constant(value: [\"0 rad/s^2\", \"0 rad/s^2\", \"0 rad/s^2\", \"0 rad/s^2\", \"0 rad/s^2\", \"0 rad/s^2\"]),",
        &format!(
            "\"world.frame <-> arm.base\", {mux} \"torque.y -> arm.torque\",
             \"arm.q -> forward.q, dynamics.q, gravity.q, jacobian.q, inverse.near, at_rest.q\",
             \"forward.p -> inverse.p\", \"forward.zyx -> inverse.zyx\", \"arm.w -> dynamics.qd\", \"arm.a -> dynamics.qdd\",
             \"still.y -> at_rest.qd\", \"steady.y -> at_rest.qdd\""
        ),
    );
    let vector = |name: &str, n: usize| -> Vec<&[f64]> {
        (0..n).map(|i| column(&run, &format!("{name}[{i}]"))).collect()
    };
    let close = |a: &str, b: &str, tolerance: f64| {
        for (i, (a, b)) in vector(a, 6).iter().zip(vector(b, 6)).enumerate() {
            assert!(apart(a, b) < tolerance, "{i}: {}", apart(a, b));
        }
    };
    assert!(column(&run, "inverse.solved").iter().all(|solved| *solved == 1.0));
    close("inverse.q", "arm.q", 1e-9);
    close("dynamics.tau", "arm.tau", 1e-9);
    close("gravity.tau", "at_rest.tau", 1e-9);
    // The velocity of the tool by the Jacobian against central differences of its position.
    let (p, j, w) = (vector("forward.p", 3), vector("jacobian.j", 36), vector("arm.w", 6));
    let h = 0.002;
    for row in 1..run.time.len() - 1 {
        for axis in 0..3 {
            let by_jacobian: f64 = (0..6).map(|k| j[6 * (3 + axis) + k][row] * w[k][row]).sum();
            let by_difference = (p[axis][row + 1] - p[axis][row - 1]) / (2.0 * h);
            assert!(
                (by_jacobian - by_difference).abs() < 0.02,
                "{row}, {axis}: {by_jacobian} {by_difference}"
            );
        }
    }
}
