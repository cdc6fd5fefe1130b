//! From members and joined ports to a network: `members` numbers the nodes, `eliminate` solves linear relations exactly,
//! `closing` finds start values that close loops, `moved` notes those that were given and are not kept, `layout` gives every value its
//! place, `words` names things for messages, `domains` those of domains with nodal analysis.

pub(crate) mod closing;
pub(crate) mod domains;
pub(crate) mod eliminate;
pub(crate) mod grids;
pub(crate) mod layout;
pub(crate) mod members;
pub(crate) mod moved;
pub(crate) mod words;

use crate::assembly::members::Members;
use crate::electrics;
use crate::mechanics::{rotation, tree};
use crate::member::{Member, Terminal};
use crate::network::Network;
use crate::problem::NetworkProblem;

/// Assembles one connected network.
///
/// `joined` lists the sets of ports that are connected to each other; all ports of a set have one domain. Ports
/// in no set are not connected. The order of `members` decides the order of states; the caller sorts them by
/// path.
///
/// # Errors
/// Everything that is wrong with the network: no reference, parts without inertia, sources that fight, couplings
/// that are rigid twice over, loops of joints that do not close, a mass matrix that is not positive definite.
pub fn assemble(members: Vec<Member>, joined: &[Vec<Terminal>]) -> Result<Network, Vec<NetworkProblem>> {
    let lone = lone_accounts(&members, joined);
    if !lone.is_empty() {
        return Err(lone);
    }
    let view = Members::new(&members, joined);
    let mut problems = view.unconnected();
    let fed_by = view.fed_by();
    let fed: Vec<bool> = fed_by.iter().map(Option::is_some).collect();
    let electrics = electrics::build(&view, &fed).map_err(|more| problems.extend(more)).ok();
    let frames = tree::build(&view).map_err(|more| problems.extend(more)).ok();
    let rotation = frames
        .as_ref()
        .and_then(|frames| rotation::build(&view, frames).map_err(|more| problems.extend(more)).ok());
    let rotation = frames.as_ref().zip(rotation).map(|(frames, mut rotation)| {
        closing::fit_speeds(frames, &mut rotation);
        rotation
    });
    // An unconnected pin says more than what follows from it.
    let unconnected: Vec<usize> = problems
        .iter()
        .filter(|problem| problem.code == "unconnected_port")
        .flat_map(|problem| problem.members.iter().map(|(member, _)| *member))
        .collect();
    problems.retain(|p| {
        p.code == "unconnected_port"
            || !matches!(p.code, "floating_node" | "missing_reference" | "missing_supply" | "no_current_path")
            || !p.members.iter().any(|(member, _)| unconnected.contains(member))
    });
    if !problems.is_empty() {
        return Err(problems);
    }
    let (Some(electrics), Some(frames), Some(rotation)) = (electrics, frames, rotation) else {
        return Err(problems);
    };
    let moved = moved::moved(&view, &frames, &rotation);
    let grids = grids::grids(&view);
    let mut network = Network::new(members, rotation, electrics, frames, &fed_by, &grids)?;
    network.moved = moved;
    Ok(network)
}

/// Accounts that are connected to nothing.
fn lone_accounts(members: &[Member], joined: &[Vec<Terminal>]) -> Vec<NetworkProblem> {
    let others = |set: &Vec<Terminal>| set.iter().any(|t| !members[t.member].is_account());
    let accounts = members.iter().enumerate().filter(|(_, member)| member.is_account());
    let lone = accounts
        .filter(|(index, _)| !joined.iter().any(|set| others(set) && set.iter().any(|t| t.member == *index)));
    lone.map(|(index, member)| {
        let port = &member.part.ports[0];
        NetworkProblem::new(
            "unconnected_port",
            format!("the {} port `{}.{}` is not connected", port.domain, member.path, port.name),
            "connect it with `<->` to any node of the network",
        )
        .with(index, "has this port")
    })
    .collect()
}
