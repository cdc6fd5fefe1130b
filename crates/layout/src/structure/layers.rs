//! The layer of each node: forward wires go right, and all wires are short.

use crate::graph::{End, Form, Graph, Net, PortKind, Standing};
use crate::simplex::{Edge, solve};
use crate::structure::flow::Flow;

const SIGNAL: i64 = 4;
const BACK: i64 = 2;
const CONSERVING: i64 = 3;
const RAIL: i64 = 1;
const PINNED: i64 = 64;

/// Layers from 0, left to right. `along` has the nodes of each net, seen through what stands in the wire.
pub(crate) fn layers(graph: &Graph, flow: &Flow, along: &[Vec<usize>]) -> Vec<usize> {
    let n = graph.nodes.len();
    let mut wishes = Wishes { n, edges: Vec::new(), next: vec![Vec::new(); n + 2] };
    for (net, feedback) in graph.nets.iter().zip(&flow.feedback).filter(|(net, _)| net.directed) {
        let from = net.ends[0].node;
        for (end, back) in net.ends.iter().zip(feedback).skip(1) {
            let to = end.node;
            match (flow.mirrored[from], flow.mirrored[to]) {
                (true, to_mirrored) => wishes.add(to, from, 1, if to_mirrored { BACK } else { 0 }),
                (false, true) => wishes.add(to, from, 0, BACK),
                (false, false) if *back => {}
                (false, false) => {
                    // A sink follows the last of its sources and pulls at none.
                    wishes.add(from, to, 1, if flow.watching[to] { 0 } else { SIGNAL });
                }
            }
        }
    }
    let hangs = |node: usize| graph.nodes[node].form == Form::Hanging;
    let grounded: Vec<bool> = (0..n).map(|node| grounded(graph, node)).collect();
    for (net, along) in graph.nets.iter().zip(along).filter(|(net, _)| !net.directed) {
        // The text is written in the direction of the drawing. A net with a reference, or with an element to one, is a
        // rail: all of it may stand one above the other.
        let rail = net.ends.iter().any(|end| hangs(end.node) || grounded[end.node]);
        let here = || net.ends.iter().map(|end| end.node);
        let nodes: Vec<usize> = if rail { along.clone() } else { here().collect() };
        let standing = || nodes.iter().copied().filter(|node| !hangs(*node));
        let first = if rail { standing().min() } else { standing().next() };
        let Some(first) = first.or(here().next()) else { continue };
        for to in nodes.iter().copied().filter(|to| *to != first) {
            let (length, weight) =
                if rail && !hangs(to) && !grounded[to] { (0, RAIL) } else { (1, CONSERVING) };
            if wishes.leads(to, first) {
                wishes.add(to, first, length, weight);
            } else {
                wishes.add(first, to, length, weight);
            }
        }
    }
    for (v, node) in graph.nodes.iter().enumerate() {
        wishes.add(n, v, 0, if node.standing == Standing::First { PINNED } else { 0 });
        wishes.add(v, n + 1, 0, if node.standing == Standing::Last { PINNED } else { 0 });
    }
    let x = solve(n + 2, &wishes.edges);
    let least = x[..n].iter().copied().min().unwrap_or(0);
    // Empty layers are left out.
    let mut used: Vec<i64> = x[..n].iter().map(|layer| layer - least).collect();
    used.sort_unstable();
    used.dedup();
    x[..n].iter().map(|layer| used.binary_search(&(layer - least)).unwrap_or(0)).collect()
}

/// Whether a node is an element that leads to a reference and nothing else.
fn grounded(graph: &Graph, node: usize) -> bool {
    let hangs = |end: &End| graph.nodes[end.node].form == Form::Hanging;
    let to_reference = |net: &Net| {
        net.ends.iter().any(|end| end.node == node)
            && net.ends.iter().any(hangs)
            && net.ends.iter().all(|end| end.node == node || hangs(end))
    };
    graph.nodes[node].ports == [PortKind::Free, PortKind::Free] && graph.nets.iter().any(to_reference)
}

struct Wishes {
    n: usize,
    edges: Vec<Edge>,
    next: Vec<Vec<usize>>,
}

impl Wishes {
    /// Adds an edge, unless it would close a circle.
    fn add(&mut self, tail: usize, head: usize, length: i64, weight: i64) {
        if tail == head || (tail < self.n && head < self.n && self.leads(head, tail)) {
            return;
        }
        self.edges.push(Edge { tail, head, length, weight });
        self.next[tail].push(head);
    }

    fn leads(&self, from: usize, to: usize) -> bool {
        let mut seen = vec![false; self.next.len()];
        let mut stack = vec![from];
        while let Some(v) = stack.pop() {
            if v == to {
                return true;
            }
            if !std::mem::replace(&mut seen[v], true) {
                stack.extend(&self.next[v]);
            }
        }
        false
    }
}
