//! Exchanges of neighbours, as long as they make an order better.

use crate::graph::Side;
use crate::order::crossings::{block_of, channel_cost, order_cost};
use crate::order::insert::WORTH;
use crate::order::lanes::Plan;
use crate::structure::sides::Sides;

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
                let kept = |unit: &Vec<usize>| unit.iter().any(|item| plan.kept[*item]);
                if plan.rows[at][place - 1..=place].iter().all(kept) {
                    continue;
                }
                let pair = &plan.rows[at][place - 1..=place];
                let both = pair.iter().all(|unit| block_of(plan, unit).is_some());
                let worth = if both && pair.iter().any(kept) { WORTH } else { 1e-9 };
                let before = costs[at] + costs[at + 1] + order_cost(plan, at);
                let kept: Vec<(usize, f64)> =
                    plan.rows[at][place - 1..=place].iter().flatten().map(|item| (*item, y[*item])).collect();
                exchange(plan, y, at, place);
                let left = channel_cost(plan, sides, y, at);
                let right = channel_cost(plan, sides, y, at + 1);
                if left + right + order_cost(plan, at) < before - worth {
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
