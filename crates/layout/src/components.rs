//! Parts of a level without connection are laid out one below the other.

use crate::graph::{End, Graph, Layout, Net, Placed, PlacedPort, Point, Segment, Wire};
use crate::level::level;

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
        let part = level(&part);
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
