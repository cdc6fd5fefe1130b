//! The order within each layer, for few crossings.

use std::ops::Range;

use crate::graph::Side;
use crate::lanes::{Item, Plan, Rows, Tap};
use crate::sides::Sides;

/// What a unit of length costs, in crossings: it decides between orders with the same crossings.
const LENGTH: f64 = 1e-3;
/// What a block below a wire that leads back costs.
const ABOVE: f64 = 0.4;
/// What two blocks cost that stand otherwise than in the file: the order of the text stays unless crossings fall.
const AGAINST_TEXT: f64 = 0.6;
/// By how much another beginning must be better than the order of the text.
const WORTH: f64 = 0.5;

/// Sorts the rows of a plan by the means of their neighbours, from several beginnings, and exchanges neighbours as long
/// as it helps.
pub(crate) fn order(plan: &mut Plan, sides: &mut Sides) {
    let mut best: Option<(f64, Rows, Sides)> = None;
    let begin = (plan.rows.clone(), sides.clone());
    for start in 0..4 {
        plan.rows.clone_from(&begin.0);
        sides.clone_from(&begin.1);
        let mut y = stack(plan);
        for sweep in 0..3 * usize::from(start > 0) {
            sort_by_means(plan, sides, &mut y, (sweep + start) % 2 == 0);
        }
        improve(plan, sides, &mut y);
        if start == 3 {
            sort_by_means(plan, sides, &mut y, true);
            improve(plan, sides, &mut y);
        }
        let cost = total(plan, sides, &y);
        // The first beginning is the text.
        let cost = if start == 0 { cost - WORTH } else { cost };
        if best.as_ref().is_none_or(|(least, ..)| cost < least - 1e-9) {
            best = Some((cost, plan.rows.clone(), sides.clone()));
        }
    }
    if let Some((_, rows, best)) = best {
        plan.rows = rows;
        *sides = best;
    }
    run_together(plan, sides);
}

/// Brings each loose unit to the best place in its row, the others kept; among equals as far below as it may be. A wire
/// over several layers runs above all or below all at first, whichever is better.
pub(crate) fn insert(plan: &mut Plan, sides: &Sides) {
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
    let mut y = stack(plan);
    for at in (0..plan.rows.len()).chain(0..plan.rows.len()) {
        let loose: Vec<Vec<usize>> =
            plan.rows[at].iter().filter(|unit| plan.loose[unit[0]]).cloned().collect();
        for unit in loose {
            relocate(plan, sides, &mut y, at, unit);
        }
    }
    run_together(plan, sides);
}

/// Brings the lanes of a net above or below those of another one, in all layers at once: a wire that changes sides on its
/// way crosses twice, and no lane alone can mend that.
fn run_together(plan: &mut Plan, sides: &Sides) {
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

/// Brings one unit of a row to its best place.
fn relocate(plan: &mut Plan, sides: &Sides, y: &mut [f64], at: usize, unit: Vec<usize>) {
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
        let cost = channels + order_cost(plan, at);
        if best.is_none_or(|(least, _)| cost < least - 1e-9) {
            best = Some((cost, place));
        }
    }
    plan.rows[at] = row_with(best.map_or(0, |(_, place)| place));
    stack_row(plan, &plan.rows[at], y);
}

/// Places of all items, each layer stacked around zero.
fn stack(plan: &Plan) -> Vec<f64> {
    let mut y = vec![0.0; plan.items.len()];
    for row in &plan.rows {
        stack_row(plan, row, &mut y);
    }
    y
}

fn stack_row(plan: &Plan, row: &[Vec<usize>], y: &mut [f64]) {
    let (mut at, mut last) = (0.0, None);
    for &item in row.iter().flatten() {
        at += last.map_or(0.0, |last| plan.distance(last, item));
        y[item] = at;
        last = Some(item);
    }
    let bottom = last.map_or(0.0, |last| at + plan.extent[last].1);
    row.iter().flatten().for_each(|item| y[*item] -= bottom / 2.0);
}

/// Sorts every layer by the mean place of what its units are connected to on one side.
fn sort_by_means(plan: &mut Plan, sides: &Sides, y: &mut [f64], to_the_right: bool) {
    let count = plan.rows.len();
    for step in 0..count {
        let at = if to_the_right { step } else { count - 1 - step };
        let channel = if to_the_right { at } else { at + 1 };
        let mut sum = vec![(0.0, 0.0); plan.items.len()];
        for group in &plan.groups[channel] {
            let taps = &plan.channels[channel][group.clone()];
            for mine in taps.iter().filter(|tap| tap.right == to_the_right) {
                for other in taps.iter().filter(|tap| tap.right != to_the_right) {
                    let shift = plan.tap_y(sides, y, mine) - y[mine.item];
                    sum[mine.item].0 += plan.tap_y(sides, y, other) - shift;
                    sum[mine.item].1 += 1.0;
                }
            }
        }
        let mut row = std::mem::take(&mut plan.rows[at]);
        let key = |unit: &Vec<usize>| {
            let (total, count) =
                unit.iter().fold((0.0, 0.0), |acc, item| (acc.0 + sum[*item].0, acc.1 + sum[*item].1));
            if count > 0.0 { total / count } else { y[unit[0]] }
        };
        row.sort_by(|a, b| key(a).total_cmp(&key(b)));
        stack_row(plan, &row, y);
        plan.rows[at] = row;
    }
}

/// Exchanges neighbours in layers, and conserving ports on the sides of blocks, while that lowers the cost. The places
/// `y` keep to the order.
pub(crate) fn improve(plan: &mut Plan, sides: &mut Sides, y: &mut [f64]) {
    let mut costs: Vec<f64> =
        (0..plan.channels.len()).map(|channel| channel_cost(plan, sides, y, channel)).collect();
    for _ in 0..12 {
        let mut better = false;
        for at in 0..plan.rows.len() {
            for place in 1..plan.rows[at].len() {
                if !plan.rows[at][place - 1..=place].iter().any(|unit| plan.loose[unit[0]]) {
                    continue;
                }
                let before = costs[at] + costs[at + 1] + order_cost(plan, at);
                let kept: Vec<(usize, f64)> =
                    plan.rows[at][place - 1..=place].iter().flatten().map(|item| (*item, y[*item])).collect();
                exchange(plan, y, at, place);
                let left = channel_cost(plan, sides, y, at);
                let right = channel_cost(plan, sides, y, at + 1);
                if left + right + order_cost(plan, at) < before - 1e-9 {
                    (costs[at], costs[at + 1], better) = (left, right, true);
                } else {
                    plan.rows[at].swap(place - 1, place);
                    kept.iter().for_each(|(item, place)| y[*item] = *place);
                }
            }
        }
        if plan.loose.iter().all(|loose| *loose) {
            better |= exchange_ports(plan, sides, y, &mut costs);
            better |= turn_inputs(plan, sides, y, &mut costs);
        }
        if !better {
            break;
        }
    }
}

/// Exchanges two neighbours; together they take the room that they had.
fn exchange(plan: &mut Plan, y: &mut [f64], at: usize, place: usize) {
    let top = y[plan.rows[at][place - 1][0]] - plan.extent[plan.rows[at][place - 1][0]].0;
    plan.rows[at].swap(place - 1, place);
    let items: Vec<usize> = plan.rows[at][place - 1..=place].iter().flatten().copied().collect();
    let mut last: Option<usize> = None;
    for item in items {
        y[item] = last.map_or(top + plan.extent[item].0, |last| y[last] + plan.distance(last, item));
        last = Some(item);
    }
}

/// Conserving ports on one side of a block may stand in either order.
fn exchange_ports(plan: &Plan, sides: &mut Sides, y: &[f64], costs: &mut [f64]) -> bool {
    let mut better = false;
    for node in 0..sides.order.len() {
        for (side, channel) in [(0, plan.layer_of[node]), (1, plan.layer_of[node] + 1)] {
            for place in 1..sides.order[node][side].len() {
                let pair = [sides.order[node][side][place - 1], sides.order[node][side][place]];
                if !pair.iter().all(|port| sides.free[node][*port]) {
                    continue;
                }
                sides.order[node][side].swap(place - 1, place);
                let cost = channel_cost(plan, sides, y, channel);
                if cost < costs[channel] - 0.5 {
                    costs[channel] = cost;
                    better = true;
                } else {
                    sides.order[node][side].swap(place - 1, place);
                }
            }
        }
    }
    better
}

/// An input of a sum may enter from above or below.
fn turn_inputs(plan: &mut Plan, sides: &mut Sides, y: &mut [f64], costs: &mut [f64]) -> bool {
    let mut better = false;
    for at in 0..plan.rows.len() {
        for place in 0..plan.rows[at].len() {
            let Some(node) = block_of(plan, &plan.rows[at][place]) else { continue };
            let Some(port) = sides.either[node].filter(|_| plan.rows[at][place].len() == 2) else { continue };
            let kept: Vec<(usize, f64)> = plan.rows[at][place].iter().map(|item| (*item, y[*item])).collect();
            let turn = |plan: &mut Plan, sides: &mut Sides| {
                plan.rows[at][place].reverse();
                let side = &mut sides.side[node][port];
                *side = if *side == Side::North { Side::South } else { Side::North };
            };
            turn(plan, sides);
            let (top, [first, second]) = (kept[0].1, [plan.rows[at][place][0], plan.rows[at][place][1]]);
            y[first] = top;
            y[second] = top + plan.distance(first, second);
            let (left, right) = (channel_cost(plan, sides, y, at), channel_cost(plan, sides, y, at + 1));
            if left + right < costs[at] + costs[at + 1] - 0.5 {
                (costs[at], costs[at + 1], better) = (left, right, true);
            } else {
                turn(plan, sides);
                kept.iter().for_each(|(item, place)| y[*item] = *place);
            }
        }
    }
    better
}

fn total(plan: &Plan, sides: &Sides, y: &[f64]) -> f64 {
    let channels = (0..plan.channels.len()).map(|channel| channel_cost(plan, sides, y, channel));
    channels.sum::<f64>() + (0..plan.rows.len()).map(|at| order_cost(plan, at)).sum::<f64>()
}

/// Blocks below wires that lead back, and blocks against the order of the text.
fn order_cost(plan: &Plan, at: usize) -> f64 {
    let (mut above, mut cost) = (0, 0.0);
    for (place, unit) in plan.rows[at].iter().enumerate() {
        let Some(block) = block_of(plan, unit) else {
            above += i32::from(unit.iter().all(|item| plan.back[*item]));
            continue;
        };
        if plan.back[block] {
            above += 1;
            continue;
        }
        cost += ABOVE * f64::from(above);
        // The order of the text holds among blocks of one sort, sinks or others.
        let alike = |other: &usize| plan.sink[*other] == plan.sink[block];
        let earlier = plan.rows[at][..place].iter().filter_map(|unit| block_of(plan, unit)).filter(alike);
        cost += AGAINST_TEXT * earlier.filter(|other| *other > block && !plan.back[*other]).count() as f64;
    }
    cost
}

/// The block of a unit.
fn block_of(plan: &Plan, unit: &[usize]) -> Option<usize> {
    unit.iter().copied().find(|item| matches!(plan.items[*item], Item::Node(_)))
}

/// A net in a channel: its trunk and its taps.
#[derive(Debug, Clone)]
pub(crate) struct Trunk {
    pub low: f64,
    pub high: f64,
    pub left: Vec<f64>,
    pub right: Vec<f64>,
}

impl Trunk {
    pub fn of(plan: &Plan, sides: &Sides, y: &[f64], taps: &[Tap]) -> Trunk {
        let mut trunk =
            Trunk { low: f64::INFINITY, high: f64::NEG_INFINITY, left: Vec::new(), right: Vec::new() };
        for tap in taps {
            trunk.add(plan.tap_y(sides, y, tap), tap.right);
        }
        trunk
    }

    pub fn add(&mut self, at: f64, right: bool) {
        self.low = self.low.min(at);
        self.high = self.high.max(at);
        if right { self.right.push(at) } else { self.left.push(at) }
    }

    /// Crossings where this trunk runs left of another.
    pub fn crossings_left_of(&self, other: &Trunk) -> usize {
        let within = |places: &[f64], trunk: &Trunk| {
            places.iter().filter(|at| trunk.low < **at && **at < trunk.high).count()
        };
        within(&self.right, other) + within(&other.left, self)
    }

    pub fn meets(&self, other: &Trunk) -> bool {
        self.low <= other.high && other.low <= self.high
    }
}

/// Crossings in a channel if every pair of trunks stands in its better order, and a little for lengths.
fn channel_cost(plan: &Plan, sides: &Sides, y: &[f64], channel: usize) -> f64 {
    let taps = &plan.channels[channel];
    let trunk = |group: &Range<usize>| Trunk::of(plan, sides, y, &taps[group.clone()]);
    let trunks: Vec<Trunk> = plan.groups[channel].iter().map(trunk).collect();
    let mut cost = 0.0;
    for (i, a) in trunks.iter().enumerate() {
        cost += LENGTH * (a.high - a.low);
        for b in trunks[i + 1..].iter().filter(|b| a.meets(b)) {
            cost += a.crossings_left_of(b).min(b.crossings_left_of(a)) as f64;
        }
    }
    cost
}
