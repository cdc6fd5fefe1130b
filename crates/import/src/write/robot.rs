//! The description of a robot: a chain of axes with frames and limits, which names the numbers of the parameter file.

use blocksim_multibody::Placement;

use super::diagram::{Files, line, quoted};
use super::parameters::stands_in_file;
use crate::chain::{Chain, ChainLink};
use crate::mechanism::{Joint, Mechanism, Motion, Start};

/// The text of the description of a chain, and what it assumes because the file does not say it, in words for the user.
///
/// Like the diagram it is for its user to change, and is written once.
pub fn robot(mechanism: &Mechanism, chain: &Chain, files: &Files) -> (String, Vec<String>) {
    let mut out = format!(
        "// {} as one description, for kinematics, planning and dynamics: the mechanism of\n// {}, made of the same \
         numbers. Importing again leaves this file alone.\n//\n// {} has no accelerations: here every axis comes to \
         full speed within\n// 0.5 s, and the tool may do 5 m/s and 20 m/s^2. Put in what yours can do; motors, gears and bearings \
         go into\n// `drive` of an axis, a tool into `tool` and `load`.\n(\n",
        line(&mechanism.name),
        line(files.diagram),
        line(files.source),
    );
    out.push_str(&format!("    name: Text({}),\n", quoted(&mechanism.name)));
    if chain.base != Placement::identity() {
        out.push_str("    base: \"model.chain.base\",\n");
    }
    if !chain.pedestal.is_empty() {
        let name = |body: &usize| format!("\"model.bodies.{}\"", mechanism.bodies[*body].name);
        let names: Vec<String> = chain.pedestal.iter().map(name).collect();
        out.push_str(&format!("    pedestal: {},\n", super::between(["[", "]"], &names, 14, 4)));
    }
    out.push_str("    links: [\n");
    let mut assumed = vec!["accelerations".to_owned(), "how fast the tool may be".to_owned()];
    for link in &chain.links {
        out.push_str("        (\n");
        axis(mechanism, link, &mut out, &mut assumed);
        out.push_str("        ),\n");
    }
    out.push_str("    ],\n");
    let at = chain.flange_body.map(|body| format!("    // {}\n", line(&mechanism.bodies[body].original)));
    if chain.flange != Placement::identity() {
        out.push_str(&format!("{}    flange: \"model.chain.flange\",\n", at.unwrap_or_default()));
    }
    out.push_str("    tcp_limits: (speed: \"5 m/s\", acceleration: \"20 m/s^2\"),\n)\n");
    (out, assumed)
}

fn axis(mechanism: &Mechanism, link: &ChainLink, out: &mut String, assumed: &mut Vec<String>) {
    let joint = &mechanism.joints[link.joint];
    let path = format!("model.joints.{}", joint.name);
    let own = format!("model.chain.axes.{}", joint.name);
    let mut entry = |name: &str, value: &str| out.push_str(&format!("            {name}: {value},\n"));
    entry("name", &format!("Text({})", quoted(&joint.original)));
    let origin = match stands_in_file(link, joint) {
        true => format!("(translation: \"{path}.translation\", rpy: \"{path}.rpy\")"),
        false => format!("\"{own}.origin\""),
    };
    entry("origin", &origin);
    let slides = matches!(joint.motion, Motion::Prismatic { .. });
    entry(if slides { "slide" } else { "axis" }, &format!("\"{path}.axis\""));
    entry("limits", &limits(joint, &path, assumed));
    if joint.start != Start::Open {
        entry("start", &format!("\"{path}.position\""));
    }
    let bodies: Vec<String> = link
        .bodies
        .iter()
        .map(|(body, at)| {
            let name = &mechanism.bodies[*body].name;
            match *at == Placement::identity() {
                true => format!("\"model.bodies.{name}\""),
                false => format!("\"{own}.bodies.{name}\""),
            }
        })
        .collect();
    entry("bodies", &super::between(["[", "]"], &bodies, 20, 12));
    if joint.damping != 0.0 {
        let [zero, speed] = if slides { ["0 N", "0.1 m/s"] } else { ["0 N*m", "0.1 rad/s"] };
        let bearing = [
            format!("breakaway: \"{zero}\", breakaway_velocity: \"{speed}\", coulomb: \"{zero}\""),
            format!("viscous: \"{path}.damping\""),
        ];
        entry("drive", &format!("({})", super::call("bearing: ", &bearing, 20, 12)));
    }
}

/// What the axis can do: as the file has it, and assumed where the file says nothing.
fn limits(joint: &Joint, path: &str, assumed: &mut Vec<String>) -> String {
    let slides = matches!(joint.motion, Motion::Prismatic { .. });
    let [speed, acceleration] = match slides {
        true => ["0.5 m/s", "1 m/s^2"],
        false => ["90 deg/s", "180 deg/s^2"],
    };
    let mut members = match joint.range {
        Some(_) => ["lower", "upper"].map(|name| format!("{name}: \"{path}.{name}\"")).to_vec(),
        // What turns without a limit goes round and round: a stop would be made up.
        None if !slides => vec!["lower: -inf".to_owned(), "upper: inf".to_owned()],
        None => {
            assumed.push(format!("the range of `{}`", joint.original));
            vec!["lower: \"-1 m\"".to_owned(), "upper: \"1 m\"".to_owned()]
        }
    };
    match joint.speed {
        Some(_) => {
            members.push(format!("speed: \"{path}.speed\""));
            members.push(format!("acceleration: \"{path}.speed / 0.5 s\""));
        }
        None => {
            assumed.push(format!("the speed of `{}`", joint.original));
            members.push(format!("speed: \"{speed}\""));
            members.push(format!("acceleration: \"{acceleration}\""));
        }
    }
    super::call("", &members, 20, 12)
}
