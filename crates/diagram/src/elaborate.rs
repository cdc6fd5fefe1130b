//! Physical networks become ordinary blocks.

use std::sync::Arc;

use blocksim_block::Given;
use blocksim_block::problem::{Problem, Severity};
use blocksim_block::schedule::BlockPart;
use blocksim_network::{Member, Network, NetworkProblem, Terminal, assemble};
use blocksim_scene::Scene;
use foldhash::HashSet;
use indexmap::IndexMap;
use petgraph::unionfind::UnionFind;

use crate::flatten::{Declared, Flat, FlatBlock, Source};
use crate::problems::Problems;
use crate::settings::start::split_element;

/// Replaces the components of every connected network by one block; returns what is seen of them, too. `watched` are names of
/// outputs that somebody looks at, though nothing may be connected to them.
///
/// This happens after flattening, because a network reaches across subsystems.
pub(crate) fn elaborate<'a>(
    flat: Flat,
    watched: impl Iterator<Item = &'a String>,
    problems: &mut Problems,
) -> (Flat, Scene) {
    let groups = groups(&flat);
    if groups.is_empty() {
        return (sorted(Flat { nodes: Vec::new(), ..flat }), Scene::new());
    }
    let mut member_of: Vec<Option<(usize, usize)>> = vec![None; flat.blocks.len()];
    for (group, members) in groups.iter().enumerate() {
        for (member, block) in members.iter().enumerate() {
            member_of[*block] = Some((group, member));
        }
    }
    let joined = joined(&flat, &member_of, groups.len());
    let read = read(&flat, watched);
    let mut networks = Vec::new();
    for (group, joined) in groups.iter().zip(&joined) {
        networks.push(build(&flat, group, joined, &read, problems));
    }

    // Blocks that stay, then the networks.
    let kept: Vec<usize> = (0..flat.blocks.len()).filter(|block| member_of[*block].is_none()).collect();
    let mut place = vec![0; flat.blocks.len()];
    kept.iter().enumerate().for_each(|(new, old)| place[*old] = new);
    // First output of each component within its network.
    let mut outputs_before = vec![0; flat.blocks.len()];
    for group in &groups {
        group.iter().fold(0, |outputs, block| {
            outputs_before[*block] = outputs;
            outputs + flat.blocks[*block].interface.outputs.len()
        });
    }
    let moved = |source: &Source| -> Source {
        let (block, output) = match member_of[source.block] {
            Some((group, _)) => (kept.len() + group, outputs_before[source.block] + source.output),
            None => (place[source.block], source.output),
        };
        Source { block, output, ..source.clone() }
    };
    let mut blocks = Vec::with_capacity(kept.len() + groups.len());
    for block in &kept {
        let mut block = flat.blocks[*block].clone();
        block.inputs = block.inputs.iter().map(|source| source.as_ref().map(moved)).collect();
        blocks.push(block);
    }
    let mut scene = Scene::new();
    let mut recorded: Vec<(String, Source)> =
        flat.recorded.iter().map(|(name, source)| (name.clone(), moved(source))).collect();
    for (group, network) in groups.iter().zip(networks) {
        let Some(network) = network else { return Default::default() };
        let members: Vec<&FlatBlock> = group.iter().map(|block| &flat.blocks[*block]).collect();
        let Ok(interface) = blocksim_block::Block::interface(&network, &Given::nothing()) else {
            return Default::default();
        };
        scene.append(network.scene().clone());
        // Where there is something to be seen, the recording tells where it is.
        if let Some(place) = &members[0].place {
            recorded.extend(network.pose_signals().map(|(name, output)| {
                let source =
                    Source { block: blocks.len(), output, target: place.clone(), place: place.clone() };
                (name.to_owned(), source)
            }));
        }
        blocks.push(FlatBlock {
            path: format!("network({})", members[0].path),
            kind: "Network".to_owned(),
            title: Vec::new(),
            place: members[0].place.clone(),
            parts: members
                .iter()
                .map(|m| BlockPart { path: m.path.clone(), place: m.place.clone() })
                .collect(),
            output_names: interface.outputs.iter().map(|output| output.name.clone()).collect(),
            block: Arc::new(network),
            units: Arc::default(),
            plain: false,
            interface: Arc::new(interface),
            inputs: members.iter().flat_map(|m| &m.inputs).map(|source| source.as_ref().map(moved)).collect(),
        });
    }
    let declared = flat.declared.iter().map(|d| Declared { source: moved(&d.source), ..d.clone() }).collect();
    (sorted(Flat { blocks, nodes: Vec::new(), recorded, declared }), scene)
}

/// Blocks by path again.
fn sorted(flat: Flat) -> Flat {
    if flat.blocks.is_sorted_by(|a, b| a.path <= b.path) {
        return flat;
    }
    let mut order: Vec<usize> = (0..flat.blocks.len()).collect();
    order.sort_by(|a, b| flat.blocks[*a].path.cmp(&flat.blocks[*b].path));
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, old)| place[*old] = new);
    let Flat { blocks, nodes, mut recorded, mut declared } = flat;
    let mut blocks: Vec<Option<FlatBlock>> = blocks.into_iter().map(Some).collect();
    let mut blocks: Vec<FlatBlock> = order.into_iter().filter_map(|old| blocks[old].take()).collect();
    let inputs = blocks.iter_mut().flat_map(|block| &mut block.inputs).flatten();
    let sources = inputs.chain(recorded.iter_mut().map(|(_, source)| source));
    let sources = sources.chain(declared.iter_mut().map(|declared| &mut declared.source));
    sources.for_each(|source| source.block = place[source.block]);
    Flat { blocks, nodes, recorded, declared }
}

/// Components that are joined, directly or through others: each group by its blocks, in their order.
fn groups(flat: &Flat) -> Vec<Vec<usize>> {
    let mut joined = UnionFind::new(flat.blocks.len());
    for node in &flat.nodes {
        for pair in node.windows(2) {
            joined.union(pair[0].0, pair[1].0);
        }
    }
    let mut groups: IndexMap<usize, Vec<usize>> = IndexMap::new();
    for (index, block) in flat.blocks.iter().enumerate() {
        if block.block.component().is_some() {
            groups.entry(joined.find(index)).or_default().push(index);
        }
    }
    groups.into_values().collect()
}

/// The sets of joined ports of each network.
fn joined(flat: &Flat, member_of: &[Option<(usize, usize)>], groups: usize) -> Vec<Vec<Vec<Terminal>>> {
    let mut joined = vec![Vec::new(); groups];
    for node in &flat.nodes {
        let mut sets: IndexMap<usize, Vec<Terminal>> = IndexMap::new();
        for (block, port) in node {
            if let Some((group, member)) = member_of[*block] {
                sets.entry(group).or_default().push(Terminal { member, port: *port });
            }
        }
        sets.into_iter().for_each(|(group, set)| joined[group].push(set));
    }
    joined
}

/// The outputs, by block and number, that something is connected to, that are recorded or watched.
fn read<'a>(flat: &Flat, watched: impl Iterator<Item = &'a String>) -> HashSet<(usize, usize)> {
    let watched: HashSet<&str> = watched.map(|name| split_element(name.trim()).0).collect();
    let wired = flat.blocks.iter().flat_map(|block| block.inputs.iter().flatten());
    let recorded = flat.recorded.iter().map(|(_, source)| source);
    let outputs = flat.blocks.iter().enumerate().flat_map(|(block, of)| {
        let names = of.output_names.iter().enumerate();
        let named = names.filter(|(_, name)| watched.contains(name.as_str()));
        named.map(move |(output, _)| (block, output))
    });
    wired.chain(recorded).map(|source| (source.block, source.output)).chain(outputs).collect()
}

fn build(
    flat: &Flat,
    group: &[usize],
    joined: &[Vec<Terminal>],
    read: &HashSet<(usize, usize)>,
    problems: &mut Problems,
) -> Option<Network> {
    let members: Vec<Member> = group
        .iter()
        .filter_map(|index| {
            let block = &flat.blocks[*index];
            let mut part = block.block.component()?.part(&Given::sharing(Vec::new(), block.units.clone()));
            let wired = |input: usize| block.inputs.get(input).is_some_and(Option::is_some);
            part.rates |= part.rate_input.is_some_and(wired);
            // The sizes of a network are fixed before shapes are inferred.
            let input_lengths =
                part.inputs.iter_mut().map(|i| i.shape.get_or_insert_default().len()).collect();
            let read = (0..part.outputs.len()).map(|output| read.contains(&(*index, output))).collect();
            Some(Member { path: block.path.clone(), block: block.block.clone(), part, input_lengths, read })
        })
        .collect();
    match assemble(members, joined) {
        Ok(network) => {
            let moved = network.moved().iter().cloned();
            problems.extend(
                moved.map(|found| Problem { severity: Severity::Warning, ..placed(flat, group, found) }),
            );
            Some(network)
        }
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
