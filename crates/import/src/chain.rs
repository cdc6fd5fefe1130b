//! A mechanism as a chain of axes from the ground to a flange, which is what robots are described by.

use blocksim_multibody::Placement;

use crate::mechanism::{Body, Mechanism, Motion, Start};

/// Axes one behind the other, with what each of them carries.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// The mounting surface in the world: the frame of the body that carries the first axis.
    pub base: Placement,
    /// Bodies with mass and shapes that stand still in the base, indices.
    pub pedestal: Vec<usize>,
    /// From the base on.
    pub links: Vec<ChainLink>,
    /// The flange in the frame of the last axis.
    pub flange: Placement,
    /// The body whose frame the flange is, an index; `None` for the frame of the last axis.
    pub flange_body: Option<usize>,
    /// What the chain leaves out or counts as fixed, in words for the user.
    pub notes: Vec<String>,
}

/// An axis with the rigid bodies that hang on it.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainLink {
    /// The joint, an index.
    pub joint: usize,
    /// Frame of the axis in that of the axis before, or in the base.
    pub origin: Placement,
    /// Bodies with mass, indices, and where their frames are in that of the axis.
    pub bodies: Vec<(usize, Placement)>,
}

/// Where a body is: in the frame of an axis (`None`: of the world).
#[derive(Debug, Clone, Copy)]
struct Seat {
    axis: Option<usize>,
    place: Placement,
}

/// The chain of a mechanism whose axes all follow each other; with `tip`, the name of a body, the chain that leads there.
/// Joints beside the chain count as fixed where they start.
///
/// # Errors
/// Why there is none, in words, with a remedy where there is one.
pub fn chain(mechanism: &Mechanism, tip: Option<&str>) -> Result<Chain, String> {
    if mechanism.has_loop() {
        return Err("joints close a loop, which is not a chain of axes".to_owned());
    }
    let tip = tip.map(|name| named(mechanism, name)).transpose()?;
    let axes = axes(mechanism, tip)?;
    let Some(last) = axes.last() else { return Err("nothing moves".to_owned()) };
    for axis in &axes {
        let joint = &mechanism.joints[*axis];
        if !matches!(joint.motion, Motion::Revolute { .. } | Motion::Prismatic { .. }) {
            return Err(format!("the joint `{}` has more than one axis", joint.original));
        }
    }
    let seats = seats(mechanism, &axes);
    let bodies = &mechanism.bodies;
    let in_front = |joint: usize| match mechanism.joints[joint].base {
        Some(body) => seats[body].place * mechanism.joints[joint].in_base,
        None => mechanism.joints[joint].in_base,
    };
    // The base is where the first axis is carried, so that its origin is that of the file.
    let base = mechanism.joints[axes[0]].base.map_or_else(Placement::identity, |body| seats[body].place);
    let links = axes.iter().enumerate().map(|(i, joint)| ChainLink {
        joint: *joint,
        origin: match i {
            0 => mechanism.joints[*joint].in_base,
            _ => in_front(*joint),
        },
        bodies: (0..mechanism.bodies.len())
            .filter(|body| seats[*body].axis == Some(*joint) && mechanism.bodies[*body].inertia.is_some())
            .map(|body| (body, seats[body].place))
            .collect(),
    });
    let links = links.collect();
    let stands = |body: &usize| seats[*body].axis.is_none() && seats[*body].place == base;
    let solid = |body: &usize| bodies[*body].inertia.is_some() && !bodies[*body].shapes.is_empty();
    let pedestal = (0..bodies.len()).filter(|body| stands(body) && solid(body)).collect();
    let mut notes = Vec::new();
    for (i, joint) in mechanism.joints.iter().enumerate() {
        if joint.motion != Motion::Weld && !axes.contains(&i) && seats[joint.follower].axis.is_some() {
            notes.push(format!("`{}` counts as fixed in the robot description", joint.original));
        }
    }
    let flange_body = tip.or_else(|| flange(mechanism, &seats, *last, &mut notes));
    let flange = flange_body.map_or_else(Placement::identity, |body| seats[body].place);
    Ok(Chain { base, pedestal, links, flange, flange_body, notes })
}

fn named(mechanism: &Mechanism, name: &str) -> Result<usize, String> {
    let fits = |body: &Body| body.name == name || body.original == name;
    mechanism.bodies.iter().position(fits).ok_or_else(|| {
        let names: Vec<&str> = mechanism.bodies.iter().take(20).map(|body| body.name.as_str()).collect();
        format!("there is no body `{name}`; there are {}", names.join(", "))
    })
}

/// The joint that carries each body.
fn carriers(mechanism: &Mechanism) -> Vec<Option<usize>> {
    let mut carrier = vec![None; mechanism.bodies.len()];
    for (i, joint) in mechanism.joints.iter().enumerate() {
        carrier[joint.follower] = Some(i);
    }
    carrier
}

/// Joints that move, from the ground to a body, an index.
fn way(mechanism: &Mechanism, carriers: &[Option<usize>], body: usize) -> Vec<usize> {
    let mut way = Vec::new();
    let mut next = Some(body);
    // Without loops no way is longer than there are joints.
    for _ in 0..=mechanism.joints.len() {
        let Some(joint) = next.and_then(|body| carriers[body]) else { break };
        if mechanism.joints[joint].motion != Motion::Weld {
            way.push(joint);
        }
        next = mechanism.joints[joint].base;
    }
    way.reverse();
    way
}

fn axes(mechanism: &Mechanism, tip: Option<usize>) -> Result<Vec<usize>, String> {
    let carriers = carriers(mechanism);
    if let Some(tip) = tip {
        return Ok(way(mechanism, &carriers, tip));
    }
    let moving: Vec<usize> =
        (0..mechanism.joints.len()).filter(|i| mechanism.joints[*i].motion != Motion::Weld).collect();
    let longest = moving
        .iter()
        .map(|i| way(mechanism, &carriers, mechanism.joints[*i].follower))
        .max_by_key(Vec::len)
        .unwrap_or_default();
    match moving.iter().find(|i| !longest.contains(i)) {
        None => Ok(longest),
        Some(beside) => Err(format!(
            "the joints branch (`{}`); choose a chain by the body at its end, such as --tip {}",
            mechanism.joints[*beside].original,
            longest.last().map_or("hand", |joint| &mechanism.bodies[mechanism.joints[*joint].follower].name),
        )),
    }
}

/// Where every body is in the frame of the axis that carries it.
fn seats(mechanism: &Mechanism, axes: &[usize]) -> Vec<Seat> {
    let ground = Seat { axis: None, place: Placement::identity() };
    let mut seats: Vec<Option<Seat>> = vec![None; mechanism.bodies.len()];
    for (seat, carrier) in seats.iter_mut().zip(carriers(mechanism)) {
        if carrier.is_none() {
            *seat = Some(ground);
        }
    }
    let mut open: Vec<usize> = (0..mechanism.joints.len()).collect();
    loop {
        let before = open.len();
        open.retain(|i| {
            let joint = &mechanism.joints[*i];
            let base = match joint.base {
                None => Some(ground),
                Some(body) => seats[body],
            };
            let Some(base) = base else { return true };
            let back = joint.in_follower.map_or_else(Placement::identity, |place| place.inverse());
            seats[joint.follower] = Some(match axes.contains(i) {
                true => Seat { axis: Some(*i), place: back },
                false => Seat { axis: base.axis, place: base.place * joint.in_base * held(joint) * back },
            });
            false
        });
        if open.len() == before {
            break;
        }
    }
    seats.into_iter().map(|seat| seat.unwrap_or(ground)).collect()
}

/// How far a joint that counts as fixed has moved.
fn held(joint: &crate::mechanism::Joint) -> Placement {
    match (joint.start, joint.motion) {
        (Start::Position(angle), Motion::Revolute { axis }) => {
            Placement::from_axis_angle([0.0; 3], axis, angle)
        }
        (Start::Position(way), Motion::Prismatic { axis }) => {
            Placement::from_translation(axis.map(|a| a * way))
        }
        (Start::Placement(place), _) => place,
        _ => Placement::identity(),
    }
}

/// The frame at the end of the chain: one without mass that nothing hangs on. Where there are several, the one that is
/// called as robot descriptions call it.
fn flange(mechanism: &Mechanism, seats: &[Seat], last: usize, notes: &mut Vec<String>) -> Option<usize> {
    const USUAL: [&str; 5] = ["tool0", "tcp", "tool", "flange", "ee_link"];
    let bodies = &mechanism.bodies;
    let at_end = |body: usize| mechanism.joints.iter().all(|joint| joint.base != Some(body));
    let frames: Vec<usize> = (0..bodies.len())
        .filter(|body| seats[*body].axis == Some(last) && bodies[*body].inertia.is_none() && at_end(*body))
        .collect();
    match frames[..] {
        [] => None,
        [only] => Some(only),
        _ => {
            let usual = USUAL.iter().find_map(|name| frames.iter().find(|body| bodies[**body].name == *name));
            if usual.is_none() {
                let names: Vec<&str> = frames.iter().map(|body| bodies[*body].name.as_str()).collect();
                notes.push(format!(
                    "several frames end the chain ({}): the flange is that of the last axis; choose one with --tip",
                    names.join(", ")
                ));
            }
            usual.copied()
        }
    }
}
