//! A level as a whole: parts without connection are laid out one below the other.

use crate::draw::draw;
use crate::flow::{Flow, flow};
use crate::graph::{End, Graph, Layout, Net, Placed, PlacedPort, Point, Segment, Wire};
use crate::improve::improve;
use crate::insert::{fit, insert};
use crate::keys::Drawn;
use crate::lanes::{plan, settle};
use crate::layers::layers;
use crate::order::order;
use crate::rows::{chains, rows};
use crate::sides::sides;
use crate::skeleton::{Skeleton, along, skeleton};
use crate::stack::stack;

/// Distance of parts without connection.
const BETWEEN: f64 = 30.0;

/// Lays out one level. Nets that name a node or port that is not there, or have fewer than two ends, stay without
/// lines.
pub fn layout(graph: &Graph) -> Layout {
    let mut whole = Layout {
        nodes: Vec::with_capacity(graph.nodes.len()),
        wires: vec![Wire::default(); graph.nets.len()],
        ..Layout::default()
    };
    let blank = Placed {
        x: 0.0,
        y: 0.0,
        width: 0.0,
        height: 0.0,
        mirrored: false,
        label_above: false,
        ports: Vec::new(),
    };
    whole.nodes.resize(graph.nodes.len(), blank);
    for (nodes, nets) in parts(graph) {
        let place = |node: usize| nodes.binary_search(&node).unwrap_or(0);
        let part = Graph {
            nodes: nodes.iter().map(|node| graph.nodes[*node].clone()).collect(),
            nets: nets
                .iter()
                .map(|net| Net {
                    ends: graph.nets[*net]
                        .ends
                        .iter()
                        .map(|end| End { node: place(end.node), ..*end })
                        .collect(),
                    directed: graph.nets[*net].directed,
                })
                .collect(),
        };
        let part = connected(&part);
        let down = if whole.height > 0.0 { whole.height + BETWEEN } else { 0.0 };
        let moved = |at: Point| Point { y: at.y + down, ..at };
        for (node, placed) in nodes.iter().zip(part.nodes) {
            let ports =
                placed.ports.iter().map(|port| PlacedPort { at: moved(port.at), side: port.side }).collect();
            whole.nodes[*node] = Placed { y: placed.y + down, ports, ..placed };
        }
        for (net, wire) in nets.iter().zip(part.wires) {
            let segments = wire.segments.iter().map(|s| Segment { from: moved(s.from), to: moved(s.to) });
            whole.wires[*net] = Wire {
                segments: segments.collect(),
                junctions: wire.junctions.into_iter().map(moved).collect(),
            };
        }
        whole.width = whole.width.max(part.width);
        whole.height = down + part.height;
    }
    whole
}

/// Nodes and nets that hang together, each sorted; parts by their first node.
fn parts(graph: &Graph) -> Vec<(Vec<usize>, Vec<usize>)> {
    let n = graph.nodes.len();
    let sound = |net: &&Net| {
        net.ends.len() > 1
            && net.ends.iter().all(|end| end.node < n && end.port < graph.nodes[end.node].ports.len())
    };
    let mut root: Vec<usize> = (0..n).collect();
    fn find(root: &mut [usize], mut v: usize) -> usize {
        while root[v] != v {
            root[v] = root[root[v]];
            v = root[v];
        }
        v
    }
    for net in graph.nets.iter().filter(sound) {
        for end in &net.ends {
            let (a, b) = (find(&mut root, net.ends[0].node), find(&mut root, end.node));
            root[a.max(b)] = a.min(b);
        }
    }
    let mut parts: Vec<(Vec<usize>, Vec<usize>)> = vec![(Vec::new(), Vec::new()); n];
    for v in 0..n {
        parts[find(&mut root, v)].0.push(v);
    }
    for (i, net) in graph.nets.iter().enumerate().filter(|(_, net)| sound(net)) {
        parts[find(&mut root, net.ends[0].node)].1.push(i);
    }
    parts.retain(|(nodes, _)| !nodes.is_empty());
    parts
}

fn connected(graph: &Graph) -> Layout {
    let flow = flow(graph);
    // First the skeleton: what only stands in a wire, and a scope, moves nothing else.
    let drawn = drawn(skeleton(graph));
    let layer = layers(graph, &flow, &drawn.skeleton.along());
    let mut sides = sides(graph, &flow, &layer);
    let core = without_watching(graph, &flow);
    let mut core = plan(&core, &flow, &layer, &sides);
    for row in &mut core.rows {
        row.retain(|unit| !unit.iter().any(|item| flow.watching.get(*item) == Some(&true)));
    }
    drawn.sort(&mut core);
    for (v, node) in drawn.skeleton.node.iter().enumerate() {
        core.kept[v] = node.is_some();
    }
    let mut y = stack(&core);
    improve(&mut core, &mut sides, &mut y);
    fit(&mut core, &sides);
    let mut y = stack(&core);
    improve(&mut core, &mut sides, &mut y);
    let chains = drawn.chains_of(graph);
    let mut y = rows(&core, &sides, &chains);
    improve(&mut core, &mut sides, &mut y);
    let mut plan = plan(graph, &flow, &layer, &sides);
    plan.kept[..graph.nodes.len()].clone_from_slice(&core.kept[..graph.nodes.len()]);
    settle(&mut plan, &core);
    insert(&mut plan, &sides);
    let mut y = rows(&plan, &sides, &chains);
    // Once more with the true heights.
    let before = plan.rows.clone();
    improve(&mut plan, &mut sides, &mut y);
    if before != plan.rows {
        y = rows(&plan, &sides, &chains);
    }
    draw(graph, &flow, &plan, &sides, &y)
}

/// Lays out the skeleton of a level.
fn drawn(skeleton: Skeleton) -> Drawn {
    let flow = flow(&skeleton.graph);
    let layer = layers(&skeleton.graph, &flow, &along(&skeleton.graph));
    let mut sides = sides(&skeleton.graph, &flow, &layer);
    let mut plan = plan(&skeleton.graph, &flow, &layer, &sides);
    order(&mut plan, &mut sides);
    let chains = chains(&skeleton.graph, &flow, &plan, &sides);
    let mut y = rows(&plan, &sides, &chains);
    improve(&mut plan, &mut sides, &mut y);
    let y = rows(&plan, &sides, &chains);
    Drawn { skeleton, plan, sides, y, chains }
}

/// The same nodes, with wires to those that only watch left out.
fn without_watching(graph: &Graph, flow: &Flow) -> Graph {
    let mut core = graph.clone();
    for net in core.nets.iter_mut().filter(|net| net.directed) {
        net.ends.retain(|end| !flow.watching[end.node]);
    }
    core
}
