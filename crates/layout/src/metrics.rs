//! How good a drawing is, in numbers.

use crate::graph::{Graph, Layout, Placed, Segment};

/// What can be counted in a drawing.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Metrics {
    /// Pairs of blocks that lie over each other.
    pub overlaps: usize,
    /// Lines of wires that run through a block.
    pub through: usize,
    /// Pairs of lines of different wires that lie over each other.
    pub shared: usize,
    /// Ports of nets whose wire does not reach them.
    pub loose: usize,
    /// Crossings of different wires.
    pub crossings: usize,
    /// Bends of wires, branches not counted.
    pub bends: usize,
    /// Length of all wires.
    pub length: f64,
}

/// Counts everything of a layout.
pub fn metrics(graph: &Graph, layout: &Layout) -> Metrics {
    let mut found = Metrics::default();
    let boxes: Vec<[f64; 4]> = layout.nodes.iter().map(|node| inside(node, 0.5)).collect();
    for (i, a) in boxes.iter().enumerate() {
        found.overlaps += boxes[i + 1..].iter().filter(|b| meet(a, b)).count();
    }
    let lines: Vec<(usize, [f64; 4])> = layout
        .wires
        .iter()
        .enumerate()
        .flat_map(|(net, wire)| wire.segments.iter().map(move |segment| (net, ends(segment))))
        .collect();
    for (i, (net, a)) in lines.iter().enumerate() {
        found.through += boxes.iter().filter(|b| meet(a, b)).count();
        found.length += a[2] - a[0] + a[3] - a[1];
        for (_, b) in lines[i + 1..].iter().filter(|(other, _)| other != net) {
            if !touch(a, b) {
                continue;
            }
            if is_level(a) == is_level(b) { found.shared += 1 } else { found.crossings += 1 }
        }
    }
    for (wire, net) in layout.wires.iter().zip(&graph.nets) {
        let corners = wire.segments.iter().filter(|s| s.from.y == s.to.y).flat_map(|level| {
            wire.segments.iter().filter(|s| s.from.x == s.to.x).filter(|upright| {
                let (x, y) = (upright.from.x, level.from.y);
                (x == level.from.x || x == level.to.x) && (y == upright.from.y || y == upright.to.y)
            })
        });
        found.bends += corners.count();
        if net.ends.len() > 1 {
            let reached = |end: &&crate::End| {
                let Some(port) = layout.nodes.get(end.node).and_then(|node| node.ports.get(end.port)) else {
                    return true;
                };
                wire.segments.iter().any(|segment| {
                    let line = ends(segment);
                    let (x, y) = (port.at.x, port.at.y);
                    line[0] - 0.6 <= x && x <= line[2] + 0.6 && line[1] - 0.6 <= y && y <= line[3] + 0.6
                })
            };
            found.loose += net.ends.iter().filter(|end| !reached(end)).count();
        }
    }
    found
}

fn inside(node: &Placed, margin: f64) -> [f64; 4] {
    [node.x + margin, node.y + margin, node.x + node.width - margin, node.y + node.height - margin]
}

fn ends(segment: &Segment) -> [f64; 4] {
    [segment.from.x, segment.from.y, segment.to.x, segment.to.y]
}

fn is_level(line: &[f64; 4]) -> bool {
    line[1] == line[3]
}

fn meet(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

fn touch(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[0] <= b[2] && b[0] <= a[2] && a[1] <= b[3] && b[1] <= a[3]
}
