//! From members and joined ports to a network.

use std::sync::Arc;

use blocksim_block::Block;
use blocksim_block::physical::{Element, Part};

use crate::members::Members;
use crate::network::Network;
use crate::problem::NetworkProblem;
use crate::{electrics, frames, rotation};

/// A block of a network.
#[derive(Debug, Clone)]
pub struct Member {
    /// Path of the block.
    pub path: String,
    /// The block; it has a component.
    pub block: Arc<dyn Block>,
    /// What the component says of itself.
    pub part: Part,
    /// Number of elements of each input port.
    pub input_lengths: Vec<usize>,
}

/// A conserving port of a member.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Terminal {
    /// Index of the member.
    pub member: usize,
    /// Index of the port in its part.
    pub port: usize,
}

/// Assembles one connected network.
///
/// `joined` lists the sets of ports that are connected to each other; all ports of a set have one domain. Ports
/// in no set are not connected. The order of `members` decides the order of states; the caller sorts them by
/// path.
///
/// # Errors
/// Everything that is wrong with the network: no reference, parts without inertia, sources that fight, couplings
/// that are rigid twice over, loops of joints, a mass matrix that is not positive definite.
pub fn assemble(members: Vec<Member>, joined: &[Vec<Terminal>]) -> Result<Network, Vec<NetworkProblem>> {
    let view = Members::new(&members, joined);
    let mut problems = view.unconnected();
    let supplies = view.supplies().map_err(|more| problems.extend(more)).unwrap_or_default();
    let electrics = electrics::build(&view).map_err(|more| problems.extend(more)).ok();
    let frames = frames::build(&view).map_err(|more| problems.extend(more)).ok();
    let rotation = frames.as_ref().and_then(|frames| {
        rotation::build(&view, &frames.joint_members).map_err(|more| problems.extend(more)).ok()
    });
    // An unconnected pin says more than what follows from it.
    let unconnected: Vec<usize> = problems
        .iter()
        .filter(|problem| problem.code == "unconnected_port")
        .flat_map(|problem| problem.members.iter().map(|(member, _)| *member))
        .collect();
    problems.retain(|p| {
        p.code == "unconnected_port"
            || !matches!(p.code, "floating_node" | "missing_reference")
            || !p.members.iter().any(|(member, _)| unconnected.contains(member))
    });
    if !problems.is_empty() {
        return Err(problems);
    }
    let (Some(electrics), Some(frames), Some(rotation)) = (electrics, frames, rotation) else {
        return Err(problems);
    };
    let supply_of =
        members
            .iter()
            .enumerate()
            .map(|(i, member)| {
                member.part.elements.iter().find_map(|element| match element {
                    Element::Supply { ac } | Element::Machine { ac } => {
                        let node = view.node(i, *ac);
                        supplies.iter().position(|supply| {
                            view.list[*supply].part.elements.iter().any(
                                |e| matches!(e, Element::Supply { ac } if view.node(*supply, *ac) == node),
                            )
                        })
                    }
                    _ => None,
                })
            })
            .collect();
    Network::new(members, rotation, electrics, frames, supplies, supply_of)
}
