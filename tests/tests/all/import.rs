//! Imported mechanisms: their diagrams compile, and move as the same bodies do without a diagram.

use std::path::Path;

use blocksim_import::{Files, Mechanism, Provenance, diagram, model, parameters, urdf};
use blocksim_multibody::{Inertia, Joint, Model, ModelBuilder, Placement, bias, crba, rnea};
use blocksim_tests::{Desk, compile_with, root, run};

const FILES: Files = Files { source: "a.urdf", diagram: "a.ron", parameters: "p.ron", robot: None };

fn read(name: &str) -> Mechanism {
    let file = root().join("tests/data").join(name);
    let bytes = std::fs::read(&file).expect("a file of the tests");
    urdf::read(&file, &bytes, false).unwrap_or_else(|faults| panic!("{}", faults[0]))
}

/// Numbers between -1 and 1, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn list(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// Accelerations at the start: `change` brings the text of the diagram into the wanted state.
fn accelerations(mechanism: &Mechanism, change: impl Fn(String) -> String, signals: &[&str]) -> Vec<f64> {
    let provenance =
        Provenance { source: "a.urdf".into(), fingerprint: "0".into(), date: "2026-11-21".into() };
    let text = diagram(mechanism, &FILES);
    let (compiled, problems) = compile_with(&Desk::new().with("a.ron", &text), Path::new("a.ron"), &[]);
    assert!(compiled.schedule.is_none() && problems.contains("missing_file"), "{problems}");
    let text = change(text)
        .replace("stop_time: \"1 s\"", "stop_time: \"1 us\"")
        .replace("    blocks: {\n", "    record: [\"*.*\"],\n    blocks: {\n");
    let desk = Desk::new().with("a.ron", &text).with("p.ron", &parameters(mechanism, None, &provenance));
    let (compiled, problems) = compile_with(&desk, Path::new("a.ron"), &[]);
    let schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}{text}"));
    assert_eq!(problems, "");
    let run = run(schedule);
    signals.iter().map(|signal| run.column(signal)[0]).collect()
}

/// The arm as a table, typed for this test: origin, axis, mass, centre of mass, moments, products of each link.
fn irb2600() -> Model {
    type Row = ([f64; 3], [f64; 3], f64, [f64; 3], [f64; 3], [f64; 3]);
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    #[rustfmt::skip]
    let rows: [Row; 6] = [
        ([0.0, 0.0, 0.445], Z, 69.88, [0.04062, 0.00784, -0.0671], [1.2154, 1.7702, 1.6481], [-0.007373, -0.1382, -0.03357]),
        ([0.15, 0.0, 0.0], Y, 43.28, [6e-5, -0.17255, 0.41736], [3.062, 3.1148, 0.13203], [0.01814, 0.0007109, 0.0]),
        ([0.0, 0.0, 0.9], Y, 65.11, [0.04366, 0.01391, 0.07441], [0.80886, 1.1076, 0.94861], [0.02654, -0.04758, 0.02141]),
        ([0.0, 0.0, 0.115], X, 16.62, [0.60555, 0.00114, 0.00039], [0.040422, 0.48489, 0.49437], [3.74e-5, -0.0003098, -0.003736]),
        ([0.795, 0.0, 0.0], Y, 0.99, [-0.00035, 6e-5, 0.00114], [0.00081187, 0.0014203, 0.0009074], [0.0; 3]),
        ([0.085, 0.0, 0.0], X, 0.24, [-0.04109, 0.0, -0.0001], [5.8863e-5, 0.00035632, 0.00035691], [0.0; 3]),
    ];
    let mut builder = ModelBuilder::new();
    let mut parent = None;
    for (origin, axis, mass, com, moi, poi) in rows {
        let inertia = Inertia::from_moments(mass, com, moi, poi).expect("a body");
        let place = Placement::from_translation(origin);
        parent = Some(builder.add_body(parent, Joint::revolute(axis), place, inertia).expect("a link"));
    }
    builder.build()
}

#[test]
fn the_imported_robot_has_the_mass_matrix_and_bias_of_the_table() {
    let imported = model(&read("irb2600.urdf")).expect("possible masses").expect("a tree").model;
    let table = irb2600();
    let mut random = Random(7);
    for _ in 0..50 {
        let (q, v) = (random.list(6), random.list(6));
        let of = |model: &Model| {
            let (mut m, mut h, mut data) = (vec![0.0; 36], vec![0.0; 6], model.data());
            crba(model, &mut data, &q, &mut m);
            bias(model, &mut data, &q, &v, &mut h);
            m.into_iter().chain(h).collect::<Vec<f64>>()
        };
        for (a, b) in of(&imported).iter().zip(of(&table)) {
            assert!((a - b).abs() <= 1e-10 * b.abs().max(1.0), "{a} is not {b}");
        }
    }
}

#[test]
fn the_diagram_of_the_robot_accelerates_as_inverse_dynamics_of_the_table_demand() {
    let mechanism = read("irb2600.urdf");
    let table = irb2600();
    let mut random = Random(11);
    for _ in 0..5 {
        let (q, v, tau) = (random.list(6), random.list(6), random.list(6));
        let change = |mut text: String| {
            for i in 0..6 {
                let joint = format!("joint_{}", i + 1);
                text = text
                    .replace(
                        &format!("position: \"model.joints.{joint}.position\""),
                        &format!("position: \"{} rad\", velocity: \"{} rad/s\"", q[i], v[i]),
                    )
                    .replace(
                        "    blocks: {\n",
                        &format!(
                            "    blocks: {{\n        \"t{i}\": Constant(value: \"{} N*m\"),\n",
                            100.0 * tau[i]
                        ),
                    )
                    .replace(
                        "    connections: [\n",
                        &format!("    connections: [\n        \"t{i}.y -> {joint}.torque\",\n"),
                    );
            }
            text
        };
        let signals = ["joint_1.a", "joint_2.a", "joint_3.a", "joint_4.a", "joint_5.a", "joint_6.a"];
        let a = accelerations(&mechanism, change, &signals);
        // Torques of the wrist are small beside its accelerations times the rest of the arm.
        let (mut needed, mut data) = (vec![0.0; 6], table.data());
        rnea(&table, &mut data, &q, &v, &a, &mut needed);
        for (needed, tau) in needed.iter().zip(&tau) {
            let scale = a.iter().fold(1.0_f64, |most, a| most.max(a.abs()));
            assert!(
                (needed - 100.0 * tau).abs() < 1e-10 * scale.max(1000.0),
                "{needed} is not {}",
                100.0 * tau
            );
        }
    }
}

#[test]
fn joints_of_every_kind_accelerate_as_the_same_bodies_without_a_diagram() {
    let mechanism = read("kinds.urdf");
    let bodies = model(&mechanism).expect("possible masses").expect("a tree").model;
    assert_eq!((bodies.nq(), bodies.dof()), (13, 12));
    let mut random = Random(3);
    for _ in 0..5 {
        // shoulder, feed, wrist; table x, y, angle; flight x, y, z and a quaternion from roll, pitch and yaw
        let (q, v, rpy) = (random.list(9), random.list(12), random.list(3));
        let list = |values: &[f64], unit: &str| {
            let items: Vec<String> = values.iter().map(|x| format!("\"{x} {unit}\"")).collect();
            format!("[{}]", items.join(", "))
        };
        let change = |text: String| {
            text.replace(
                "\"model.joints.shoulder.position\"",
                &format!("\"{} rad\", velocity: \"{} rad/s\"", q[0], v[0]),
            )
            .replace(
                "\"model.joints.feed.position\"",
                &format!("\"{} m\", velocity: \"{} m/s\"", 0.1 + 0.1 * q[1], v[1]),
            )
            .replace(
                "\"model.joints.wrist.position\"",
                &format!("\"{} rad\", velocity: \"{} rad/s\"", q[2], v[2]),
            )
            .replace(
                "PlanarJoint",
                &format!(
                    "PlanarJoint(position: {}, velocity: {}, angle: \"{} rad\", speed: \"{} rad/s\")",
                    list(&q[3..5], "m"),
                    list(&v[3..5], "m/s"),
                    q[5],
                    v[5]
                ),
            )
            .replace(
                "FreeJoint",
                &format!(
                    "FreeJoint(position: {}, velocity: {}, rpy: {}, spin: {})",
                    list(&q[6..9], "m"),
                    list(&v[6..9], "m/s"),
                    list(&rpy, "rad"),
                    list(&v[9..12], "rad/s")
                ),
            )
        };
        let signals = [
            "shoulder.a",
            "feed.a",
            "wrist.a",
            "table.a[0]",
            "table.a[1]",
            "table.alpha",
            "flight.a[0]",
            "flight.a[1]",
            "flight.a[2]",
            "flight.alpha[0]",
            "flight.alpha[1]",
            "flight.alpha[2]",
        ];
        let a = accelerations(&mechanism, change, &signals);
        let turn = nalgebra::UnitQuaternion::from_euler_angles(rpy[0], rpy[1], rpy[2]);
        let mut positions = q.clone();
        positions[1] = 0.1 + 0.1 * q[1];
        positions.extend([turn.w, turn.i, turn.j, turn.k]);
        let (mut needed, mut data) = (vec![0.0; 12], bodies.data());
        rnea(&bodies, &mut data, &positions, &v, &a, &mut needed);
        let mut expected = [0.0; 12];
        expected[0] = -0.4 * v[0];
        for (i, (needed, expected)) in needed.iter().zip(expected).enumerate() {
            assert!((needed - expected).abs() < 1e-10, "{}: {needed} is not {expected}", signals[i]);
        }
    }
}

/// The crane typed as a chain of bodies in the frames of the joints, in m and kg.
fn crane() -> Model {
    use nalgebra::{Matrix3, Vector3};
    let mut builder = ModelBuilder::new();
    // Tensor elements Ixx, Iyy, Izz, Iyz, Izx, Ixy in g mm², com in mm.
    let body = |grams: f64, com: [f64; 3], i: [f64; 6]| {
        let i = i.map(|x| x * 1e-9);
        let com = com.map(|x| 1e-3 * x);
        Inertia::from_moments(1e-3 * grams, com, [i[0], i[1], i[2]], [i[3], i[4], i[5]]).expect("a body")
    };
    let boom = Placement {
        rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0),
        translation: Vector3::new(0.0, 0.05, 0.21),
    };
    let boom_mass = body(4000.0, [300.0, 10.0, -5.0], [3e6, 1.3e8, 1.305e8, 2e5, -3e5, 4e5]);
    let hinge = builder.add_body(None, Joint::revolute([0.0, 0.0, 1.0]), boom, boom_mass).expect("the boom");
    let trolley_mass = body(900.0, [0.0, 5.0, -20.0], [5e5, 6e5, 7e5, 1e4, 2e4, -3e4]);
    // The trolley stands parallel to the world.
    let at = Placement::from_translation([0.4, 0.05, 0.15]);
    let trolley = builder
        .add_body(Some(hinge), Joint::prismatic([1.0, 0.0, 0.0]), boom.inverse() * at, trolley_mass)
        .expect("the trolley");
    let hook_mass = body(500.0, [3.0, 0.0, -60.0], [6e5, 6e5, 1e5, 0.0, 1e4, 0.0]);
    // The pin lies along x of the trolley: the third column of its frame.
    let pin = Placement::from_translation([0.0, 0.0, -0.05]);
    builder.add_body(Some(trolley), Joint::revolute([1.0, 0.0, 0.0]), pin, hook_mass).expect("the hook");
    builder.build()
}

#[test]
fn constraints_of_an_assembly_become_the_joints_that_they_leave() {
    use blocksim_import::{Motion, simscape};
    let file = root().join("tests/data/crane.xml");
    let bytes = std::fs::read(&file).expect("a file of the tests");
    let mechanism = simscape::read(&file, &bytes).unwrap_or_else(|faults| panic!("{}", faults[0]));
    let kinds: Vec<(&str, bool)> =
        mechanism.joints.iter().map(|joint| (joint.name.as_str(), joint.motion == Motion::Weld)).collect();
    let expected = [
        ("base_1_weld", true),
        ("cover_1_weld", true),
        ("world_to_boom_1", false),
        ("boom_1_to_trolley_1", false),
        ("hook_pin", false),
    ];
    assert_eq!(kinds, expected);
    assert_eq!(mechanism.notes, [""; 0]);
    let typed = crane();
    let mut random = Random(5);
    for _ in 0..5 {
        let (q, v) = (random.list(3), random.list(3));
        let names = ["world_to_boom_1", "boom_1_to_trolley_1", "hook_pin"];
        let change = |mut text: String| {
            for (i, (name, unit)) in names.iter().zip(["rad", "m", "rad"]).enumerate() {
                text = text.replace(
                    &format!("position: \"model.joints.{name}.position\""),
                    &format!("position: \"{} {unit}\", velocity: \"{} {unit}/s\"", q[i], v[i]),
                );
            }
            text
        };
        let a = accelerations(
            &mechanism,
            change,
            &names.map(|name| format!("{name}.a")).each_ref().map(String::as_str),
        );
        let (mut needed, mut data) = (vec![0.0; 3], typed.data());
        rnea(&typed, &mut data, &q, &v, &a, &mut needed);
        for (name, needed) in names.iter().zip(&needed) {
            assert!(needed.abs() < 1e-10, "{name}: {needed}");
        }
    }
}

#[test]
fn imported_shapes_are_seen_on_the_bodies_that_they_belong_to() {
    let mechanism = read("kinds.urdf");
    let provenance =
        Provenance { source: "a.urdf".into(), fingerprint: "0".into(), date: "2026-11-21".into() };
    let desk = Desk::new()
        .with("a.ron", &diagram(&mechanism, &FILES))
        .with("p.ron", &parameters(&mechanism, None, &provenance));
    let (compiled, problems) = compile_with(&desk, Path::new("a.ron"), &[]);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{problems}"));
    let expected: usize = mechanism.bodies.iter().map(|body| body.shapes.len()).sum();
    assert_eq!(scene.shapes.len(), expected);
    let arm: Vec<_> = scene.shapes.iter().filter(|shape| shape.owner == "upper_arm").collect();
    let forms: Vec<_> = arm.iter().map(|shape| shape.shape.form.clone()).collect();
    let cylinder = blocksim_scene::Form::Cylinder { radius: 0.05, length: 0.4 };
    assert_eq!(forms, [cylinder, blocksim_scene::Form::Box { size: [0.1, 0.1, 0.5] }]);
    assert!(arm[0].shape.is_visual() && !arm[0].shape.collides() && arm[1].shape.collides());
    assert_eq!(arm[0].shape.colour, Some([0.5, 0.5, 0.5, 1.0]));
    // Turned about the axis of the shoulder, 0.2 m up the arm.
    let shoulder = Placement::from_rpy([0.1, 0.2, 0.5], [0.1, 0.2, 0.3]);
    let turned = shoulder * Placement::from_axis_angle([0.0; 3], [0.3, 0.9, -0.2], 0.7);
    let signals = scene.signals();
    let mut positions = scene.start();
    let at = signals.iter().position(|name| *name == "shoulder.q").expect("the shoulder");
    positions[at] = 0.7;
    let found = scene.poses(&positions)[arm[0].body] * arm[0].shape.place;
    let expected = turned * Placement::from_translation([0.0, 0.0, 0.2]);
    assert!((found.translation - expected.translation).norm() < 1e-12, "{found:?}");
    assert!((found.rotation - expected.rotation).abs().max() < 1e-12, "{found:?}");
}

/// The description of the robot in an imported diagram, and what it assumes.
fn described(
    mechanism: &Mechanism,
    tip: Option<&str>,
) -> (blocksim_blocks::robotics::RobotDescription, Vec<String>) {
    use blocksim_import::{chain, robot};
    let chain = chain(mechanism, tip).expect("a chain of axes");
    let files = Files { robot: Some("r.ron"), ..FILES };
    let (text, assumed) = robot(mechanism, &chain, &files);
    let provenance =
        Provenance { source: "a.urdf".into(), fingerprint: "0".into(), date: "2026-11-21".into() };
    let desk = Desk::new()
        .with("a.ron", &diagram(mechanism, &files))
        .with("p.ron", &parameters(mechanism, Some(&chain), &provenance))
        .with("r.ron", &text);
    let (compiled, problems) = compile_with(&desk, Path::new("a.ron"), &[]);
    assert!(compiled.schedule.is_some() && problems.is_empty(), "{problems}");
    let sources = blocksim_diagram::Sources::new(&desk);
    let read = blocksim_diagram::parameter(&sources, Path::new("a.ron"), &[], "manipulator");
    (read.unwrap_or_else(|problems| panic!("{problems:?}\n{text}")), assumed)
}

#[test]
fn the_imported_description_has_the_kinematics_and_dynamics_of_the_one_that_ships() {
    use blocksim_blocks::robotics::RobotDescription;
    let disk = Desk::new();
    let sources = blocksim_diagram::Sources::new(&disk);
    let file = root().join("diagrams/irb2600/irb2600.ron");
    let mut ships: RobotDescription =
        blocksim_diagram::parameter(&sources, &file, &[], "manipulator").expect("the description");
    let (imported, assumed) = described(&read("irb2600.urdf"), None);
    assert_eq!(assumed, ["accelerations", "how fast the tool may be"]);
    // The file has no torch, and gravity is that of the standard.
    ships.load.clear();
    ships.tool = Default::default();
    ships.gravity = imported.gravity;
    let [ships, imported] = [ships, imported].map(|description| description.robot("robot").expect("a robot"));
    assert!(imported.closed_form().is_some(), "inverse kinematics in closed form");
    for (a, b) in imported.limits().iter().zip(ships.limits()) {
        let gaps = [a.lower - b.lower, a.upper - b.upper, a.speed - b.speed];
        assert!(gaps.iter().all(|gap| gap.abs() < 1e-9), "{a:?} is not {b:?}");
    }
    let mut random = Random(17);
    let (mut one, mut other) = (imported.model().data(), ships.model().data());
    for _ in 0..50 {
        let (q, v, a) = (random.list(6), random.list(6), random.list(6));
        let gap = imported.tcp(&mut one, &q).translation - ships.tcp(&mut other, &q).translation;
        assert!(gap.norm() < 1e-9, "{gap}");
        let (mut needed, mut expected) = (vec![0.0; 6], vec![0.0; 6]);
        imported.joint_torques(&mut one, &q, &v, &a, &mut needed);
        ships.joint_torques(&mut other, &q, &v, &a, &mut expected);
        for (needed, expected) in needed.iter().zip(&expected) {
            assert!(
                (needed - expected).abs() <= 1e-9 * expected.abs().max(1.0),
                "{needed} is not {expected}"
            );
        }
    }
}

#[test]
fn a_chain_through_welds_and_turned_frames_is_described_as_it_is_built() {
    use blocksim_import::chain;
    // Welds before, between and behind the axes, a body on a weld, and two fingers that count as fixed.
    let text = r#"<robot name="welded">
  <link name="world"/>
  <joint name="stand" type="fixed"><parent link="world"/><child link="base"/><origin xyz="1 2 0.5" rpy="0.1 0.2 0.3"/></joint>
  <link name="base"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="one"/><origin xyz="0 0.1 0.4" rpy="0.3 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1" effort="1"/><dynamics damping="0.7"/></joint>
  <link name="one"><inertial><origin xyz="0.1 0 0.2" rpy="0.5 0 0"/><mass value="3"/>
    <inertia ixx="0.05" ixy="0.002" ixz="-0.001" iyy="0.06" iyz="0.003" izz="0.03"/></inertial></link>
  <joint name="bend" type="fixed"><parent link="one"/><child link="elbow"/><origin xyz="0.2 0 0.1" rpy="0 0.7 0"/></joint>
  <link name="elbow"><inertial><origin xyz="0 0.05 0"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0.001" ixz="0" iyy="0.02" iyz="0" izz="0.015"/></inertial></link>
  <joint name="b" type="continuous"><parent link="elbow"/><child link="two"/><origin xyz="0.3 0 0" rpy="0 0 0.4"/>
    <axis xyz="0 1 0"/></joint>
  <link name="two"><inertial><origin xyz="0.2 0 0"/><mass value="0.8"/>
    <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.0025"/></inertial></link>
  <joint name="finger" type="prismatic"><parent link="two"/><child link="jaw"/><origin xyz="0.25 0 0" rpy="0 0 1"/>
    <axis xyz="1 0 0"/><limit lower="0.01" upper="0.05" velocity="1" effort="1"/></joint>
  <link name="jaw"><inertial><origin xyz="0.02 0.01 0"/><mass value="0.1"/>
    <inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.0001"/></inertial></link>
  <joint name="thumb" type="prismatic"><parent link="two"/><child link="other"/><origin xyz="0.25 0.1 0" rpy="0 0 -1"/>
    <axis xyz="1 0 0"/><limit lower="0.01" upper="0.05" velocity="1" effort="1"/></joint>
  <link name="other"><inertial><origin xyz="0.02 -0.01 0"/><mass value="0.1"/>
    <inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.0001"/></inertial></link>
  <joint name="end" type="fixed"><parent link="two"/><child link="grip"/><origin xyz="0.3 0 0.1" rpy="1 0 0"/></joint>
  <link name="grip"/>
</robot>"#;
    let mechanism = urdf::read(Path::new("w.urdf"), text.as_bytes(), false).expect("a mechanism");
    let branches = chain(&mechanism, None).expect_err("two joints on one link");
    assert!(
        (branches.contains("finger") || branches.contains("thumb")) && branches.contains("--tip"),
        "{branches}"
    );
    let chain = chain(&mechanism, Some("grip")).expect("a chain");
    let fixed = ["finger", "thumb"].map(|name| format!("`{name}` counts as fixed in the robot description"));
    assert_eq!(chain.notes, fixed);
    let (described, assumed) = described(&mechanism, Some("grip"));
    let expected = ["accelerations", "how fast the tool may be", "the speed of `b`"];
    assert_eq!(assumed, expected);
    let robot = described.robot("robot").expect("a robot");
    // A continuous joint has no stop.
    let endless = robot
        .limits()
        .iter()
        .any(|limits| limits.lower == f64::NEG_INFINITY && limits.upper == f64::INFINITY);
    assert!(endless, "{:?}", robot.limits());
    // The whole mechanism, its fingers held where they start.
    let bodies = model(&mechanism).expect("masses").expect("a tree").model;
    let mut random = Random(23);
    let (mut one, mut other) = (robot.model().data(), bodies.data());
    for _ in 0..20 {
        let (q, v, a) = (random.list(2), random.list(2), random.list(2));
        let mut needed = vec![0.0; 2];
        robot.joint_torques(&mut one, &q, &v, &a, &mut needed);
        let with_fingers = |list: &[f64], finger: f64| [list[0], list[1], finger, finger];
        let mut expected = vec![0.0; 4];
        rnea(
            &bodies,
            &mut other,
            &with_fingers(&q, 0.01),
            &with_fingers(&v, 0.0),
            &with_fingers(&a, 0.0),
            &mut expected,
        );
        for (needed, expected) in needed.iter().zip(&expected) {
            assert!(
                (needed - expected).abs() < 1e-10 * expected.abs().max(1.0),
                "{needed} is not {expected}"
            );
        }
    }
    // The flange: by the places of the file, one behind the other.
    let q = [0.3, -0.8];
    let turn = |axis: [f64; 3], angle: f64| Placement::from_axis_angle([0.0; 3], axis, angle);
    let grip = Placement::from_rpy([1.0, 2.0, 0.5], [0.1, 0.2, 0.3])
        * Placement::from_rpy([0.0, 0.1, 0.4], [0.3, 0.0, 0.0])
        * turn([0.0, 0.0, 1.0], q[0])
        * Placement::from_rpy([0.2, 0.0, 0.1], [0.0, 0.7, 0.0])
        * Placement::from_rpy([0.3, 0.0, 0.0], [0.0, 0.0, 0.4])
        * turn([0.0, 1.0, 0.0], q[1])
        * Placement::from_rpy([0.3, 0.0, 0.1], [1.0, 0.0, 0.0]);
    let tcp = robot.parts().base * robot.tcp(&mut one, &q);
    assert!((tcp.translation - grip.translation).norm() < 1e-11, "{tcp:?}");
    assert!((tcp.rotation - grip.rotation).abs().max() < 1e-11, "{tcp:?}");
}

#[test]
fn axes_that_slide_are_described_too() {
    use blocksim_import::simscape;
    let file = root().join("tests/data/crane.xml");
    let bytes = std::fs::read(&file).expect("a file of the tests");
    let mechanism = simscape::read(&file, &bytes).unwrap_or_else(|faults| panic!("{}", faults[0]));
    let (described, assumed) = described(&mechanism, None);
    assert!(assumed.contains(&"the range of `boom_1_to_trolley_1`".to_owned()), "{assumed:?}");
    let (robot, typed) = (described.robot("robot").expect("a robot"), crane());
    let (mut one, mut other) = (robot.model().data(), typed.data());
    let mut random = Random(29);
    for _ in 0..20 {
        let (q, v, a) = (random.list(3), random.list(3), random.list(3));
        let (mut needed, mut expected) = (vec![0.0; 3], vec![0.0; 3]);
        robot.joint_torques(&mut one, &q, &v, &a, &mut needed);
        rnea(&typed, &mut other, &q, &v, &a, &mut expected);
        for (needed, expected) in needed.iter().zip(&expected) {
            assert!(
                (needed - expected).abs() < 1e-10 * expected.abs().max(1.0),
                "{needed} is not {expected}"
            );
        }
    }
}
