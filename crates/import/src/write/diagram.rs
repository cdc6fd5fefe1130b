//! The diagram: world, bodies, joints and transforms, wired by frames.

use super::call;
use crate::mechanism::{Body, Joint, Mechanism, Motion, Start};

/// Files that belong to a diagram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Files<'a> {
    /// The file that was imported.
    pub source: &'a str,
    /// The diagram itself.
    pub diagram: &'a str,
    /// Its numbers.
    pub parameters: &'a str,
    /// The description of the robot, where there is one.
    pub robot: Option<&'a str>,
}

/// The text of a diagram.
///
/// The diagram is for its user to change: it names numbers, and holds none.
pub fn diagram(mechanism: &Mechanism, files: &Files) -> String {
    let mut blocks = vec![("world".to_owned(), "World".to_owned())];
    // Ports that meet at the world and at each body.
    let mut world = vec!["world.frame".to_owned()];
    let mut frames: Vec<Vec<String>> = vec![Vec::new(); mechanism.bodies.len()];
    for (body, ports) in mechanism.bodies.iter().zip(&mut frames) {
        if is_block(body) {
            ports.push(format!("{}.frame", body.name));
        }
    }
    let mut moved = vec![false; mechanism.bodies.len()];
    for joint in &mechanism.joints {
        moved[joint.follower] = true;
        let [first, last] = ends(joint);
        match joint.base {
            Some(base) => frames[base].push(first),
            None => world.push(first),
        }
        frames[joint.follower].insert(0, last);
    }
    let looped = mechanism.has_loop();
    // Outwards from the world: what meets at a body, and then the joints that it carries.
    let mut wires: Vec<Vec<String>> = vec![Vec::new(); 1 + mechanism.bodies.len()];
    for joint in mechanism.joints.iter().filter(|joint| joint.base.is_none()) {
        joint_blocks(joint, looped, &mut blocks, &mut wires[0]);
    }
    for (i, body) in mechanism.bodies.iter().enumerate() {
        if is_block(body) {
            blocks.push((body.name.clone(), body_block(body)));
        }
        for joint in mechanism.joints.iter().filter(|joint| joint.base == Some(i)) {
            joint_blocks(joint, looped, &mut blocks, &mut wires[i + 1]);
        }
        if !moved[i] {
            world.append(&mut frames[i]);
        }
    }
    let mut connections: Vec<String> = Vec::new();
    for (ports, wires) in std::iter::once(&world).chain(&frames).zip(wires) {
        connections.extend(meeting(ports));
        connections.extend(wires);
    }
    scopes(mechanism, &mut blocks, &mut connections);
    text(mechanism, files, &blocks, &connections)
}

fn text(mechanism: &Mechanism, files: &Files, blocks: &[(String, String)], connections: &[String]) -> String {
    let parameters = files.parameters;
    let mut out = format!(
        "// {}, imported from {}.\n//\n// The numbers are in {parameters}. Importing again brings new numbers into that file and leaves this one\n// alone: add drives, controllers and sensors here.\n",
        line(&mechanism.name),
        line(files.source),
    );
    out.push_str(&format!("Diagram(\n    title: {},\n", quoted(&mechanism.name)));
    match files.robot {
        None => out.push_str(&format!("    parameters: {{ \"model\": File({}) }},\n", quoted(parameters))),
        Some(robot) => out.push_str(&format!(
            "    parameters: {{\n        \"model\": File({}),\n        \"manipulator\": File({}),\n    }},\n",
            quoted(parameters),
            quoted(robot)
        )),
    }
    out.push_str("    simulation: (stop_time: \"1 s\", output: Every(\"10 ms\")),\n    blocks: {\n");
    blocks.iter().for_each(|(name, block)| out.push_str(&format!("        \"{name}\": {block},\n")));
    out.push_str("    },\n    connections: [\n");
    connections.iter().for_each(|wire| out.push_str(&format!("        \"{wire}\",\n")));
    out.push_str("    ],\n)\n");
    out
}

/// A text for a comment: one line.
pub(crate) fn line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// A text of RON.
pub(super) fn quoted(text: &str) -> String {
    let escaped: String = line(text)
        .chars()
        .flat_map(|c| match c {
            '"' | '\\' => vec!['\\', c],
            _ => vec![c],
        })
        .collect();
    format!("\"{escaped}\"")
}

/// `a <-> b <-> c`, lines of at most six.
fn meeting(ports: &[String]) -> Vec<String> {
    const AT_ONCE: usize = 6;
    let Some((first, rest)) = ports.split_first() else { return Vec::new() };
    rest.chunks(AT_ONCE - 1).map(|more| format!("{first} <-> {}", more.join(" <-> "))).collect()
}

/// A body has mass or is seen; others are frames alone.
fn is_block(body: &Body) -> bool {
    body.inertia.is_some() || !body.shapes.is_empty()
}

fn body_block(body: &Body) -> String {
    let path = format!("model.bodies.{}", body.name);
    let member = |name: &str| format!("{name}: \"{path}.{name}\"");
    let mut members = match body.inertia {
        Some(_) => ["mass", "com", "moi", "poi"].map(member).to_vec(),
        // A body without mass is only looked at.
        None => vec!["mass: 0".to_owned()],
    };
    if !body.shapes.is_empty() {
        members.push(member("shapes"));
    }
    call("Body", &members, 12 + body.name.len(), 8)
}

/// The ports that the joint offers to the bodies on both sides.
fn ends(joint: &Joint) -> [String; 2] {
    let name = &joint.name;
    match (joint.motion, joint.in_follower) {
        (Motion::Weld, _) => [format!("{name}.base"), format!("{name}.follower")],
        (_, None) => [format!("{name}_seat.base"), format!("{name}.follower")],
        (_, Some(_)) => [format!("{name}_seat.base"), format!("{name}_end.base")],
    }
}

/// The kind of the block of a joint.
pub(super) fn kind(motion: Motion) -> &'static str {
    match motion {
        Motion::Weld => "Transform",
        Motion::Revolute { .. } => "RevoluteJoint",
        Motion::Prismatic { .. } => "PrismaticJoint",
        Motion::Cylindrical => "CylindricalJoint",
        Motion::Planar => "PlanarJoint",
        Motion::Spherical => "SphericalJoint",
        Motion::Free => "FreeJoint",
    }
}

fn joint_blocks(joint: &Joint, looped: bool, blocks: &mut Vec<(String, String)>, wires: &mut Vec<String>) {
    let name = &joint.name;
    let path = format!("model.joints.{name}");
    let place = |head: &str, path: &str, name: &str| {
        let members = ["translation", "rpy"].map(|part| format!("{part}: \"{path}.{part}\""));
        call(head, &members, 12 + name.len(), 8)
    };
    if joint.motion == Motion::Weld {
        blocks.push((name.clone(), place("Transform", &path, name)));
        return;
    }
    let seat = format!("{name}_seat");
    blocks.push((seat.clone(), place("Transform", &path, &seat)));
    let mut members = Vec::new();
    let member = |name: &str| format!("{name}: \"{path}.{name}\"");
    let kind = kind(joint.motion);
    if matches!(joint.motion, Motion::Revolute { .. } | Motion::Prismatic { .. }) {
        members.push(member("axis"));
    }
    // In a loop the positions follow from each other, so none is prescribed.
    if !looped {
        match (joint.start, joint.motion) {
            (Start::Open, _) => {}
            (_, Motion::Cylindrical | Motion::Planar) => members.extend(["position", "angle"].map(member)),
            (_, Motion::Spherical) => members.push(format!("rpy: \"{path}.start_rpy\"")),
            (_, Motion::Free) => {
                members.extend([member("position"), format!("rpy: \"{path}.start_rpy\"")]);
            }
            _ => members.push(member("position")),
        }
    }
    match joint.motion {
        Motion::Revolute { .. } | Motion::Prismatic { .. } => members.push(member("damping")),
        _ => {}
    }
    if joint.range.is_some() {
        members.extend(["lower", "upper"].map(member));
    }
    let block = if members.is_empty() { kind.to_owned() } else { call(kind, &members, 12 + name.len(), 8) };
    blocks.push((name.clone(), block));
    wires.push(format!("{name}_seat.follower <-> {name}.base"));
    if joint.in_follower.is_some() {
        let end = format!("{name}_end");
        blocks.push((end.clone(), place("Transform", &format!("{path}.end"), &end)));
        wires.push(format!("{name}.follower <-> {end}.follower"));
    }
}

/// A scope of all angles and one of all positions.
fn scopes(mechanism: &Mechanism, blocks: &mut Vec<(String, String)>, connections: &mut Vec<String>) {
    type Wanted = fn(&Motion) -> bool;
    let kinds: [(&str, &str, &str, Wanted); 2] = [
        ("angles", "deg", "q", |motion| matches!(motion, Motion::Revolute { .. })),
        ("positions", "m", "x", |motion| matches!(motion, Motion::Prismatic { .. })),
    ];
    for (scope, unit, port, wanted) in kinds {
        let names: Vec<&str> = mechanism
            .joints
            .iter()
            .filter(|joint| wanted(&joint.motion))
            .map(|joint| joint.name.as_str())
            .collect();
        if names.is_empty() {
            continue;
        }
        let list: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
        let members = [format!("inputs: [{}]", list.join(", ")), format!("display: \"{unit}\"")];
        blocks.push((scope.to_owned(), call("Scope", &members, 12 + scope.len(), 8)));
        connections.extend(names.iter().map(|name| format!("{name}.{port} -> {scope}.{name}")));
    }
}
