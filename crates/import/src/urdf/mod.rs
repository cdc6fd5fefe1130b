//! Robot descriptions in URDF.
//!
//! Read as <https://wiki.ros.org/urdf/XML> describes them: lengths in m, angles in rad, masses in kg; the frame of
//! a joint is the frame of its child at position zero.

mod joint;
mod link;
mod tree;

use std::collections::BTreeMap;
use std::path::Path;

use crate::fault::{Fault, keep};
use crate::mechanism::{Body, Joint, Mechanism};
use crate::names::Names;
use crate::xml::{self, Element};

/// Names of blocks that every imported diagram has.
pub(crate) const TAKEN: [&str; 4] = ["world", "angles", "positions", "in"];

/// Most links of a robot.
const MOST: usize = 10_000;

/// Reads a URDF file. `filled`: links without mass get theirs later, from their meshes.
///
/// # Errors
/// All faults of the file: what is no XML or no robot, numbers that are none, impossible masses, joints whose
/// links do not exist, links that are not one tree.
pub fn read(file: &Path, bytes: &[u8], filled: bool) -> Result<Mechanism, Vec<Fault>> {
    let one = |fault| vec![fault];
    let text = xml::text(file, bytes).map_err(one)?;
    let document = xml::parse(file, text).map_err(one)?;
    let robot = Element::root(file, &document);
    if robot.name() != "robot" {
        let reason = format!("the outermost element is <{}>, that of a URDF file is <robot>", robot.name());
        return Err(vec![robot.fault(reason, "is it the right file? name its kind with --as")]);
    }
    let mut faults = Vec::new();
    let mut notes = Vec::new();
    let mut names = Names::new(&TAKEN);
    left_out(robot, &mut notes, &mut faults);
    let links = links(robot, &mut names, &mut notes, &mut faults);
    let joints = joints(robot, &links, &mut names, &mut notes, &mut faults);
    if faults.is_empty() {
        tree::check(robot, &links, &joints, filled, &mut faults);
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let name = robot.attribute("name").unwrap_or("robot").to_owned();
    let bodies = links.bodies.into_iter().map(|(_, body)| body).collect();
    let joints = joints.into_iter().map(|(_, joint)| joint).collect();
    Ok(Mechanism { name, bodies, joints, notes })
}

/// Links with their elements, and where each name stands.
pub(crate) struct Links<'a, 'd> {
    bodies: Vec<(Element<'a, 'd>, Body)>,
    index: BTreeMap<&'a str, usize>,
}

fn links<'a, 'd>(
    robot: Element<'a, 'd>,
    names: &mut Names,
    notes: &mut Vec<String>,
    faults: &mut Vec<Fault>,
) -> Links<'a, 'd> {
    let mut links = Links { bodies: Vec::new(), index: BTreeMap::new() };
    let colours = link::colours(robot);
    for element in robot.all("link") {
        if links.bodies.len() == MOST {
            let _ = keep::<()>(
                Err(element.fault(format!("there are more than {MOST} links"), "import parts of it")),
                faults,
            );
            return links;
        }
        let Some(original) = keep(element.called(), faults) else { continue };
        if links.index.insert(original, links.bodies.len()).is_some() {
            let fault = element.fault(format!("there are two links `{original}`"), "rename one of them");
            let _ = keep::<()>(Err(fault), faults);
        }
        let read = link::read(element, original, names.give(original), &colours, notes);
        // A link that cannot be read still counts, or its joints would be blamed, too.
        let unread =
            || Body { name: String::new(), original: String::new(), inertia: None, shapes: Vec::new() };
        links.bodies.push((element, keep(read, faults).unwrap_or_else(unread)));
    }
    if links.bodies.is_empty() {
        let _ =
            keep::<()>(Err(robot.fault("the robot has no links", "a robot has at least one <link>")), faults);
    }
    links
}

fn joints<'a, 'd>(
    robot: Element<'a, 'd>,
    links: &Links<'a, 'd>,
    names: &mut Names,
    notes: &mut Vec<String>,
    faults: &mut Vec<Fault>,
) -> Vec<(Element<'a, 'd>, Joint)> {
    let mut known = BTreeMap::new();
    let mut joints = Vec::new();
    for element in robot.all("joint") {
        let Some(original) = keep(element.called(), faults) else { continue };
        if known.insert(original, ()).is_some() {
            let fault = element.fault(format!("there are two joints `{original}`"), "rename one of them");
            let _ = keep::<()>(Err(fault), faults);
        }
        let read = joint::read(element, original, names.give_joint(original), &links.index, notes);
        joints.extend(keep(read, faults).map(|joint| (element, joint)));
    }
    joints
}

/// Notes what the file has besides links and joints.
fn left_out(robot: Element, notes: &mut Vec<String>, faults: &mut Vec<Fault>) {
    let mut counts = BTreeMap::new();
    for element in robot.children() {
        match element.name() {
            "link" | "joint" | "material" => {}
            _ if element.node.tag_name().namespace().is_some_and(|name| name.contains("xacro")) => {
                let fault = element.fault(
                    format!("<xacro:{}> is a macro, not part of URDF", element.name()),
                    "expand the file with xacro first",
                );
                let _ = keep::<()>(Err(fault), faults);
            }
            name => *counts.entry(name).or_insert(0) += 1,
        }
    }
    notes.extend(counts.iter().map(|(name, n)| format!("left out: <{name}> ({n} times)")));
}
