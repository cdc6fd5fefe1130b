//! A file that is imported again with another structure: what each change is, and where the diagram shows it.

use std::path::Path;

use blocksim_import::{
    Files, Mechanism, Part, Provenance, chain, diagram, parameters, restructured, simscape, urdf, wired_in,
};

fn link(name: &str) -> String {
    let tensor = "ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'";
    format!("<link name='{name}'><inertial><mass value='1'/><inertia {tensor}/></inertial></link>")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str) -> String {
    format!(
        "<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>\
         <origin xyz='0.3 0 0'/><axis xyz='0 1 0'/></joint>"
    )
}

/// A base without mass, bodies `a` and `b`, and what else is in the file.
fn robot(more: &[String]) -> Mechanism {
    let links = ["<link name='base'/>".to_owned(), link("a"), link("b")].concat();
    let text = format!("<robot name='r'>{links}{}</robot>", more.concat());
    urdf::read(Path::new("r.urdf"), text.as_bytes(), false).unwrap_or_else(|faults| panic!("{}", faults[0]))
}

fn two_joints() -> Mechanism {
    robot(&[joint("j1", "continuous", "base", "a"), joint("j2", "continuous", "a", "b")])
}

/// The parameter file, with the chain to `tip` if there is one.
fn numbers(mechanism: &Mechanism, tip: Option<&str>) -> String {
    let provenance =
        Provenance { source: "r.urdf".into(), fingerprint: "0".into(), date: "2026-11-21".into() };
    parameters(mechanism, chain(mechanism, tip).ok().as_ref(), &provenance)
}

/// Changes of the mechanism and those of its chain, in words.
fn changes(old: &str, new: &str) -> [Vec<String>; 2] {
    let (chain, mechanism): (Vec<_>, Vec<_>) =
        restructured(old, new).into_iter().partition(|change| change.part == Part::Robot);
    [mechanism, chain].map(|changes| changes.into_iter().map(|change| change.what).collect())
}

/// Changes between two mechanisms without their chains.
fn between(before: &Mechanism, now: &Mechanism) -> Vec<String> {
    let [mechanism, _] = changes(&numbers(before, None), &numbers(now, None));
    mechanism
}

#[test]
fn a_joint_that_connects_other_bodies_or_is_of_another_kind_is_named() {
    let before = two_joints();
    let moved = robot(&[joint("j1", "continuous", "base", "a"), joint("j2", "continuous", "base", "b")]);
    assert_eq!(between(&before, &moved), ["`j2` is carried by `base` (before by `a`)"]);
    let swapped = robot(&[joint("j1", "continuous", "base", "b"), joint("j2", "continuous", "b", "a")]);
    let expected =
        ["`j1` moves `b` (before `a`)", "`j2` is carried by `b` (before by `a`) and moves `a` (before `b`)"];
    assert_eq!(between(&before, &swapped), expected);
    let planar = robot(&[joint("j1", "planar", "base", "a"), joint("j2", "fixed", "a", "b")]);
    let expected =
        ["`j1` is a PlanarJoint (before a RevoluteJoint)", "`j2` is a Transform (before a RevoluteJoint)"];
    assert_eq!(between(&before, &planar), expected);
}

#[test]
fn a_new_joint_that_holds_a_body_of_before_is_named_and_one_with_another_name_or_body_is_not() {
    let before = two_joints();
    let names = [joint("j1", "continuous", "base", "a"), joint("j2", "continuous", "a", "b")];
    let raised = robot(
        &[&names[..], &["<link name='floor'/>".to_owned(), joint("stand", "fixed", "floor", "base")]]
            .concat(),
    );
    assert_eq!(between(&before, &raised), ["`stand` is new and holds `base`, which was there before"]);
    let longer = robot(&[&names[..], &[link("c"), joint("j3", "continuous", "b", "c")]].concat());
    let renamed = robot(&[joint("j1", "continuous", "base", "a"), joint("elbow", "continuous", "a", "b")]);
    let none: [&str; 0] = [];
    for same in [&before, &longer, &renamed] {
        assert_eq!(between(&before, same), none);
    }
}

#[test]
fn a_joint_that_gets_a_frame_in_the_body_that_moves_is_named() {
    let before = two_joints();
    let mut now = before.clone();
    now.joints[1].in_follower = Some(blocksim_multibody::Placement::from_translation([0.1, 0.0, 0.0]));
    assert_eq!(between(&before, &now), ["`j2` has a frame of its own in the body that moves (before none)"]);
    // Then the diagram names what has gone.
    assert!(between(&now, &before).is_empty());
}

#[test]
fn a_part_that_is_welded_to_another_one_is_named() {
    let weld = |to: &str| {
        let instance = |name: &str, at: &str, more: &str| {
            format!(
                "<Instance name='{name}' uid='{name}' entityUid='e'{more}><Transform><Rotation>1 0 0 0 1 0 0 0 1</Rotation>\
                 <Translation>{at}</Translation></Transform></Instance>"
            )
        };
        let plane = |part: &str, at: &str, axis: &str| {
            format!(
                "<ConstraintGeometry geomType='plane'><InstancePath><Uid>{part}</Uid></InstancePath><Position>{at}</Position>\
                 <Axis>{axis}</Axis></ConstraintGeometry>"
            )
        };
        let at = if to == "p0" { "0.2 0.4 0.6" } else { "0.1 0.2 0.3" };
        let coincident = |a: String, b: String| format!("<Coincident name='c'>{a}{b}</Coincident>");
        let held = ["1 0 0", "0 1 0", "0 0 1"]
            .map(|axis| coincident(plane("p2", "0 0 0", axis), plane(to, at, axis)));
        // p1 slides along z.
        let slides = ["1 0 0", "0 1 0"]
            .map(|axis| coincident(plane("p1", "0 0 0", axis), plane("p0", "0.1 0.2 0.3", axis)));
        let text = format!(
            "<SimscapeMultibodyImportXML version='2.0'><ModelUnits mass='gram' length='meter'/>\
             <RootAssembly name='r' uid='r' version='1'><InstanceTree>{}{}{}</InstanceTree>\
             <Constraints>{}{}</Constraints></RootAssembly><Assemblies/>\
             <Parts><Part name='e' uid='e' version='1'><MassProperties><Mass>1</Mass><CenterOfMass>0 0 0</CenterOfMass>\
             <Inertia>1 1 1 0 0 0</Inertia></MassProperties></Part></Parts></SimscapeMultibodyImportXML>",
            instance("p0", "0 0 0", " grounded='true'"),
            instance("p1", "0.1 0.2 0.3", ""),
            instance("p2", "0.2 0.4 0.6", ""),
            slides.concat(),
            held.concat(),
        );
        simscape::read(Path::new("r.xml"), text.as_bytes()).unwrap_or_else(|faults| panic!("{}", faults[0]))
    };
    assert_eq!(between(&weld("p1"), &weld("p0")), ["`p2_weld` is carried by `world` (before by `p1`)"]);
    assert!(between(&weld("p1"), &weld("p1")).is_empty());
}

#[test]
fn another_chain_or_flange_is_named() {
    let tool = |name: &str| {
        [format!("<link name='{name}'/>"), joint(&format!("to_{name}"), "fixed", "b", name)].concat()
    };
    let names = [joint("j1", "continuous", "base", "a"), joint("j2", "continuous", "a", "b")];
    let arm = |more: &[String]| robot(&[&names[..], more].concat());
    let [one, two] = [arm(&[tool("tcp")]), arm(&[tool("tcp"), tool("cup")])];
    let of = |old: &str, new: &str| changes(old, new)[1].clone();
    // One frame at the end is the flange; of two, the one that is chosen.
    assert!(of(&numbers(&one, None), &numbers(&two, None)).is_empty());
    let other = of(&numbers(&one, None), &numbers(&two, Some("cup")));
    assert_eq!(other, ["the flange, which --tip chooses, is `cup` (before `tcp`)"]);
    let shorter = of(&numbers(&one, None), &numbers(&one, Some("a")));
    assert_eq!(shorter, ["the axes of the chain, which --tip chooses, are `j1` (before `j1`, `j2`)"]);
    // A second branch: there is no chain until one is chosen.
    let branched = numbers(&arm(&[tool("tcp"), link("c"), joint("j3", "continuous", "a", "c")]), None);
    assert_eq!(
        of(&numbers(&one, None), &branched),
        ["the axes of the chain, which --tip chooses, are none (before `j1`, `j2`)"]
    );
    // `b` has stood in the frame of its axis.
    let mut shifted = two_joints();
    let before = numbers(&shifted, None);
    shifted.joints[1].in_follower = Some(blocksim_multibody::Placement::from_translation([0.1, 0.0, 0.0]));
    let expected = ["`chain.axes.j2.bodies.b` is new, and the description does not name it"];
    assert_eq!(of(&before, &numbers(&shifted, None)), expected);
}

#[test]
fn a_file_without_its_structure_is_named() {
    let now = numbers(&two_joints(), None);
    let at = now.find("    // What the numbers refer to").expect("the structure");
    let [mechanism, _] = changes(&format!("{})\n", &now[..at]), &now);
    assert_eq!(mechanism, ["it does not state what its joints connect, as an earlier version wrote it"]);
}

#[test]
fn lines_that_connect_a_joint_are_found_whatever_its_blocks_are_called() {
    let files = Files { source: "r.urdf", diagram: "r.ron", parameters: "p.ron", robot: None };
    let text =
        diagram(&two_joints(), &files).replace("\"j2_seat\"", "\"mount\"").replace("j2_seat.", "mount.");
    let lines: Vec<&str> = text.lines().collect();
    let found: Vec<&str> =
        wired_in(&text, "joints.j2").into_iter().map(|line| lines[line - 1].trim()).collect();
    let expected = [
        "\"mount\": Transform(translation: \"model.joints.j2.translation\", rpy: \"model.joints.j2.rpy\"),",
        "axis: \"model.joints.j2.axis\",",
        "position: \"model.joints.j2.position\",",
        "damping: \"model.joints.j2.damping\",",
        "\"j1.follower <-> a.frame <-> mount.base\",",
        "\"mount.follower <-> j2.base\",",
        "\"j2.follower <-> b.frame\",",
    ];
    assert_eq!(found, expected);
}
