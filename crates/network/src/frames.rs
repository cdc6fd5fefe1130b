//! Bodies and joints: from frames that are joined to a tree of links.

use std::collections::VecDeque;

use blocksim_block::physical::Element;
use blocksim_multibody::{Data, Inertia, Joint, Model, ModelBuilder, Placement};

use nalgebra::Matrix3;

use crate::members::Members;
use crate::problem::NetworkProblem;

/// The multibody side of a network.
#[derive(Debug, Clone, Default)]
pub(crate) struct Frames {
    /// The tree; `None` without frames.
    pub model: Option<Model>,
    /// The member of each joint in the order of the model.
    pub joint_members: Vec<usize>,
    /// Angle of each joint at the start.
    pub position: Vec<f64>,
}

impl Frames {
    pub(crate) fn data(&self) -> Option<Data> {
        self.model.as_ref().map(Model::data)
    }
}

/// An edge between two frame nodes.
#[derive(Clone, Copy)]
enum Edge<'a> {
    Rigid { placement: &'a Element, forward: bool },
    Joint { joint: &'a Element, forward: bool },
}

/// Where a frame node lies: on which body (`None` is the world), and how.
#[derive(Clone)]
struct Seat {
    body: Option<blocksim_multibody::BodyId>,
    placement: Placement,
}

/// Builds the tree from the world outwards.
pub(crate) fn build(m: &Members) -> Result<Frames, Vec<NetworkProblem>> {
    if m.frame_nodes == 0 {
        return Ok(Frames::default());
    }
    let mut edges: Vec<Vec<(usize, usize, Edge)>> = vec![Vec::new(); m.frame_nodes]; // to, member, edge
    let mut worlds = Vec::new();
    for (member, element) in m.elements() {
        match element {
            Element::World { frame, gravity } => worlds.push((member, m.node(member, *frame), *gravity)),
            Element::Transform { base, follower, .. } => {
                let (b, f) = (m.node(member, *base), m.node(member, *follower));
                edges[b].push((f, member, Edge::Rigid { placement: element, forward: true }));
                edges[f].push((b, member, Edge::Rigid { placement: element, forward: false }));
            }
            Element::Revolute { base, follower, .. } => {
                let (b, f) = (m.node(member, *base), m.node(member, *follower));
                edges[b].push((f, member, Edge::Joint { joint: element, forward: true }));
                edges[f].push((b, member, Edge::Joint { joint: element, forward: false }));
            }
            _ => {}
        }
    }
    let Some((_, root, gravity)) = worlds.first() else {
        return Err(vec![no_world(m)]);
    };
    if let Some((member, ..)) = worlds.iter().find(|(_, node, other)| node != root || other != gravity) {
        return Err(vec![
            NetworkProblem::new(
                "closed_loop",
                "this mechanism has two worlds",
                "keep one World and connect to it",
            )
            .with(*member, "is the second")
            .with(worlds[0].0, "is the first"),
        ]);
    }

    let mut builder = ModelBuilder::new();
    builder.gravity(*gravity);
    let mut seats: Vec<Option<Seat>> = vec![None; m.frame_nodes];
    let mut come_from: Vec<Option<usize>> = vec![None; m.frame_nodes];
    let mut frames = Frames::default();
    seats[*root] = Some(Seat { body: None, placement: Placement::identity() });
    let mut queue = VecDeque::from([*root]);
    while let Some(node) = queue.pop_front() {
        let Some(seat) = seats[node].clone() else { continue };
        for (to, member, edge) in &edges[node] {
            if come_from[node] == Some(*member) {
                continue;
            }
            if seats[*to].is_some() {
                return Err(vec![closed_loop(*member, come_from[*to])]);
            }
            let next = match edge {
                Edge::Rigid { placement, forward } => {
                    let step = placement_of(placement, *forward);
                    Seat { body: seat.body, placement: seat.placement * step }
                }
                Edge::Joint { joint, forward } => {
                    let Element::Revolute { axis, position, .. } = joint else { continue };
                    let sign = if *forward { 1.0 } else { -1.0 };
                    let axis = Joint::revolute(axis.map(|a| sign * a));
                    let body = builder
                        .add_body(seat.body, axis, seat.placement, Inertia::zero())
                        .map_err(|reason| vec![refused(*member, &reason)])?;
                    frames.joint_members.push(*member);
                    frames.position.push(*position);
                    Seat { body: Some(body), placement: Placement::identity() }
                }
            };
            seats[*to] = Some(next);
            come_from[*to] = Some(*member);
            queue.push_back(*to);
        }
    }

    let mut problems = Vec::new();
    for (member, element) in m.elements() {
        let (Element::Body { frame, .. }
        | Element::Transform { base: frame, .. }
        | Element::Revolute { base: frame, .. }) = element
        else {
            continue;
        };
        let Some(seat) = &seats[m.node(member, *frame)] else {
            problems.push(
                NetworkProblem::new(
                    "missing_reference",
                    format!("`{}` is not connected to the world", m.path(member)),
                    "connect it, through joints or transforms, to a World",
                )
                .with(member, "floats"),
            );
            continue;
        };
        if let (Element::Body { mass, com, moi, poi, .. }, Some(body)) = (element, seat.body) {
            let added = Inertia::from_moments(*mass, *com, *moi, *poi)
                .map_err(|reason| refused(member, &reason))
                .and_then(|inertia| {
                    builder
                        .add_inertia(body, seat.placement, inertia)
                        .map_err(|reason| refused(member, &reason))
                });
            problems.extend(added.err());
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    frames.model = Some(builder.build());
    Ok(frames)
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
        matches!(element, Element::Body { .. } | Element::Transform { .. } | Element::Revolute { .. })
    });
    match first {
        Some((member, _)) => problem.with(member, "belongs to it"),
        None => problem,
    }
}

fn closed_loop(member: usize, other: Option<usize>) -> NetworkProblem {
    let problem = NetworkProblem::new(
        "closed_loop",
        "joints and transforms close a loop: only trees of bodies can be simulated",
        "remove one connection of the loop",
    )
    .with(member, "closes the loop");
    match other {
        Some(other) if other != member => problem.with(other, "leads to the same frame"),
        _ => problem,
    }
}
