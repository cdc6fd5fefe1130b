//! One pass over the elements: which speeds each of them relates, and where speeds are seen.

use blocksim_block::physical::{Element, MeshLoss};

use super::faults::Reason;
use super::start::Start;
use crate::assembly::eliminate::Relations;
use crate::assembly::members::Members;
use crate::mechanics::frames::Frames;

/// What the elements say of the speeds of the nodes and, behind them, of the joints.
pub(super) struct Related {
    pub relations: Relations,
    /// What each relation stands for.
    pub reasons: Vec<Reason>,
    /// Moment of inertia of each node.
    pub inertia: Vec<f64>,
    pub pins: Vec<Seen>,
    /// Index of the pin of each branch; those of dry friction come last.
    pub branches: Vec<usize>,
    /// Nodes `r` and `c` of each branch.
    pub branch_nodes: Vec<(usize, usize)>,
    /// Number of branches that are not dry friction.
    pub smooth: usize,
    pub gears: Vec<Geared>,
    /// Relation of the drive side of each joint, if it has one.
    pub drive_rows: Vec<Option<usize>>,
    pub starts: Vec<Start>,
}

/// A place where a speed is seen.
pub(super) struct Seen {
    pub r: usize,
    /// Nothing stands for the implied ground.
    pub c: Option<usize>,
    /// The relation whose multiplier is the torque there.
    pub row: Option<usize>,
}

/// A gear: its base, its relation and its losses.
pub(super) struct Geared {
    pub base: usize,
    pub row: usize,
    pub ratio: f64,
    pub loss: Option<MeshLoss>,
}

/// Relations of all members, among the speeds of `sources` that are prescribed.
pub(super) fn relate(m: &Members, frames: &Frames, sources: usize) -> Related {
    let (nodes, joints) = (m.rotational_nodes, frames.speeds.len());
    let mut related = Related {
        relations: Relations::new(nodes + joints, sources),
        reasons: Vec::new(),
        inertia: vec![0.0; nodes],
        pins: Vec::new(),
        branches: Vec::new(),
        branch_nodes: Vec::new(),
        smooth: 0,
        gears: Vec::new(),
        drive_rows: vec![None; joints],
        starts: Vec::new(),
    };
    let mut source = 0;
    let mut frictions = Vec::new();
    let mut freedoms_before = vec![0; m.list.len()];
    for (member, element) in m.elements() {
        let node = |port: usize| m.node(member, port);
        match *element {
            Element::Inertia { port, inertia, speed } => {
                related.inertia[node(port)] += inertia;
                if let Some(speed) = speed {
                    related.starts.push(Start { node: node(port), speed, member });
                }
            }
            Element::Branch { r, c } => {
                related.branches.push(related.pins.len());
                related.branch_nodes.push((node(r), node(c)));
                related.pins.push(Seen { r: node(r), c: Some(node(c)), row: None });
            }
            Element::Friction { r, c } => {
                frictions.push((related.pins.len(), (node(r), node(c))));
                related.pins.push(Seen { r: node(r), c: Some(node(c)), row: None });
            }
            Element::SpeedProbe { r, c } => {
                related.pins.push(Seen { r: node(r), c: Some(node(c)), row: None });
            }
            Element::AbsoluteSpeedProbe { port } => {
                related.pins.push(Seen { r: node(port), c: None, row: None });
            }
            Element::Rigid { r, c } => {
                let row = related.relations.add(&[(node(r), 1.0), (node(c), -1.0)], &[]);
                related.reasons.push(Reason::Rigid { member });
                related.pins.push(Seen { r: node(r), c: Some(node(c)), row: Some(row) });
            }
            Element::SpeedSource { r, c } => {
                let row = related.relations.add(&[(node(r), 1.0), (node(c), -1.0)], &[(source, 1.0)]);
                related.reasons.push(Reason::Source { member });
                related.pins.push(Seen { r: node(r), c: Some(node(c)), row: Some(row) });
                source += 1;
            }
            Element::Gear { base, follower, ratio, loss } => {
                let row = related.relations.add(&[(node(follower), 1.0), (node(base), -ratio)], &[]);
                related.reasons.push(Reason::Gear { member });
                related.gears.push(Geared { base: node(base), row, ratio, loss });
            }
            Element::Coupling { ref terms } => {
                let row: Vec<(usize, f64)> =
                    terms.iter().map(|(port, factor)| (node(*port), *factor)).collect();
                related.relations.add(&row, &[]);
                related.reasons.push(Reason::Coupling { member });
            }
            Element::MechanicalReference { port } => {
                related.relations.add(&[(node(port), 1.0)], &[]);
                related.reasons.push(Reason::Reference { member });
            }
            Element::Joint { ref freedoms, .. } => {
                let first = freedoms_before[member];
                freedoms_before[member] += freedoms.len();
                for (k, freedom) in freedoms.iter().enumerate() {
                    let Some(axis) = freedom.axis() else { continue };
                    let (Some((r, c)), Some(joint)) = (axis.drive, frames.speed_of(member, first + k)) else {
                        continue;
                    };
                    if m.alone(member, r) && m.alone(member, c) {
                        // A drive side that nothing is connected to stands still, so that it is no free part.
                        for port in [r, c] {
                            related.relations.add(&[(node(port), 1.0)], &[]);
                            related.reasons.push(Reason::Joint { member });
                        }
                        continue;
                    }
                    let row =
                        related.relations.add(&[(node(r), 1.0), (node(c), -1.0), (nodes + joint, -1.0)], &[]);
                    related.reasons.push(Reason::Joint { member });
                    related.drive_rows[joint] = Some(row);
                }
            }
            _ => {}
        }
    }

    related.smooth = related.branches.len();
    for (pin, nodes) in frictions {
        related.branches.push(pin);
        related.branch_nodes.push(nodes);
    }
    related
}
