//! From frames that are joined to a tree of bodies and the loops that it closes.

use std::collections::VecDeque;

use blocksim_block::physical::{Axis, Element, Freedom};
use blocksim_multibody::{Inertia, Joint, ModelBuilder, Placement};
use nalgebra::Matrix3;

use crate::assembly::closing;
use crate::assembly::members::Members;
use crate::mechanics::frames::{Ball, Frames, JointSpeed, Loop, Payload, Probe};
use crate::mechanics::place::Place;
use crate::mechanics::scene;
use crate::problem::NetworkProblem;

/// An edge between two frame nodes.
#[derive(Clone, Copy)]
struct Edge<'a> {
    to: usize,
    member: usize,
    /// A transform or a joint.
    element: &'a Element,
    /// Number of the element among all of them.
    number: usize,
    /// Freedoms of the member's joints before this one.
    first: usize,
    /// From `base` to `follower`.
    forward: bool,
}

/// Builds the tree from the world outwards.
pub(crate) fn build(m: &Members) -> Result<Frames, Vec<NetworkProblem>> {
    if m.frame_nodes == 0 {
        return Ok(Frames::default());
    }
    let (root, gravity) = world(m)?;
    let (edges, count) = edges(m);
    let mut builder = ModelBuilder::new();
    builder.gravity(gravity);
    let mut frames = Frames::default();
    let mut places: Vec<Option<Place>> = vec![None; m.frame_nodes];
    let mut used = vec![false; count];
    places[root] = Some(Place { body: None, placement: Placement::identity() });
    let mut queue = VecDeque::from([root]);
    while let Some(node) = queue.pop_front() {
        let Some(place) = places[node] else { continue };
        for edge in &edges[node] {
            if std::mem::replace(&mut used[edge.number], true) {
                continue;
            }
            let next = match edge.element {
                Element::Joint { freedoms, .. } => {
                    add_joint(m, &mut builder, &mut frames, edge, freedoms, place)
                        .map_err(|problem| vec![problem])?
                }
                transform => place.then(placement_of(transform, edge.forward)),
            };
            match places[edge.to] {
                // The frame is reached a second time: from both ways it must be the same.
                Some(there) => frames.loops.push(Loop { member: edge.member, a: next, b: there }),
                None => {
                    places[edge.to] = Some(next);
                    queue.push_back(edge.to);
                }
            }
        }
    }
    let problems = add_bodies(m, &places, &mut builder, &mut frames);
    if !problems.is_empty() {
        return Err(problems);
    }
    frames.model = Some(builder.build());
    frames.number_by_member();
    frames.asked.clone_from(&frames.position);
    closing::assemble(m, &mut frames)?;
    let problems = closing::beyond_travel(m, &frames);
    if !problems.is_empty() {
        return Err(problems);
    }
    frames.scene = scene::build(m, &places, &frames);
    Ok(frames)
}

/// Node of the world and its gravity.
fn world(m: &Members) -> Result<(usize, [f64; 3]), Vec<NetworkProblem>> {
    let worlds: Vec<(usize, usize, [f64; 3])> = m
        .elements()
        .filter_map(|(member, element)| match element {
            Element::World { frame, gravity } => Some((member, m.node(member, *frame), *gravity)),
            _ => None,
        })
        .collect();
    let Some((first, root, gravity)) = worlds.first() else {
        return Err(vec![no_world(m)]);
    };
    match worlds.iter().find(|(_, node, other)| node != root || other != gravity) {
        Some((member, ..)) => Err(vec![
            NetworkProblem::new(
                "closed_loop",
                "this mechanism has two worlds",
                "keep one World and connect to it",
            )
            .with(*member, "is the second")
            .with(*first, "is the first"),
        ]),
        None => Ok((*root, *gravity)),
    }
}

/// Edges that leave each node, and how many elements they stand for.
fn edges<'a>(m: &Members<'a>) -> (Vec<Vec<Edge<'a>>>, usize) {
    let mut edges = vec![Vec::new(); m.frame_nodes];
    let mut freedoms = vec![0; m.list.len()];
    let mut number = 0;
    for (member, element) in m.elements() {
        let (Element::Transform { base, follower, .. } | Element::Joint { base, follower, .. }) = element
        else {
            continue;
        };
        let (base, follower) = (m.node(member, *base), m.node(member, *follower));
        let first = freedoms[member];
        edges[base].push(Edge { to: follower, member, element, number, first, forward: true });
        edges[follower].push(Edge { to: base, member, element, number, first, forward: false });
        number += 1;
        if let Element::Joint { freedoms: of_joint, .. } = element {
            freedoms[member] += of_joint.len();
        }
    }
    (edges, number)
}

/// Adds the freedoms of a joint to the tree; returns where its far end is.
fn add_joint(
    m: &Members,
    builder: &mut ModelBuilder,
    frames: &mut Frames,
    edge: &Edge,
    freedoms: &[Freedom],
    place: Place,
) -> Result<Place, NetworkProblem> {
    let member = edge.member;
    let sign = if edge.forward { 1.0 } else { -1.0 };
    let order: Vec<usize> = match edge.forward {
        true => (0..freedoms.len()).collect(),
        false => (0..freedoms.len()).rev().collect(),
    };
    let mut here = place;
    for k in order {
        let joint = match &freedoms[k] {
            Freedom::Turn(axis) => Joint::revolute(axis.direction.map(|a| sign * a)),
            Freedom::Slide(axis) => Joint::prismatic(axis.direction.map(|a| sign * a)),
            Freedom::Ball { .. } => Joint::Spherical,
        };
        let body = builder
            .add_body(here.body, joint, here.placement, Inertia::zero())
            .map_err(|reason| refused(member, &reason))?;
        frames.body_members.push(member);
        here = Place { body: Some(body), placement: Placement::identity() };
        match &freedoms[k] {
            Freedom::Turn(axis) => add_axis(frames, m.path(member), member, (edge.first + k, false), axis),
            Freedom::Slide(axis) => add_axis(frames, m.path(member), member, (edge.first + k, true), axis),
            Freedom::Ball { orientation, velocity } => {
                let ball = Ball {
                    member,
                    position: frames.position.len(),
                    speed: frames.speeds.len(),
                    user: 0,
                    flipped: !edge.forward,
                };
                add_ball(frames, m.path(member), edge.first + k, ball, *orientation, *velocity);
            }
        }
    }
    Ok(here)
}

fn add_axis(frames: &mut Frames, path: &str, member: usize, (freedom, slides): (usize, bool), axis: &Axis) {
    let [position, speed] = axis.names;
    frames.speeds.push(JointSpeed {
        member,
        freedom,
        position: Some(frames.position.len()),
        user: 0,
        name: format!("{path}.{speed}"),
        start: axis.velocity,
        given: axis.position.is_some(),
        slides,
    });
    frames.position.push(axis.position.unwrap_or(0.0));
    frames.position_names.push(format!("{path}.{position}"));
    frames.signals.push(format!("{path}.{position}"));
}

fn add_ball(
    frames: &mut Frames,
    path: &str,
    freedom: usize,
    ball: Ball,
    orientation: Option<[f64; 4]>,
    velocity: Option<[f64; 3]>,
) {
    let mut p = orientation.unwrap_or([1.0, 0.0, 0.0, 0.0]);
    let mut speeds = velocity.map(nalgebra::Vector3::from);
    if ball.flipped {
        speeds = speeds.map(|speeds| -(crate::mechanics::joints::rotation(p) * speeds));
        p = [p[0], -p[1], -p[2], -p[3]];
    }
    for k in 0..3 {
        frames.speeds.push(JointSpeed {
            member: ball.member,
            freedom,
            position: None,
            user: 0,
            name: format!("{path}.w[{k}]"),
            start: speeds.map(|speeds| speeds[k]),
            given: orientation.is_some(),
            slides: false,
        });
    }
    let length = p.iter().map(|e| e * e).sum::<f64>().sqrt();
    frames.position.extend(p.map(|e| e / length));
    frames.position_names.extend((0..4).map(|k| format!("{path}.p[{k}]")));
    // Against the direction of the joint the tree turns the other way than the joint's own output says.
    let shown = if ball.flipped { "p_inverse" } else { "p" };
    frames.signals.extend((0..4).map(|k| format!("{path}.{shown}[{k}]")));
    frames.balls.push(ball);
}

/// Gives the tree its masses and finds the frames that members look at.
fn add_bodies(
    m: &Members,
    places: &[Option<Place>],
    builder: &mut ModelBuilder,
    frames: &mut Frames,
) -> Vec<NetworkProblem> {
    let mut problems = Vec::new();
    for (member, element) in m.elements() {
        let (Element::Body { frame, .. }
        | Element::Payload { frame, .. }
        | Element::FrameProbe { frame }
        | Element::FrameForce { frame }
        | Element::Transform { base: frame, .. }
        | Element::Joint { base: frame, .. }) = element
        else {
            continue;
        };
        // A probe that is not connected looks from the world.
        let world = matches!(element, Element::FrameProbe { .. }) && m.alone(member, *frame);
        let at_world = world.then_some(Place { body: None, placement: Placement::identity() });
        let Some(place) = places[m.node(member, *frame)].or(at_world) else {
            problems.push(floats(m, member));
            continue;
        };
        match element {
            Element::Body { mass, com, moi, poi, .. } => {
                let Some(body) = place.body else { continue };
                let added = Inertia::from_moments(*mass, *com, *moi, *poi)
                    .map_err(|reason| refused(member, &reason))
                    .and_then(|inertia| {
                        builder
                            .add_inertia(body, place.placement, inertia)
                            .map_err(|reason| refused(member, &reason))
                    });
                problems.extend(added.err());
            }
            Element::Payload { mass, com, moi, poi, .. } => {
                match Inertia::from_moments(*mass, *com, *moi, *poi) {
                    Ok(inertia) => {
                        let inertia = inertia.placed(&place.placement);
                        frames.payloads.push(Payload { member, body: place.body, inertia });
                    }
                    Err(reason) => problems.push(refused(member, &reason)),
                }
            }
            Element::FrameProbe { .. } => frames.probes.push(Probe { member, place, acts: false }),
            Element::FrameForce { .. } => frames.probes.push(Probe { member, place, acts: true }),
            _ => {}
        }
    }
    let mut seen = std::collections::BTreeSet::new();
    problems.retain(|problem| problem.members.first().is_none_or(|(member, _)| seen.insert(*member)));
    problems
}

fn placement_of(element: &Element, forward: bool) -> Placement {
    let Element::Transform { rotation, translation, .. } = element else {
        return Placement::identity();
    };
    let placement = Placement {
        rotation: Matrix3::from_fn(|row, column| rotation[row][column]),
        translation: (*translation).into(),
    };
    if forward { placement } else { placement.inverse() }
}

fn floats(m: &Members, member: usize) -> NetworkProblem {
    NetworkProblem::new(
        "missing_reference",
        format!("`{}` is not connected to the world", m.path(member)),
        "connect it, through joints or transforms, to a World",
    )
    .with(member, "floats")
}

fn refused(member: usize, reason: &dyn std::fmt::Display) -> NetworkProblem {
    NetworkProblem::new(
        "parameter",
        reason.to_string(),
        "correct the mass properties, the axis or the placement",
    )
    .with(member, "has them")
}

fn no_world(m: &Members) -> NetworkProblem {
    let problem = NetworkProblem::new(
        "missing_reference",
        "this mechanism has no World",
        "add a World and connect its frame to the first body or joint",
    );
    let first = m.elements().find(|(_, element)| {
        matches!(element, Element::Body { .. } | Element::Transform { .. } | Element::Joint { .. })
    });
    match first {
        Some((member, _)) => problem.with(member, "belongs to it"),
        None => problem,
    }
}
