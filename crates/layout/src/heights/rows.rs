//! The height of everything: in the given order, with wires as straight as possible.

use std::collections::BTreeMap;

use crate::graph::{End, Form, Graph, PortKind, Side};
use crate::order::lanes::{Item, Plan, Tap};
use crate::simplex::{Edge, solve_pulled};
use crate::structure::flow::Flow;
use crate::structure::sides::Sides;

/// Weights of a straight line between two taps.
const MAIN: i64 = 80;
pub(crate) const CHAIN: i64 = 16;
const LANES: i64 = 8;
const PLAIN: i64 = 4;
const TO_SINK: i64 = 2;
const SAME_SIDE: i64 = 1;

/// Pairs of neighbours whose wire should be straight, with the weight of that.
pub(crate) type Chains = BTreeMap<(usize, usize), i64>;

/// Places of the upper edges of all items, whole numbers.
pub(crate) fn rows(plan: &Plan, sides: &Sides, chains: &Chains) -> Vec<f64> {
    let mut edges = Vec::new();
    for row in &plan.rows {
        let items: Vec<usize> = row.iter().flatten().copied().collect();
        edges.extend(items.windows(2).map(|pair| Edge {
            tail: pair[0],
            head: pair[1],
            length: plan.distance(pair[0], pair[1]) as i64,
            weight: 0,
        }));
        // A block and the lane that it hangs from stay together.
        for unit in row.iter().filter(|unit| unit.len() > 1) {
            for pair in unit.windows(2) {
                edges.push(Edge {
                    tail: pair[0],
                    head: pair[1],
                    length: plan.distance(pair[0], pair[1]) as i64,
                    weight: 1,
                });
            }
        }
    }
    let mut n = plan.items.len();
    // What sinks wish decides only where nothing else does.
    let settled = plan.loose.iter().any(|loose| !loose);
    let of_sink = |item: usize| settled && plan.loose[item];
    let mut light = vec![false; edges.len()];
    for (channel, groups) in plan.channels.iter().zip(&plan.groups) {
        for group in groups {
            for (a, b) in pairs(&channel[group.clone()]) {
                let weight = weight(plan, chains, &a, &b);
                // The new variable lies above both taps, as close as it may be.
                for tap in [a, b] {
                    let offset = match plan.items[tap.item] {
                        Item::Node(node) => sides.offset(node, tap.port).round() as i64,
                        Item::Lane(_) => 0,
                    };
                    edges.push(Edge { tail: n, head: tap.item, length: -offset, weight });
                    light.push(of_sink(a.item) || of_sink(b.item));
                }
                n += 1;
            }
        }
    }
    let scale = n as i64 + 1;
    let lightest: i64 =
        edges.iter().zip(&light).filter(|(_, light)| **light).map(|(edge, _)| edge.weight).sum();
    let pull = scale * (lightest + 1);
    for (edge, light) in edges.iter_mut().zip(&light) {
        edge.weight *= if *light { scale } else { pull * scale };
    }
    let pulls: Vec<i64> = (0..n)
        .map(|item| match item {
            item if item >= plan.items.len() => 0,
            item if of_sink(item) => 1,
            _ => pull,
        })
        .collect();
    let mut y = solve_pulled(&edges, &pulls);
    y.truncate(plan.items.len());
    y.into_iter().map(|y| y as f64).collect()
}

/// The pairs of taps that want to be level.
fn pairs(taps: &[Tap]) -> Vec<(Tap, Tap)> {
    let left: Vec<Tap> = taps.iter().copied().filter(|tap| !tap.right).collect();
    let right: Vec<Tap> = taps.iter().copied().filter(|tap| tap.right).collect();
    match (left.as_slice(), right.as_slice()) {
        ([], all) | (all, []) => all.windows(2).map(|pair| (pair[0], pair[1])).collect(),
        (left, right) if left.len() * right.len() <= 6 => {
            left.iter().flat_map(|a| right.iter().map(|b| (*a, *b))).collect()
        }
        (left, right) => {
            let mut pairs: Vec<(Tap, Tap)> = right.iter().map(|b| (left[0], *b)).collect();
            pairs.extend(left[1..].iter().map(|a| (*a, right[0])));
            pairs
        }
    }
}

fn weight(plan: &Plan, chains: &Chains, a: &Tap, b: &Tap) -> i64 {
    if a.right == b.right {
        return SAME_SIDE;
    }
    match (plan.items[a.item], plan.items[b.item]) {
        (Item::Lane(_), Item::Lane(_)) => LANES,
        (Item::Node(a), Item::Node(b)) => match chains.get(&(a.min(b), a.max(b))) {
            Some(weight) => *weight,
            None if plan.sink[b] => TO_SINK,
            None => PLAIN,
        },
        _ => PLAIN,
    }
}

/// Paths that should be straight lines, as pairs of neighbours with their weights: each begins at the first block of the
/// file that no path has, and goes on along a shaft or a circuit rather than a signal, and where the way ahead is longest.
/// The first one counts most.
pub(crate) fn chains(graph: &Graph, flow: &Flow, plan: &Plan, sides: &Sides) -> Chains {
    let n = graph.nodes.len();
    let layer = &plan.layer_of;
    // Whether one of the wires is conserving.
    let mut next: Vec<BTreeMap<usize, bool>> = vec![BTreeMap::new(); n];
    let mut fed = vec![false; n];
    let free = |end: &End| {
        let node = &graph.nodes[end.node];
        !flow.mirrored[end.node]
            && !plan.sink[end.node]
            && node.form != Form::Hanging
            && matches!(sides.side[end.node][end.port], Side::West | Side::East)
    };
    for (net, feedback) in graph.nets.iter().zip(&flow.feedback).filter(|(net, _)| net.ends.len() > 1) {
        for (i, from) in net.ends.iter().enumerate().filter(|(i, _)| *i == 0 || !net.directed) {
            let others = net.ends.iter().zip(feedback).enumerate().filter(|(other, _)| *other != i);
            for (_, (to, back)) in others {
                let (a, b) = (from.node, to.node);
                if !back && layer[a] < layer[b] && free(from) && free(to) {
                    *next[a].entry(b).or_default() |= !net.directed;
                    fed[b] = true;
                }
            }
        }
    }
    let mut by_layer: Vec<usize> = (0..n).collect();
    by_layer.sort_by_key(|v| std::cmp::Reverse(layer[*v]));
    let mut ahead = vec![0_usize; n];
    for v in by_layer {
        ahead[v] = next[v].keys().map(|to| ahead[*to] + 1).max().unwrap_or(0);
    }
    let mut used = vec![false; n];
    let mut chains = BTreeMap::new();
    let mut weight = MAIN;
    for start in (0..n).filter(|v| !fed[*v]).chain((0..n).filter(|v| fed[*v])) {
        let (mut at, mut length) = (start, 0);
        while !std::mem::replace(&mut used[at], true) {
            let gives = |v: usize| graph.nodes[v].ports.contains(&PortKind::Output);
            let key = |(v, conserving): &(&usize, &bool)| {
                (**conserving && ahead[**v] > 0, ahead[**v], gives(**v), std::cmp::Reverse(**v))
            };
            let Some((&to, _)) = next[at].iter().filter(|(to, _)| !used[**to]).max_by_key(key) else { break };
            chains.insert((at.min(to), at.max(to)), weight);
            (at, length) = (to, length + 1);
        }
        // A constant beside the path does not make one.
        if length > 1 {
            weight = CHAIN;
        }
    }
    chains
}
