//! Wires and blocks that are put between others, which keep their order.

use crate::order::crossings::{block_of, channel_cost, order_cost, total};
use crate::order::lanes::{Item, Plan};
use crate::order::stack::{stack, stack_row};
use crate::structure::sides::Sides;

/// By how much another place of a block must be better than that in the skeleton.
pub(crate) const WORTH: f64 = 1.4;

/// Brings each loose unit to the best place in its row, the others kept; among equals as far below as it may be. A block
/// counts from when it has been placed, so that one more at the end of the text matters to none before it.
pub(crate) fn insert(plan: &mut Plan, sides: &Sides) {
    above_or_below(plan, sides);
    let count = plan.rows.len();
    let loose = |plan: &Plan, at: usize| -> Vec<Vec<usize>> {
        plan.rows[at].iter().filter(|unit| plan.loose[unit[0]]).cloned().collect()
    };
    for item in (0..plan.items.len()).filter(|item| plan.loose[*item]) {
        plan.absent[item] = matches!(plan.items[item], Item::Node(_));
    }
    let mut y = stack(plan);
    // Each time round, more of what they are connected to is in its place.
    for at in (0..3).flat_map(|_| 0..count) {
        for unit in loose(plan, at) {
            unit.iter().for_each(|item| plan.absent[*item] = false);
            relocate(plan, sides, &mut y, at, unit, 0.0);
        }
    }
    run_together(plan, sides);
}

/// Lets each loose wire over several layers run above all or below all, whichever is better.
fn above_or_below(plan: &mut Plan, sides: &Sides) {
    for net in 0..plan.lanes.len() {
        let lanes: Vec<(usize, usize)> =
            plan.lanes[net].iter().copied().filter(|(_, lane)| plan.loose[*lane]).collect();
        if lanes.len() < 2 {
            continue;
        }
        let below = (total(plan, sides, &stack(plan)), plan.rows.clone());
        for (at, lane) in lanes {
            if let Some(place) = plan.rows[at].iter().position(|unit| unit[0] == lane) {
                let unit = plan.rows[at].remove(place);
                plan.rows[at].insert(0, unit);
            }
        }
        if total(plan, sides, &stack(plan)) > below.0 - 1e-9 {
            plan.rows = below.1;
        }
    }
}

/// Brings each wire that runs past, and each block that only stands in a wire, to the best place in its row.
pub(crate) fn fit(plan: &mut Plan, sides: &Sides) {
    run_together(plan, sides);
    let mut y = stack(plan);
    for at in (0..plan.rows.len()).chain((0..plan.rows.len()).rev()) {
        let free: Vec<Vec<usize>> =
            plan.rows[at].iter().filter(|unit| !unit.iter().any(|item| plan.kept[*item])).cloned().collect();
        for unit in free {
            let worth = if block_of(plan, &unit).is_some() { WORTH } else { 0.0 };
            relocate(plan, sides, &mut y, at, unit, worth);
        }
    }
    run_together(plan, sides);
}

/// Brings the lanes of a net above or below those of another one, in all layers at once: a wire that changes sides on its
/// way crosses twice, and no lane alone can mend that.
pub(crate) fn run_together(plan: &mut Plan, sides: &Sides) {
    // A lane that a block hangs from stays with it.
    let mut alone = vec![false; plan.items.len()];
    plan.rows.iter().flatten().filter(|unit| unit.len() == 1).for_each(|unit| alone[unit[0]] = true);
    let lanes: Vec<Vec<(usize, usize)>> = plan
        .lanes
        .iter()
        .map(|lanes| lanes.iter().copied().filter(|(_, lane)| alone[*lane]).collect())
        .collect();
    let mut y = stack(plan);
    for net in 0..lanes.len() {
        let mine: Vec<(usize, usize)> =
            lanes[net].iter().copied().filter(|(_, lane)| plan.loose[*lane]).collect();
        if mine.len() < 2 {
            continue;
        }
        for other in (0..lanes.len()).filter(|other| *other != net) {
            let beside =
                |at: usize| lanes[other].iter().find(|(layer, _)| *layer == at).map(|(_, lane)| *lane);
            let pairs: Vec<(usize, usize, usize)> =
                mine.iter().filter_map(|(at, lane)| Some((*at, *lane, beside(*at)?))).collect();
            if pairs.len() < 2 {
                continue;
            }
            for below in [0, 1] {
                follow(plan, sides, &mut y, &pairs, below);
            }
        }
    }
}

/// Brings each first lane of (layer, lane, lane) beside the second, if that is better as a whole.
fn follow(plan: &mut Plan, sides: &Sides, y: &mut [f64], pairs: &[(usize, usize, usize)], below: usize) {
    let mut channels: Vec<usize> = pairs.iter().flat_map(|(at, ..)| [*at, at + 1]).collect();
    channels.dedup();
    let price = |plan: &Plan, y: &[f64]| {
        let wires: f64 = channels.iter().map(|channel| channel_cost(plan, sides, y, *channel)).sum();
        wires + pairs.iter().map(|(at, ..)| order_cost(plan, *at)).sum::<f64>()
    };
    let before = price(plan, y);
    let mut kept = Vec::with_capacity(pairs.len());
    for &(at, lane, beside) in pairs {
        let mut row = plan.rows[at].clone();
        row.retain(|unit| *unit != [lane]);
        let place = row.iter().position(|unit| *unit == [beside]).unwrap_or(0);
        row.insert(place + below, vec![lane]);
        stack_row(plan, &row, y);
        kept.push(std::mem::replace(&mut plan.rows[at], row));
    }
    if price(plan, y) > before - 1e-9 {
        for (&(at, ..), row) in pairs.iter().zip(kept) {
            stack_row(plan, &row, y);
            plan.rows[at] = row;
        }
    }
}

/// Brings one unit of a row to its best place, if that is better than its place by so much.
fn relocate(plan: &mut Plan, sides: &Sides, y: &mut [f64], at: usize, unit: Vec<usize>, worth: f64) {
    let now = plan.rows[at].iter().position(|other| other[0] == unit[0]);
    let rest: Vec<Vec<usize>> = plan.rows[at].iter().filter(|other| other[0] != unit[0]).cloned().collect();
    let row_with = |place: usize| {
        let mut row = rest.clone();
        row.insert(place, unit.clone());
        row
    };
    let mut best: Option<(f64, usize)> = None;
    for place in (0..=rest.len()).rev() {
        plan.rows[at] = row_with(place);
        stack_row(plan, &plan.rows[at], y);
        let channels = channel_cost(plan, sides, y, at) + channel_cost(plan, sides, y, at + 1);
        let cost = channels + order_cost(plan, at) - if Some(place) == now { worth } else { 0.0 };
        if best.is_none_or(|(least, _)| cost < least - 1e-9) {
            best = Some((cost, place));
        }
    }
    plan.rows[at] = row_with(best.map_or(0, |(_, place)| place));
    stack_row(plan, &plan.rows[at], y);
}
