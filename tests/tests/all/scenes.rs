//! What is seen of mechanisms: a recording and a scene together tell where everything is.

use blocksim_multibody::Placement;
use blocksim_robotics::collision::{Check, Rules};
use blocksim_tests::{compile_file, compile_text, run};
use nalgebra::Vector3;

#[test]
fn the_robot_has_a_shape_on_every_link_and_its_tool_where_the_tool_data_say() {
    let (compiled, problems) = compile_file("diagrams/irb2600/irb2600.ron", &["drive=torque"]);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{problems}"));
    assert_eq!(scene.bodies.len(), 7, "the world and six links");
    for body in 0..7 {
        assert!(scene.shapes.iter().any(|shape| shape.body == body), "body {body} has no shape");
    }
    let frame = |name: &str, poses: &[Placement]| {
        let frame = scene.frames.iter().find(|frame| frame.name == name).expect("a frame");
        poses[frame.body] * frame.place
    };
    let home = scene.poses(&[0.0; 6]);
    let flange = frame("arm/end_effector/flange", &home);
    assert!((flange.translation - Vector3::new(1.03, 0.0, 1.46)).norm() < 1e-12);
    assert!((flange.direction(&Vector3::z()) - Vector3::x()).norm() < 1e-12, "z points out of the flange");
    // 352 mm out of the flange, 119.5 mm down.
    let tcp = frame("arm/end_effector/tcp", &home);
    assert!((tcp.translation - Vector3::new(1.382, 0.0, 1.3405)).norm() < 1e-12);
}

#[test]
fn the_robot_is_free_at_home_and_hits_itself_where_the_forearm_folds_onto_the_base() {
    let (compiled, problems) = compile_file("diagrams/irb2600/irb2600.ron", &["drive=torque"]);
    let scene = compiled.scene.unwrap_or_else(|| panic!("{problems}"));
    let check = Check::of_scene(&scene, &[], &Rules::default());
    assert!(check.unchecked().is_empty() && check.pairs() > 300, "{} pairs", check.pairs());
    assert_eq!(check.left_out(), &[] as &[[String; 2]], "nothing but neighbours touches at home");
    let home = check.clearance(&scene.poses(&[0.0; 6])).expect("a pair");
    assert!(home.distance.distance > 0.005, "{home:?}");
    // The lower arm leans forward, the forearm goes down until the torch meets what stands there.
    let way: Vec<Vec<Placement>> = (0..=75)
        .map(|degrees| f64::from(degrees).to_radians())
        .map(|q| scene.poses(&[0.0, -0.2 * q, q, 0.0, 1.2 * q, 0.0]))
        .collect();
    let (row, hit) = check.along(&way).first.expect("a collision");
    assert!(row > 20, "{row}: {hit:?}");
    assert_eq!(hit.names, ["arm/end_effector/torch", "arm/link1/solid"], "{hit:?}");
}

/// A chain of all kinds of joint, each connected the wrong way round where `flipped`.
fn chain(flipped: bool, shapes: &str) -> String {
    let joints = [
        ("a", "UniversalJoint(position: [0.3, -0.4], velocity: [1.0, 0.5])"),
        ("b", "CylindricalJoint(position: 0.2, velocity: 0.3)"),
        ("c", "SphericalJoint(rpy: [0.3, 0.2, -0.7], velocity: [1.0, -0.5, 0.7])"),
        ("d", "PlanarJoint(position: [0.1, 0.2])"),
        ("e", "FreeJoint(position: [0.1, 0.2, 0.3], rpy: [0.5, 0.1, 0.2], spin: [0.3, 0.2, 0.1])"),
    ];
    let (near, far) = if flipped { ("follower", "base") } else { ("base", "follower") };
    let (mut blocks, mut connections, mut before) = (String::new(), String::new(), "world.frame".to_owned());
    for (name, joint) in joints {
        blocks.push_str(&format!(
            "\"{name}\": {joint}, \"{name}_body\": Body(mass: 1.0, com: [0.1, 0.0, 0.2], moi: [0.1, 0.1, 0.1]{shapes}), \
             \"{name}_step\": Transform(translation: [0.2, 0.1, 0.3], rpy: [0.3, 0.1, 0.2]), \
             \"{name}_sensor\": TransformSensor, \"{name}_x\": Scope(inputs: [\"x\", \"p\"]),"
        ));
        connections.push_str(&format!(
            "\"{before} <-> {name}.{near}\", \"{name}.{far} <-> {name}_body.frame <-> {name}_step.base\", \
             \"{name}_step.follower <-> {name}_sensor.follower\", \"{name}_sensor.x -> {name}_x.x\", \
             \"{name}_sensor.p -> {name}_x.p\","
        ));
        before = format!("{name}_step.follower");
    }
    format!(
        "Diagram(simulation: (stop_time: \"0.2 s\", solver: Ode45(rtol: 1e-10), output: Every(\"0.02 s\")), \
         blocks: {{ \"world\": World, {blocks} }}, connections: [{connections}])"
    )
}

#[test]
fn recorded_positions_put_every_frame_where_a_sensor_sees_it_whichever_way_joints_are_connected() {
    for flipped in [false, true] {
        let (compiled, problems) =
            compile_text(&chain(flipped, ", shapes: [(kind: Text(\"sphere\"), radius: \"0.1 m\")]"));
        let (scene, schedule) = (compiled.scene.expect("a scene"), compiled.schedule);
        let run = run(schedule.unwrap_or_else(|| panic!("{problems}")));
        let positions: Vec<&[f64]> = scene.signals().iter().map(|name| run.column(name)).collect();
        assert_eq!(positions.len(), 2 + 2 + 4 + 3 + 7);
        let mut travelled = 0.0_f64;
        for row in 0..run.time.len() {
            let q: Vec<f64> = positions.iter().map(|column| column[row]).collect();
            let poses = scene.poses(&q);
            for frame in &scene.frames {
                let name = frame.name.trim_end_matches("_step");
                let at = poses[frame.body] * frame.place;
                let seen = |k: usize| run.column(&format!("{name}_x.x[{k}]"))[row];
                let seen = Vector3::new(seen(0), seen(1), seen(2));
                assert!(
                    (at.translation - seen).norm() < 1e-9,
                    "{flipped} {}: {} != {seen}",
                    frame.name,
                    at.translation
                );
                let p: [f64; 4] = std::array::from_fn(|k| run.column(&format!("{name}_x.p[{k}]"))[row]);
                let turn = blocksim_multibody::rotation_of_quaternion(p).expect("a unit quaternion");
                assert!((at.rotation - turn).abs().max() < 1e-9, "{flipped} {}", frame.name);
            }
            let start = scene.poses(&scene.start());
            let last = poses.len() - 1;
            travelled = travelled.max((poses[last].translation - start[last].translation).norm());
        }
        assert!(travelled > 0.05, "nothing moved: {travelled} m");
        assert_eq!(scene.masses.len(), 5);
    }
}

#[test]
fn mechanisms_without_shapes_record_what_is_asked_for_and_nothing_more() {
    let (bare, _) = compile_text(&chain(false, ""));
    let recorded = bare.schedule.expect("a schedule").recorded.len();
    assert_eq!(recorded, 5 * 7);
    assert_eq!(bare.scene.expect("a scene").frames.len(), 5);
}

#[test]
fn a_bad_shape_is_an_error_with_its_place() {
    let (compiled, problems) =
        compile_text(&chain(false, ", shapes: [(kind: Text(\"sphere\"), radius: \"2 kg\")]"));
    assert!(compiled.schedule.is_none());
    assert!(problems.contains("`shapes`: shape 1: `radius` must be in m, not 2 kg"), "{problems}");
}
