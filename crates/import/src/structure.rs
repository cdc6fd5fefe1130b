//! What the numbers of a parameter file refer to: what each joint connects, of which kind it is, and the chain of axes.
//!
//! A diagram is wired once, by the structure that the file had then. Numbers of another structure would be read there as
//! something else: the place of a joint in a body that does not carry it any more.

use std::collections::{BTreeMap, BTreeSet};

use blocksim_syntax::{Node, Shape, read};

use crate::update::values;

/// A joint as the diagram has it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Connection {
    /// The kind of its block.
    kind: String,
    /// The body that carries it, or `world`.
    base: String,
    /// The body that moves.
    follower: String,
}

/// The chain of the robot description.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
struct Axes {
    /// Joints, from the base on; none where there is no chain.
    axes: Vec<String>,
    /// The body whose frame the flange is; empty for the frame of the last axis.
    flange: String,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Structure {
    joints: BTreeMap<String, Connection>,
    chain: Axes,
}

/// A difference of structure, for which a text that names the numbers is to be changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Restructured {
    /// What differs, in words.
    pub what: String,
    /// What does not fit any more.
    pub part: Part,
}

/// What is made by a structure.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Part {
    /// The diagram, where it names numbers below this path.
    Diagram(String),
    /// The description of the robot.
    Robot,
    /// All of it: the structure is not known.
    All,
}

/// How the structure of a parameter file differs from that of the one before, as far as texts that were wired by the old one
/// could be read with the new numbers and mean something else. What came and what went altogether is no part of it.
pub fn restructured(old: &str, new: &str) -> Vec<Restructured> {
    let (Some(before), Some(now)) = (structure(old), structure(new)) else {
        let what = "it does not state what its joints connect, as an earlier version wrote it".to_owned();
        return vec![Restructured { what, part: Part::All }];
    };
    let (old, new) = (values(old), values(new));
    let mut found: Vec<Restructured> = now
        .joints
        .iter()
        .filter_map(|(name, joint)| {
            let what = match before.joints.get(name) {
                Some(earlier) => changes(earlier, joint)
                    .or_else(|| ends_elsewhere(name, &old, &new))
                    .map(|what| (what, format!("joints.{name}"))),
                None => held_anew(joint, &before, &now, &old)
                    .map(|what| (what, format!("bodies.{}", joint.follower))),
            };
            what.map(|(what, path)| Restructured {
                what: format!("`{name}` {what}"),
                part: Part::Diagram(path),
            })
        })
        .collect();
    let other = |what| Restructured { what, part: Part::Robot };
    found.extend(other_chain(&before.chain, &now, &old, &new).into_iter().map(other));
    found
}

/// What a joint that both files have connects now.
fn changes(before: &Connection, now: &Connection) -> Option<String> {
    let mut parts = Vec::new();
    if before.kind != now.kind {
        parts.push(format!("is a {} (before a {})", now.kind, before.kind));
    }
    if before.base != now.base {
        parts.push(format!("is carried by `{}` (before by `{}`)", now.base, before.base));
    }
    if before.follower != now.follower {
        parts.push(format!("moves `{}` (before `{}`)", now.follower, before.follower));
    }
    (!parts.is_empty()).then(|| parts.join(" and "))
}

type Values = BTreeMap<String, String>;

/// Whether there are numbers below a path.
fn below(values: &Values, path: &str) -> bool {
    let start = format!("{path}.");
    values.range(start.clone()..).next().is_some_and(|(key, _)| key.starts_with(&start))
}

/// A joint that acts off the frame of the body that moves, for which the diagram has no transform yet. The reverse shows by
/// itself: the diagram then names what has gone.
fn ends_elsewhere(joint: &str, old: &Values, new: &Values) -> Option<String> {
    let end = format!("joints.{joint}.end");
    (below(new, &end) && !below(old, &end))
        .then(|| "has a frame of its own in the body that moves (before none)".to_owned())
}

/// A new joint that holds a body which was there before, with no other joint gone for it.
fn held_anew(joint: &Connection, before: &Structure, now: &Structure, old: &Values) -> Option<String> {
    let body = &joint.follower;
    let holders = |all: &Structure| all.joints.values().filter(|joint| joint.follower == *body).count();
    let was_there = below(old, &format!("bodies.{body}"))
        || before.joints.values().any(|joint| joint.base == *body || joint.follower == *body);
    (was_there && holders(now) > holders(before))
        .then(|| format!("is new and holds `{body}`, which was there before"))
}

/// What a description that was made of another chain gets wrong.
fn other_chain(before: &Axes, structure: &Structure, old: &Values, new: &Values) -> Vec<String> {
    let now = &structure.chain;
    // The description names what has gone, and shows it.
    if before.axes.iter().any(|axis| !structure.joints.contains_key(axis)) {
        return Vec::new();
    }
    let list = |axes: &[String]| match axes {
        [] => "none".to_owned(),
        axes => axes.iter().map(|axis| format!("`{axis}`")).collect::<Vec<_>>().join(", "),
    };
    if before.axes != now.axes {
        return vec![format!(
            "the axes of the chain, which --tip chooses, are {} (before {})",
            list(&now.axes),
            list(&before.axes)
        )];
    }
    let mut found = Vec::new();
    if before.flange != now.flange {
        let flange = |name: &str| match name {
            "" => "the frame of the last axis".to_owned(),
            name => format!("`{name}`"),
        };
        found.push(format!(
            "the flange, which --tip chooses, is {} (before {})",
            flange(&now.flange),
            flange(&before.flange)
        ));
    }
    found.extend(
        own_frames(old, new)
            .iter()
            .map(|path| format!("`{path}` is new, and the description does not name it")),
    );
    found
}

/// Places and bodies that have stood in the frame of their axis, so that the description names what the file gives, and do no more.
fn own_frames<'a>(old: &Values, new: &'a Values) -> BTreeSet<&'a str> {
    let groups = new.keys().filter_map(|path| Some(path.rsplit_once('.')?.0));
    let was_there = |group: &str| match group.rsplit_once(".bodies.") {
        Some((_, body)) => below(old, &format!("bodies.{body}")),
        None => true,
    };
    groups.filter(|group| group.starts_with("chain.") && !below(old, group) && was_there(group)).collect()
}

/// The structure that a parameter file states.
fn structure(text: &str) -> Option<Structure> {
    let root = read(text).ok()?;
    let stated = member(&root, "structure")?;
    let joints = member(stated, "joints")?.members()?.iter().map(|(name, joint)| {
        let [kind, base, follower] =
            ["kind", "base", "follower"].map(|part| member(joint, part).and_then(text_of));
        Some((name.text.clone(), Connection { kind: kind?, base: base?, follower: follower? }))
    });
    let joints = joints.collect::<Option<_>>()?;
    let chain = match member(stated, "chain") {
        None => Axes::default(),
        Some(chain) => {
            let Shape::List(axes) = &member(chain, "axes")?.value else { return None };
            let axes = axes.iter().map(text_of).collect::<Option<_>>()?;
            Axes { axes, flange: member(chain, "flange").and_then(text_of)? }
        }
    };
    Some(Structure { joints, chain })
}

fn member<'a>(node: &'a Node, name: &str) -> Option<&'a Node> {
    node.members()?.iter().find(|(member, _)| member.text == name).map(|(_, node)| node)
}

/// The text of `Text("...")`.
fn text_of(node: &Node) -> Option<String> {
    match &node.value {
        Shape::Tuple(Some(word), items) if word.text == "Text" => match items.first().map(|item| &item.value)
        {
            Some(Shape::Text(text)) => Some(text.clone()),
            _ => None,
        },
        _ => None,
    }
}
