//! Physical networks become ordinary blocks.

use std::sync::Arc;

use blocksim_block::problem::Problem;
use blocksim_block::{Given, ParamUnits};
use blocksim_network::{Member, Network, NetworkProblem, Terminal, assemble};

use crate::flatten::{Declared, Flat, FlatBlock, Source};
use crate::problems::Problems;

/// Replaces the components of every connected network by one block.
///
/// This happens after flattening, because a network reaches across subsystems.
pub(crate) fn elaborate(flat: Flat, problems: &mut Problems) -> Flat {
    let groups = groups(&flat);
    let member_of: Vec<Option<(usize, usize)>> = (0..flat.blocks.len())
        .map(|block| {
            groups
                .iter()
                .enumerate()
                .find_map(|(g, group)| group.iter().position(|b| *b == block).map(|m| (g, m)))
        })
        .collect();
    let mut networks = Vec::new();
    for group in &groups {
        networks.push(build(&flat, group, problems));
    }

    // Blocks that stay, then the networks.
    let kept: Vec<usize> = (0..flat.blocks.len()).filter(|block| member_of[*block].is_none()).collect();
    let outputs_before = |group: usize, member: usize| -> usize {
        groups[group][..member].iter().map(|block| flat.blocks[*block].interface.outputs.len()).sum()
    };
    let moved = |source: &Source| -> Source {
        let (block, output) = match member_of[source.block] {
            Some((group, member)) => (kept.len() + group, outputs_before(group, member) + source.output),
            None => (kept.iter().position(|block| *block == source.block).unwrap_or(0), source.output),
        };
        Source { block, output, ..source.clone() }
    };
    let mut blocks = Vec::new();
    for block in &kept {
        let mut block = flat.blocks[*block].clone();
        block.inputs = block.inputs.iter().map(|source| source.as_ref().map(moved)).collect();
        blocks.push(block);
    }
    for (group, network) in groups.iter().zip(networks) {
        let Some(network) = network else { return Flat::default() };
        let members: Vec<&FlatBlock> = group.iter().map(|block| &flat.blocks[*block]).collect();
        let Ok(interface) = blocksim_block::Block::interface(&network, &Given::nothing()) else {
            return Flat::default();
        };
        blocks.push(FlatBlock {
            path: format!("network({})", members[0].path),
            kind: "Network".to_owned(),
            place: members[0].place.clone(),
            output_names: interface.outputs.iter().map(|output| output.name.clone()).collect(),
            block: Arc::new(network),
            units: ParamUnits::default(),
            interface,
            inputs: members.iter().flat_map(|m| &m.inputs).map(|source| source.as_ref().map(moved)).collect(),
        });
    }
    let recorded = flat.recorded.iter().map(|(name, source)| (name.clone(), moved(source))).collect();
    let declared = flat.declared.iter().map(|d| Declared { source: moved(&d.source), ..d.clone() }).collect();
    sorted(Flat { blocks, nodes: Vec::new(), recorded, declared })
}

/// Blocks by path again.
fn sorted(flat: Flat) -> Flat {
    let mut order: Vec<usize> = (0..flat.blocks.len()).collect();
    order.sort_by(|a, b| flat.blocks[*a].path.cmp(&flat.blocks[*b].path));
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, old)| place[*old] = new);
    let moved = |source: &Source| Source { block: place[source.block], ..source.clone() };
    let blocks = order
        .iter()
        .map(|old| {
            let mut block = flat.blocks[*old].clone();
            block.inputs = block.inputs.iter().map(|source| source.as_ref().map(moved)).collect();
            block
        })
        .collect();
    let recorded = flat.recorded.iter().map(|(name, source)| (name.clone(), moved(source))).collect();
    let declared = flat.declared.iter().map(|d| Declared { source: moved(&d.source), ..d.clone() }).collect();
    Flat { blocks, nodes: Vec::new(), recorded, declared }
}

/// Components that are joined, directly or through others.
fn groups(flat: &Flat) -> Vec<Vec<usize>> {
    let mut group_of: Vec<Option<usize>> = flat
        .blocks
        .iter()
        .enumerate()
        .map(|(i, block)| block.block.component().is_some().then_some(i))
        .collect();
    loop {
        let mut changed = false;
        for node in &flat.nodes {
            let Some(least) = node.iter().filter_map(|(block, _)| group_of[*block]).min() else { continue };
            for (block, _) in node {
                if group_of[*block].is_some_and(|group| group > least) {
                    group_of[*block] = Some(least);
                    changed = true;
                }
            }
        }
        if !changed {
            break;
        }
    }
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (first, _) in group_of.iter().enumerate().filter(|(i, group)| **group == Some(*i)) {
        groups.push((0..flat.blocks.len()).filter(|block| group_of[*block] == Some(first)).collect());
    }
    groups
}

fn build(flat: &Flat, group: &[usize], problems: &mut Problems) -> Option<Network> {
    let members: Vec<Member> = group
        .iter()
        .filter_map(|index| {
            let block = &flat.blocks[*index];
            let mut part = block.block.component()?.part(&Given::new(Vec::new(), block.units.clone()));
            // The sizes of a network are fixed before shapes are inferred.
            let input_lengths =
                part.inputs.iter_mut().map(|i| i.shape.get_or_insert_default().len()).collect();
            Some(Member { path: block.path.clone(), block: block.block.clone(), part, input_lengths })
        })
        .collect();
    let joined: Vec<Vec<Terminal>> = flat
        .nodes
        .iter()
        .map(|node| {
            node.iter()
                .filter_map(|(block, port)| {
                    group.iter().position(|b| b == block).map(|member| Terminal { member, port: *port })
                })
                .collect()
        })
        .filter(|set: &Vec<Terminal>| !set.is_empty())
        .collect();
    match assemble(members, &joined) {
        Ok(network) => Some(network),
        Err(found) => {
            problems.extend(found.into_iter().map(|problem| placed(flat, group, problem)));
            None
        }
    }
}

/// Puts places to the members that a problem names.
fn placed(flat: &Flat, group: &[usize], found: NetworkProblem) -> Problem {
    let mut problem = Problem::error(found.code, found.message).help(found.help);
    let mut named: Vec<(usize, String)> = Vec::new();
    for (member, role) in found.members {
        if named.iter().all(|(known, _)| *known != member) && named.len() < 4 {
            named.push((member, role));
        }
    }
    for (member, role) in named {
        let block = &flat.blocks[group[member]];
        if let Some(place) = &block.place {
            problem = problem.at(place, format!("`{}` {role}", block.path));
        }
    }
    problem
}
