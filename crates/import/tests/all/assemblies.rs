//! Assemblies in assemblies, and joints that close loops.

use std::path::Path;

use blocksim_import::{Mechanism, Motion, simscape};
use blocksim_multibody::Placement;
use nalgebra::Vector3;

/// The pins of a four-bar linkage, mm.
const PINS: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [0.0, 200.0, 0.0], [400.0, 300.0, 0.0], [400.0, 0.0, 0.0]];

fn instance(name: &str, part: &str, at: [f64; 3], turned: bool, more: &str) -> String {
    let [x, y, z] = at;
    let rotation = if turned { "0 -1 0 1 0 0 0 0 1" } else { "1 0 0 0 1 0 0 0 1" };
    let grounded = if name == "base-1" { " grounded=\"true\"" } else { "" };
    format!(
        "<Instance name=\"{name}\" uid=\"{name}\" entityUid=\"{part}\"{grounded}><Transform><Rotation>{rotation}</Rotation>\
         <Translation>{x} {y} {z}</Translation></Transform>{more}</Instance>"
    )
}

/// A bolt that leaves a turn about z: the point in the coordinates of both.
fn hinge(a: &[&str], in_a: [f64; 3], b: &[&str], in_b: [f64; 3]) -> String {
    let side = |path: &[&str], [x, y, z]: [f64; 3], kind: &str| {
        let path: String = path.iter().map(|uid| format!("<Uid>{uid}</Uid>")).collect();
        format!(
            "<ConstraintGeometry geomType=\"{kind}\"><InstancePath>{path}</InstancePath><Position>{x} {y} {z}</Position>\
             <Axis>0 0 1</Axis></ConstraintGeometry>"
        )
    };
    let both = |kind: &str| format!("{}{}", side(a, in_a, kind), side(b, in_b, kind));
    format!(
        "<Concentric name=\"c\">{}</Concentric><Coincident name=\"p\">{}</Coincident>",
        both("cylinder"),
        both("plane")
    )
}

/// A four-bar linkage whose coupler is an assembly of a bar and, in an assembly of its own, a plate; it stands turned by a
/// quarter.
fn linkage(flexible: bool) -> String {
    let inner = instance(
        "inner-1",
        "inner",
        [10.0, 20.0, 30.0],
        true,
        &instance("plate-1", "plate", [5.0, 0.0, 0.0], false, ""),
    );
    let bar = instance("bar-1", "bar", [0.0; 3], false, "");
    let instances = [
        instance("base-1", "base", [0.0; 3], false, ""),
        instance("crank-1", "crank", PINS[0], false, ""),
        instance("coupler-1", "coupler", PINS[1], true, &format!("{bar}{inner}")),
        instance("rocker-1", "rocker", PINS[3], false, ""),
    ]
    .concat();
    let bar = ["coupler-1", "bar-1"];
    let constraints = [
        hinge(&["base-1"], PINS[0], &["crank-1"], [0.0; 3]),
        hinge(&["crank-1"], PINS[1], &bar, [0.0; 3]),
        // (400, 100) from pin to pin, in axes turned by a quarter.
        hinge(&bar, [100.0, -400.0, 0.0], &["rocker-1"], [0.0, 300.0, 0.0]),
        hinge(&["rocker-1"], [0.0; 3], &["base-1"], PINS[3]),
    ]
    .concat();
    // Inside the coupler the plate may turn against the bar.
    let inside = hinge(&["bar-1"], [15.0, 20.0, 30.0], &["inner-1", "plate-1"], [0.0, -5.0, 0.0]);
    let inside = if flexible { format!("<Constraints>{inside}</Constraints>") } else { String::new() };
    let parts: String = ["base", "crank", "bar", "plate", "rocker"]
        .map(|name| {
            format!(
                "<Part name=\"{name}\" uid=\"{name}\" version=\"1\"><MassProperties><Mass>1000</Mass><CenterOfMass>0 0 0</CenterOfMass>\
                 <Inertia>1e6 1e6 1e6 0 0 0</Inertia></MassProperties></Part>"
            )
        })
        .concat();
    format!(
        "<SimscapeMultibodyImportXML version=\"2.0\"><ModelUnits mass=\"gram\" length=\"millimeter\"/>\
         <RootAssembly name=\"linkage\" uid=\"l\" version=\"1\"><InstanceTree>{instances}</InstanceTree>\
         <Constraints>{constraints}</Constraints></RootAssembly>\
         <Assemblies><Assembly name=\"coupler\" uid=\"coupler\" version=\"1\">{inside}</Assembly>\
         <Assembly name=\"inner\" uid=\"inner\" version=\"1\"/></Assemblies><Parts>{parts}</Parts>\
         </SimscapeMultibodyImportXML>"
    )
}

fn read(text: &str) -> Mechanism {
    simscape::read(Path::new("linkage.xml"), text.as_bytes()).unwrap_or_else(|faults| panic!("{}", faults[0]))
}

/// Where each body is drawn, by its name in the file, m.
fn drawn(name: &str) -> Placement {
    let quarter =
        |x: f64, y: f64, z: f64| Placement::from_rpy([x, y, z], [0.0, 0.0, std::f64::consts::FRAC_PI_2]);
    match name {
        "crank-1" | "base-1" => Placement::identity(),
        "bar-1" => quarter(0.0, 0.2, 0.0),
        "plate-1" => {
            quarter(0.0, 0.2, 0.0)
                * quarter(0.01, 0.02, 0.03)
                * Placement::from_translation([0.005, 0.0, 0.0])
        }
        _ => Placement::from_translation([0.4, 0.0, 0.0]),
    }
}

/// Both frames of every joint coincide as drawn; returns where hinges are.
fn hinges(mechanism: &Mechanism) -> Vec<Vector3<f64>> {
    let mut found = Vec::new();
    for joint in &mechanism.joints {
        let place = |body: usize| drawn(&mechanism.bodies[body].original);
        let base = joint.base.map_or_else(Placement::identity, place) * joint.in_base;
        let follower = place(joint.follower) * joint.in_follower.unwrap_or_else(Placement::identity);
        let gap = (base.translation - follower.translation).norm();
        let turned = (base.rotation - follower.rotation).abs().max();
        assert!(gap < 1e-12 && turned < 1e-12, "{}: {base:?} {follower:?}", joint.name);
        if let Motion::Revolute { axis } = joint.motion {
            let axis = base.direction(&axis.into());
            assert!((axis.z.abs() - 1.0).abs() < 1e-12, "{}: {axis}", joint.name);
            found.push(base.translation);
        }
    }
    found
}

/// Whether hinges stand at these points of the x-y plane, each once, m.
fn stand_at(hinges: &[Vector3<f64>], points: &[[f64; 2]]) -> bool {
    let at = |point: &[f64; 2]| {
        hinges.iter().filter(|hinge| (hinge.x - point[0]).hypot(hinge.y - point[1]) < 1e-12).count()
    };
    hinges.len() == points.len() && points.iter().all(|point| at(point) == 1)
}

#[test]
fn a_linkage_with_an_assembly_as_coupler_has_its_hinges_at_the_pins_and_closes() {
    let mechanism = read(&linkage(false));
    assert_eq!(mechanism.bodies.len(), 5);
    assert!(mechanism.has_loop());
    let pins = PINS.map(|[x, y, _]| [x / 1000.0, y / 1000.0]);
    let hinges = hinges(&mechanism);
    assert!(stand_at(&hinges, &pins), "{hinges:?}");
    // The plate, two assemblies deep, is welded to the bar.
    let welds = mechanism.joints.iter().filter(|joint| joint.motion == Motion::Weld).count();
    assert_eq!((welds, mechanism.joints.len()), (2, 6), "the base and the plate are held");
}

#[test]
fn constraints_inside_of_an_assembly_make_joints_in_it() {
    let mechanism = read(&linkage(true));
    let hinges = hinges(&mechanism);
    assert_eq!(hinges.len(), 5);
    // The bolt at (15, 20) of the coupler, which stands turned at the second pin.
    assert!(
        hinges.iter().any(|hinge| (hinge - Vector3::new(-0.02, 0.215, 0.03)).xy().norm() < 1e-12),
        "{hinges:?}"
    );
}

/// The same, but that the assembly around them is held rigid: what it ties inside has no effect.
#[test]
fn nothing_moves_inside_of_an_assembly_that_is_held_rigid() {
    let [rigid, tied] = [false, true].map(linkage);
    let held = tied.replace("entityUid=\"coupler\"", "entityUid=\"coupler\" rigid=\"true\"");
    assert_ne!(held, tied);
    let [rigid, held] = [rigid, held].map(|text| read(&text));
    assert_eq!(format!("{:?}", held.joints), format!("{:?}", rigid.joints));
    // A joint that is stated inside is named, as it moves no more.
    let side = |name: &str, path: &str| {
        format!(
            "<{name}><InstancePath>{path}</InstancePath><Transform><Rotation>1 0 0 0 1 0 0 0 1</Rotation>\
             <Translation>0 0 0</Translation></Transform></{name}>"
        )
    };
    let elbow = format!(
        "<Joints><Revolute name=\"elbow\">{}{}</Revolute></Joints>",
        side("BaseFrame", "<Uid>bar-1</Uid>"),
        side("FollowerFrame", "<Uid>inner-1</Uid><Uid>plate-1</Uid>")
    );
    let stated = |more: &str| {
        let text = linkage(false).replace("entityUid=\"coupler\"", &format!("entityUid=\"coupler\"{more}"));
        read(&text.replace(
            "<Assembly name=\"coupler\" uid=\"coupler\" version=\"1\">",
            &format!("<Assembly name=\"coupler\" uid=\"coupler\" version=\"1\">{elbow}"),
        ))
    };
    let moves = |mechanism: &Mechanism| mechanism.joints.iter().any(|joint| joint.original == "elbow");
    assert!(moves(&stated("")) && !moves(&stated(" rigid=\"1\"")));
    let notes = stated(" rigid=\"1\"").notes;
    let expected = "`elbow` joins two instances that are held together, and is left out";
    assert!(notes.iter().any(|note| note == expected), "{notes:?}");
    // What is not known of an instance is no reason to refuse it, but is named.
    let notes = read(&linkage(false).replacen(" grounded=", " held=\"g\" grounded=", 1)).notes;
    assert!(notes[0].contains("`held` of the instance `base-1` is not known"), "{notes:?}");
    let said = simscape::read(Path::new("l.xml"), linkage(false).replace("\"true\"", "\"yes\"").as_bytes());
    assert!(said.unwrap_err()[0].to_string().contains("`grounded` is `yes`"));
}

/// A crank in one group with the base is fixed, and the coupler with it turns against the rocker alone.
#[test]
fn instances_of_a_rigid_group_do_not_move_against_each_other() {
    let text = |group: &str| {
        ["base", "crank"].iter().fold(linkage(false), |text, part| {
            text.replace(
                &format!("entityUid=\"{part}\""),
                &format!("entityUid=\"{part}\" rigidGroup=\"{}\"", if *part == "base" { "g" } else { group }),
            )
        })
    };
    let turning = |text: &str| {
        read(text).joints.iter().filter(|joint| matches!(joint.motion, Motion::Revolute { .. })).count()
    };
    assert_eq!([turning(&linkage(false)), turning(&text("other")), turning(&text("g"))], [4, 4, 3]);
}

/// What is mated with the origin of the assembly itself is mated with the world.
#[test]
fn an_empty_path_names_the_assembly_itself() {
    let named = linkage(false);
    let path = "<InstancePath><Uid>base-1</Uid></InstancePath>";
    let [of_base, of_itself] =
        [&named, &named.replace(path, "<InstancePath></InstancePath>")].map(|text| read(text));
    assert!(named.contains(path));
    assert_eq!(format!("{:?}", of_itself.joints), format!("{:?}", of_base.joints));
}

/// A hinge between the origin of an assembly and its first part; the assembly is welded to the base, or tied to nothing.
#[test]
fn a_part_may_be_hinged_to_the_origin_of_the_assembly_around_it() {
    let side = |name: &str, path: &str| {
        format!(
            "<{name}><InstancePath>{path}</InstancePath><Transform><Rotation>1 0 0 0 1 0 0 0 1</Rotation>\
             <Translation>0 0 0</Translation></Transform></{name}>"
        )
    };
    let joint = |kind: &str, name: &str, base: &str, follower: &str| {
        format!(
            "<{kind} name=\"{name}\">{}{}</{kind}>",
            side("BaseFrame", base),
            side("FollowerFrame", follower)
        )
    };
    let parts = [
        instance("arm-1", "arm", [0.0; 3], false, ""),
        instance("bob-1", "arm", [500.0, 0.0, 0.0], false, ""),
    ];
    let instances = [
        instance("base-1", "base", [0.0; 3], false, ""),
        instance("unit-1", "unit", [100.0, 0.0, 0.0], false, &parts.concat()),
    ]
    .concat();
    let text = |tie: &str| {
        format!(
            "<SimscapeMultibodyImportXML version=\"2.0\"><ModelUnits mass=\"gram\" length=\"millimeter\"/>\
             <RootAssembly name=\"l\" uid=\"l\" version=\"1\"><InstanceTree>{instances}</InstanceTree><Joints>{tie}</Joints></RootAssembly>\
             <Assemblies><Assembly name=\"unit\" uid=\"unit\" version=\"1\"><Joints>{}{}</Joints></Assembly></Assemblies><Parts>{}</Parts>\
             </SimscapeMultibodyImportXML>",
            joint("Revolute", "hinge", "", "<Uid>arm-1</Uid>"),
            joint("Revolute", "elbow", "<Uid>arm-1</Uid>", "<Uid>bob-1</Uid>"),
            ["base", "arm"]
                .map(|name| format!(
                    "<Part name=\"{name}\" uid=\"{name}\" version=\"1\"><MassProperties><Mass>1000</Mass>\
                     <CenterOfMass>0 0 0</CenterOfMass><Inertia>1e6 1e6 1e6 0 0 0</Inertia></MassProperties></Part>"
                ))
                .concat(),
        )
    };
    let held = read(&text(&joint("Weld", "w", "<Uid>base-1</Uid>", "<Uid>unit-1</Uid>")));
    let found: Vec<(&str, Option<usize>, f64)> = held
        .joints
        .iter()
        .filter(|joint| joint.motion != Motion::Weld)
        .map(|joint| (&*joint.original, joint.base, joint.in_base.translation.x))
        .collect();
    let arm = held.bodies.iter().position(|body| body.name.starts_with("arm"));
    assert_eq!(found, [("hinge", None, 0.1), ("elbow", arm, 0.0)]);
    assert!(held.notes.is_empty(), "{:?}", held.notes);
    let loose = read(&text(""));
    let expected = "the joint between `unit-1` and `arm-1` is left out, as no part stands on one side of it";
    assert!(loose.notes.iter().any(|note| note.starts_with(expected)), "{:?}", loose.notes);
    // Where its part is held from outside, the hinge to the origin holds nothing.
    let outer =
        read(&text(&joint("Revolute", "swing", "<Uid>base-1</Uid>", "<Uid>unit-1</Uid><Uid>arm-1</Uid>")));
    assert!(outer.joints.iter().any(|joint| joint.original == "swing" && joint.base.is_none()));
}

#[test]
fn a_path_to_a_part_that_is_not_in_the_assembly_is_refused_with_its_line() {
    let wrong = linkage(false).replace("<Uid>coupler-1</Uid><Uid>bar-1</Uid>", "<Uid>bar-1</Uid>");
    let faults = simscape::read(Path::new("linkage.xml"), wrong.as_bytes()).expect_err("no such path");
    assert!(faults[0].to_string().contains("there is no instance `bar-1`"), "{}", faults[0]);
}

#[test]
fn an_assembly_with_more_instances_than_can_be_handled_is_refused() {
    let many: String =
        (0..5000).map(|n| instance(&format!("extra-{n}"), "bar", [0.0; 3], false, "")).collect();
    let huge = linkage(false).replace("</InstanceTree>", &format!("{many}</InstanceTree>"));
    let faults = simscape::read(Path::new("linkage.xml"), huge.as_bytes()).expect_err("too many");
    assert!(
        faults.iter().any(|fault| fault.to_string().contains("more than 2000 instances")),
        "{}",
        faults[0]
    );
}
