//! How often each output group is evaluated.

use blocksim_block::law::Reads;
use blocksim_block::schedule::When;
use blocksim_signal::SampleTime;
use foldhash::HashMap;

use super::loops::Ring;
use super::order::{Group, Order, Sorted};

/// When each group must be evaluated, by its number.
pub(super) fn when(order: &Order, sorted: &Sorted, rates: &HashMap<usize, usize>) -> Vec<When> {
    let mut when: Vec<Option<When>> = vec![None; order.graph.node_count()];
    let ends: HashMap<Group, &Ring> =
        sorted.rings.iter().filter_map(|ring| Some((*ring.groups.last()?, ring))).collect();
    for (block, group) in &sorted.groups {
        let interface = &order.typed.interfaces[*block];
        // A block with continuous states is evaluated between its hits, too, and so is one that changes by itself there.
        let stands = interface.states.is_empty() && !interface.subdivides && !interface.uses_time;
        let found = if let (Some(rate), true) = (rates.get(block), stands) {
            When::Sampled(*rate as u32)
        } else if interface.sample_time == Some(SampleTime::Constant) {
            When::Constant
        } else {
            let mut latest = by_itself(order, (*block, *group));
            for from in order.read((*block, *group)) {
                latest = match (latest, when[order.number(*from)]) {
                    (When::Continuous, _) | (_, Some(When::Continuous)) => When::Continuous,
                    // Only within an algebraic loop nothing is known yet.
                    (latest, Some(When::Constant) | None) => latest,
                    _ => When::Major,
                };
            }
            latest
        };
        when[order.number((*block, *group))] = Some(found);
        if let Some(ring) = ends.get(&(*block, *group)) {
            unify(order, &ring.groups, &mut when);
        }
    }
    when.into_iter().map(|when| when.unwrap_or(When::Constant)).collect()
}

/// When a group changes if its inputs do not.
fn by_itself(order: &Order, (block, group): Group) -> When {
    let interface = &order.typed.interfaces[block];
    let (flows, changes) = match &order.laws.blocks[block].law {
        Some(law) => {
            let reads = || law.of_group(group);
            // Modes are chosen at each major step.
            (
                reads().any(Reads::flow),
                interface.settles_in(group) || reads().any(|reads| !reads.discrete.is_empty()),
            )
        }
        None => (
            !interface.states.is_empty() || interface.uses_time,
            interface.settles || interface.time_events || interface.accepts || interface.jumps,
        ),
    };
    match (flows, changes) {
        (true, _) => When::Continuous,
        (false, true) => When::Major,
        (false, false) => When::Constant,
    }
}

/// A loop is evaluated as a whole: whenever one of its members is. Those of a sample time stay as they are.
fn unify(order: &Order, groups: &[Group], when: &mut [Option<When>]) {
    let of = |group: &Group| when[order.number(*group)].unwrap_or(When::Constant);
    let found: Vec<When> = groups.iter().map(of).collect();
    if found.iter().any(|when| matches!(when, When::Sampled(_))) {
        return;
    }
    let latest = [When::Continuous, When::Major].into_iter().find(|when| found.contains(when));
    let latest = latest.unwrap_or(When::Constant);
    groups.iter().for_each(|group| when[order.number(*group)] = Some(latest));
}

/// Blocks whose guards can cross zero between major steps: they have states, look at time, or at something that changes.
pub(super) fn watched(order: &Order, when: &[When], rates: &HashMap<usize, usize>) -> Vec<bool> {
    let interfaces = order.typed.interfaces.iter().enumerate();
    interfaces
        .map(|(block, interface)| {
            let changes = |group: &Group| when[order.number(*group)] == When::Continuous;
            if interface.guards.is_empty() {
                return false;
            }
            let (states, time, sources) = match &order.laws.blocks[block].law {
                Some(law) => {
                    let Reads { states, time, .. } = law.of_guards;
                    (states, time, order.writers_of(block, &law.of_guards.inputs))
                }
                None => (!interface.states.is_empty(), interface.uses_time, sources(order, block).collect()),
            };
            states || !rates.contains_key(&block) && (time || sources.iter().any(changes))
        })
        .collect()
}

/// Groups that the inputs of a block come from.
fn sources<'a>(order: &'a Order, block: usize) -> impl Iterator<Item = Group> + 'a {
    let connected = order.flat.blocks[block].inputs.iter().flatten();
    connected.flat_map(|source| order.writers(source.block, source.output))
}

/// Which groups, by their numbers, derivatives, guards or memories depend on at the same instant. What they read that is held between major
/// steps is among them, what that was made of is not.
pub(super) fn acting(order: &Order, when: &[When], watched: &[bool]) -> Vec<bool> {
    let mut acting = vec![false; order.graph.node_count()];
    let mut stack: Vec<Group> = Vec::new();
    for (block, interface) in order.typed.interfaces.iter().enumerate() {
        match &order.laws.blocks[block].law {
            Some(law) if !interface.accepts => {
                stack.extend(order.writers_of(block, &law.of_rates.inputs));
                if watched[block] {
                    stack.extend(order.writers_of(block, &law.of_guards.inputs));
                }
            }
            _ if !interface.states.is_empty() || watched[block] || interface.accepts => {
                stack.extend(sources(order, block));
            }
            _ => (),
        }
    }
    while let Some(next) = stack.pop() {
        // What is held between major steps hides what it was made of.
        let number = order.number(next);
        if !std::mem::replace(&mut acting[number], true) && when[number] == When::Continuous {
            stack.extend(order.read(next));
            let constraint = order.typed.interfaces[next.0].constraint.as_ref();
            let rest = constraint.filter(|constraint| constraint.group == next.1);
            stack.extend(rest.map(|constraint| (next.0, constraint.rest)));
        }
    }
    acting
}
