//! The parameter file: all numbers with their units, and where they come from.

use blocksim_multibody::{Inertia, Placement};

use super::diagram::{kind, line, quoted};
use super::number::{angle, angles, angular, plain, rpy, vector, with_unit};
use crate::chain::{Chain, ChainLink};
use crate::mechanism::{Body, Form, Joint, Mechanism, Motion, Role, Shape, Start};
use crate::smidata::JointStart;

/// Where the numbers of a file come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// Name of the file that was imported.
    pub source: String,
    /// Its fingerprint.
    pub fingerprint: String,
    /// Day of the import, such as `2026-11-21`.
    pub date: String,
}

impl Provenance {
    /// The comment at the top of a parameter file about `what`.
    pub(crate) fn comment(&self, what: &str) -> String {
        format!(
            "// {}: numbers from {} ({}),\n// imported on {}.\n//\n// `blocksim import` writes this file anew; own numbers belong into the diagram or into a file of their own.\n",
            line(what),
            line(&self.source),
            line(&self.fingerprint),
            line(&self.date),
        )
    }
}

/// The text of a parameter file: `bodies` and `joints` with the names of their blocks.
///
/// `shapes` of a body are for drawing and collisions; lengths of meshes become metres by `scale`. `chain` gets what a
/// [`robot`](crate::robot) needs besides.
pub fn parameters(mechanism: &Mechanism, chain: Option<&Chain>, provenance: &Provenance) -> String {
    let mut out = provenance.comment(&mechanism.name);
    out.push_str("(\n    // com in the frame of the body; moi (Ixx, Iyy, Izz) and poi (Iyz, Izx, Ixy) about the centre of mass, as\n    // elements of the tensor.\n    bodies: (\n");
    mechanism.bodies.iter().for_each(|body| body_group(body, &mut out));
    out.push_str("    ),\n    // translation and rpy: the frame of the joint in the body that carries it.\n    joints: (\n");
    mechanism.joints.iter().for_each(|joint| joint_group(joint, &mut out));
    out.push_str("    ),\n");
    if let Some(chain) = chain {
        chain_group(mechanism, chain, &mut out);
    }
    structure_group(mechanism, chain, &mut out);
    out.push_str(")\n");
    out
}

/// What does not sit in the frame of an axis in the file, brought there.
fn chain_group(mechanism: &Mechanism, chain: &Chain, out: &mut String) {
    let mut members = String::new();
    let seat = |name: &str, at: &Placement, indent: usize, out: &mut String| {
        let space = " ".repeat(indent);
        out.push_str(&format!("{space}{name}: (\n"));
        place(at, indent + 4, out);
        out.push_str(&format!("{space}),\n"));
    };
    if chain.base != Placement::identity() {
        seat("base", &chain.base, 8, &mut members);
    }
    let mut axes = String::new();
    for link in &chain.links {
        let joint = &mechanism.joints[link.joint];
        let mut own = String::new();
        if !stands_in_file(link, joint) {
            seat("origin", &link.origin, 16, &mut own);
        }
        let mut bodies = String::new();
        for (body, at) in link.bodies.iter().filter(|(_, at)| *at != Placement::identity()) {
            let body = &mechanism.bodies[*body];
            bodies.push_str(&format!("                    {}: (\n", body.name));
            body.inertia.iter().for_each(|inertia| mass(&inertia.placed(at), 24, &mut bodies));
            shape_list(&body.shapes, at, 24, &mut bodies);
            bodies.push_str("                    ),\n");
        }
        if !bodies.is_empty() {
            own.push_str(&format!("                bodies: (\n{bodies}                ),\n"));
        }
        if !own.is_empty() {
            axes.push_str(&format!("            {}: (\n{own}            ),\n", joint.name));
        }
    }
    if !axes.is_empty() {
        members.push_str(&format!("        axes: (\n{axes}        ),\n"));
    }
    if chain.flange != Placement::identity() {
        seat("flange", &chain.flange, 8, &mut members);
    }
    if !members.is_empty() {
        out.push_str("    // For the robot description: places and bodies in the frame of the axis that carries them.\n");
        out.push_str(&format!("    chain: (\n{members}    ),\n"));
    }
}

/// What the numbers refer to, for the next import: it must not put them into a diagram of another structure.
fn structure_group(mechanism: &Mechanism, chain: Option<&Chain>, out: &mut String) {
    let name = |body: Option<usize>| body.map(|body| mechanism.bodies[body].name.as_str());
    let text = |text: &str| format!("Text({})", quoted(text));
    out.push_str("    // What the numbers refer to; the next import compares it.\n    structure: (\n        joints: (\n");
    for joint in &mechanism.joints {
        let base = name(joint.base).unwrap_or("world");
        let follower = name(Some(joint.follower)).unwrap_or_default();
        let parts = [("kind", kind(joint.motion)), ("base", base), ("follower", follower)];
        let parts = parts.map(|(part, value)| format!("{part}: {}", text(value)));
        entry(out, 12, &joint.name, &super::call("", &parts, 14 + joint.name.len(), 12));
    }
    out.push_str("        ),\n");
    if let Some(chain) = chain {
        let axes: Vec<String> =
            chain.links.iter().map(|link| text(&mechanism.joints[link.joint].name)).collect();
        let flange = name(chain.flange_body).unwrap_or_default();
        let parts = [
            format!("axes: {}", super::between(["[", "]"], &axes, 22, 12)),
            format!("flange: {}", text(flange)),
        ];
        entry(out, 8, "chain", &super::call("", &parts, 15, 8));
    }
    out.push_str("    ),\n");
}

/// Whether the place of an axis is the one that the file gives it.
pub(super) fn stands_in_file(link: &ChainLink, joint: &Joint) -> bool {
    link.origin == joint.in_base
}

fn entry(out: &mut String, indent: usize, name: &str, value: &str) {
    out.push_str(&format!("{}{name}: {value},\n", " ".repeat(indent)));
}

/// The opening line of a group, with the name in the file where it is another one.
fn open(out: &mut String, name: &str, original: &str) {
    if name != original {
        out.push_str(&format!("        // {}\n", line(original)));
    }
    out.push_str(&format!("        {name}: (\n"));
}

fn body_group(body: &Body, out: &mut String) {
    if body.inertia.is_none() && body.shapes.is_empty() {
        return;
    }
    open(out, &body.name, &body.original);
    if let Some(inertia) = &body.inertia {
        mass(inertia, 12, out);
    }
    shape_list(&body.shapes, &Placement::identity(), 12, out);
    out.push_str("        ),\n");
}

/// The shapes of a body that stands at `at`; nothing where there are none.
fn shape_list(shapes: &[Shape], at: &Placement, indent: usize, out: &mut String) {
    let space = " ".repeat(indent);
    if shapes.is_empty() {
        return;
    }
    out.push_str(&format!("{space}shapes: [\n"));
    for shape in shapes {
        let shape = Shape { place: *at * shape.place, ..shape.clone() };
        out.push_str(&format!("{space}    {},\n", shape_set(&shape, indent + 4)));
    }
    out.push_str(&format!("{space}],\n"));
}

/// mass, com, moi and poi.
pub(crate) fn mass(inertia: &Inertia, indent: usize, out: &mut String) {
    let i = &inertia.about_com;
    entry(out, indent, "mass", &with_unit(inertia.mass, "kg"));
    entry(out, indent, "com", &vector(inertia.com.as_slice(), "m"));
    entry(out, indent, "moi", &vector(&[i[(0, 0)], i[(1, 1)], i[(2, 2)]], "kg*m^2"));
    entry(out, indent, "poi", &vector(&[i[(1, 2)], i[(2, 0)], i[(0, 1)]], "kg*m^2"));
}

pub(crate) fn place(place: &Placement, indent: usize, out: &mut String) {
    entry(out, indent, "translation", &vector(place.translation.as_slice(), "m"));
    entry(out, indent, "rpy", &angles(rpy(&place.rotation)));
}

/// Coordinates of a joint that a data file gives.
pub(crate) fn coordinates(start: &JointStart, indent: usize, out: &mut String) {
    for (name, value) in ["px", "py", "pz", "rz"].iter().zip(start.coordinates) {
        match value {
            Some(value) if *name == "rz" => entry(out, indent, name, &angle(value)),
            Some(value) => entry(out, indent, name, &with_unit(value, "m")),
            None => {}
        }
    }
}

fn shape_set(shape: &Shape, indent: usize) -> String {
    let role = if shape.role == Role::Visual { "visual" } else { "collision" };
    let mut members = vec![format!("use: Text(\"{role}\")")];
    members.push(match &shape.form {
        Form::Box { size } => format!("kind: Text(\"box\"), size: {}", vector(size, "m")),
        Form::Cylinder { radius, length } => format!(
            "kind: Text(\"cylinder\"), radius: {}, length: {}",
            with_unit(*radius, "m"),
            with_unit(*length, "m")
        ),
        Form::Sphere { radius } => format!("kind: Text(\"sphere\"), radius: {}", with_unit(*radius, "m")),
        Form::Mesh { file, scale, .. } => {
            format!("kind: Text(\"mesh\"), file: Text({}), scale: {}", quoted(file), plain(scale))
        }
    });
    members.push(format!("centre: {}", vector(shape.place.translation.as_slice(), "m")));
    members.push(format!("rpy: {}", angles(rpy(&shape.place.rotation))));
    members.extend(shape.colour.map(|colour| format!("colour: {}", plain(&colour))));
    super::call("", &members, indent + 1, indent)
}

fn joint_group(joint: &Joint, out: &mut String) {
    open(out, &joint.name, &joint.original);
    if joint.motion == Motion::Weld {
        let back = joint.in_follower.map_or_else(Placement::identity, |place| place.inverse());
        place(&(joint.in_base * back), 12, out);
        out.push_str("        ),\n");
        return;
    }
    place(&joint.in_base, 12, out);
    let turns = !matches!(joint.motion, Motion::Prismatic { .. });
    let one = |value: f64, rest: &str| match turns {
        true if rest.is_empty() => angle(value),
        true => angular(value),
        false => with_unit(value, &format!("m{rest}")),
    };
    if let Motion::Revolute { axis } | Motion::Prismatic { axis } = joint.motion {
        entry(out, 12, "axis", &plain(&axis));
    }
    start(joint, one, out);
    if matches!(joint.motion, Motion::Revolute { .. } | Motion::Prismatic { .. }) {
        let unit = if turns { "N*m*s/rad" } else { "N*s/m" };
        entry(out, 12, "damping", &with_unit(joint.damping, unit));
    }
    if let Some([lower, upper]) = joint.range {
        entry(out, 12, "lower", &one(lower, ""));
        entry(out, 12, "upper", &one(upper, ""));
    }
    if let Some(speed) = joint.speed {
        entry(out, 12, "speed", &one(speed, "/s"));
    }
    if let Some(effort) = joint.effort {
        entry(out, 12, "effort", &with_unit(effort, if turns { "N*m" } else { "N" }));
    }
    if let Some(end) = &joint.in_follower {
        out.push_str("            // The frame of the joint in the body that moves.\n            end: (\n");
        place(end, 16, out);
        out.push_str("            ),\n");
    }
    out.push_str("        ),\n");
}

fn start(joint: &Joint, one: impl Fn(f64, &str) -> String, out: &mut String) {
    match (joint.start, joint.motion) {
        (Start::Open, _) => {}
        (Start::Position(position), _) => entry(out, 12, "position", &one(position, "")),
        (Start::Placement(at), motion) => {
            let [x, y, z] = at.translation.into();
            let [roll, pitch, yaw] = rpy(&at.rotation);
            match motion {
                Motion::Cylindrical => {
                    entry(out, 12, "position", &with_unit(z, "m"));
                    entry(out, 12, "angle", &angle(yaw));
                }
                Motion::Planar => {
                    entry(out, 12, "position", &vector(&[x, y], "m"));
                    entry(out, 12, "angle", &angle(yaw));
                }
                Motion::Free => {
                    entry(out, 12, "position", &vector(&[x, y, z], "m"));
                    entry(out, 12, "start_rpy", &angles([roll, pitch, yaw]));
                }
                _ => entry(out, 12, "start_rpy", &angles([roll, pitch, yaw])),
            }
        }
    }
}
