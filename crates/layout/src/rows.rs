//! The height of everything: in the given order, with wires as straight as possible.

use std::collections::BTreeSet;

use crate::flow::Flow;
use crate::graph::{Graph, PortKind};
use crate::lanes::{Item, Plan, Tap};
use crate::sides::Sides;
use crate::simplex::{Edge, solve};

/// Weights of a straight line between two taps.
const MAIN: i64 = 24;
const LANES: i64 = 8;
const PLAIN: i64 = 4;
const TO_SINK: i64 = 2;
const SAME_SIDE: i64 = 1;

/// Places of the upper edges of all items, whole numbers.
pub(crate) fn rows(graph: &Graph, flow: &Flow, plan: &Plan, sides: &Sides) -> Vec<f64> {
    let main = main_chain(graph, flow);
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
    for (channel, groups) in plan.channels.iter().zip(&plan.groups) {
        for group in groups {
            for (a, b) in pairs(&channel[group.clone()]) {
                let weight = weight(graph, plan, &main, &a, &b);
                // The new variable lies above both taps, as close as it may be.
                for tap in [a, b] {
                    let offset = match plan.items[tap.item] {
                        Item::Node(node) => sides.offset(node, tap.port).round() as i64,
                        Item::Lane(_) => 0,
                    };
                    edges.push(Edge { tail: n, head: tap.item, length: -offset, weight });
                }
                n += 1;
            }
        }
    }
    let mut y = solve(n, &edges);
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

fn weight(graph: &Graph, plan: &Plan, main: &BTreeSet<(usize, usize)>, a: &Tap, b: &Tap) -> i64 {
    if a.right == b.right {
        return SAME_SIDE;
    }
    match (plan.items[a.item], plan.items[b.item]) {
        (Item::Lane(_), Item::Lane(_)) => LANES,
        (Item::Node(a), Item::Node(b)) if main.contains(&(a, b)) || main.contains(&(b, a)) => MAIN,
        (Item::Node(_), Item::Node(b)) if !graph.nodes[b].ports.contains(&PortKind::Output) => TO_SINK,
        _ => PLAIN,
    }
}

/// The longest forward path, which should be a straight line: its pairs of neighbours.
fn main_chain(graph: &Graph, flow: &Flow) -> BTreeSet<(usize, usize)> {
    let n = graph.nodes.len();
    // In the order of the file forward wires mostly lead on, and those that do not are left out.
    let mut length = vec![0_usize; n];
    let mut from = vec![None; n];
    let mut wires: Vec<(usize, usize)> = Vec::new();
    for (net, feedback) in graph.nets.iter().zip(&flow.feedback).filter(|(net, _)| net.ends.len() > 1) {
        let source = net.ends[0].node;
        for (end, back) in net.ends.iter().zip(feedback).skip(1) {
            let (a, b) =
                if net.directed || source < end.node { (source, end.node) } else { (end.node, source) };
            if !back && a < b && !flow.mirrored[a] && !flow.mirrored[b] {
                wires.push((a, b));
            }
        }
    }
    wires.sort_unstable();
    for (a, b) in wires {
        if length[a] + 1 > length[b] {
            length[b] = length[a] + 1;
            from[b] = Some(a);
        }
    }
    let mut chain = BTreeSet::new();
    let mut at = (0..n).rev().max_by_key(|v| length[*v]);
    while let Some(b) = at {
        at = from[b];
        if let Some(a) = at {
            chain.insert((a, b));
        }
    }
    chain
}
