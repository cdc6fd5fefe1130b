//! The side of each port, and its place along that side.

use crate::graph::{Form, Graph, PortKind, Side};
use crate::structure::flow::Flow;

/// Least distance of two ports.
pub(crate) const PITCH: f64 = 18.0;

/// Ports by side. `order` has the ports of the left and of the right side from top to bottom.
#[derive(Debug, Clone)]
pub(crate) struct Sides {
    pub side: Vec<Vec<Side>>,
    pub order: Vec<[Vec<usize>; 2]>,
    /// Conserving ports, which may change places.
    pub free: Vec<Vec<bool>>,
    /// An input of a circle that may enter from above as well as from below.
    pub either: Vec<Option<usize>>,
    pub width: Vec<f64>,
    pub height: Vec<f64>,
}

impl Sides {
    /// Place of a port below the upper edge of its box.
    pub fn offset(&self, node: usize, port: usize) -> f64 {
        let at = |ports: &[usize]| {
            let place = ports.iter().position(|known| *known == port).unwrap_or(0) as f64;
            self.height[node] / 2.0 + (place - (ports.len() as f64 - 1.0) / 2.0) * PITCH
        };
        match self.side[node][port] {
            Side::West => at(&self.order[node][0]),
            Side::East => at(&self.order[node][1]),
            Side::North => 0.0,
            Side::South => self.height[node],
        }
    }
}

/// Position on the axis of layers: channel c is 2 c, layer l is 2 l + 1.
pub(crate) fn position(layer: usize, side: Side) -> usize {
    match side {
        Side::West => 2 * layer,
        Side::East => 2 * layer + 2,
        Side::North | Side::South => 2 * layer + 1,
    }
}

pub(crate) fn sides(graph: &Graph, flow: &Flow, layer: &[usize]) -> Sides {
    let n = graph.nodes.len();
    let mut side: Vec<Vec<Side>> = (0..n).map(|node| signal_sides(graph, flow, node)).collect();
    // Conserving ports look at each other: twice round is enough in practice, and it ends in any case.
    for _ in 0..3 {
        for node in 0..n {
            turn_free_ports(graph, layer, &mut side, node);
        }
    }
    one_lane_a_layer(graph, layer, &mut side);
    let on = |node: usize, wanted: Side| -> Vec<usize> {
        (0..side[node].len()).filter(|port| side[node][*port] == wanted).collect()
    };
    let order: Vec<[Vec<usize>; 2]> = (0..n).map(|v| [on(v, Side::West), on(v, Side::East)]).collect();
    let height = (0..n)
        .map(|v| {
            let most = order[v].iter().map(Vec::len).max().unwrap_or(0) as f64;
            let node = &graph.nodes[v];
            match node.form {
                Form::Box => node.height.max(most * PITCH + 6.0),
                Form::Bar => node.height.max(most * PITCH - 6.0),
                Form::Circle | Form::Hanging => node.height,
            }
        })
        .collect();
    let width = graph.nodes.iter().map(|node| node.width).collect();
    let free = graph
        .nodes
        .iter()
        .map(|node| node.ports.iter().map(|port| *port == PortKind::Free).collect())
        .collect();
    let either = (0..n).map(|node| either(graph, flow, &side[node], node)).collect();
    Sides { side, order, free, either, width, height }
}

/// The only input of a circle that enters from above or below, if it is no feedback.
fn either(graph: &Graph, flow: &Flow, side: &[Side], v: usize) -> Option<usize> {
    let node = &graph.nodes[v];
    if node.form != Form::Circle || node.label_height > 0.0 {
        return None;
    }
    let mut ports = (0..side.len()).filter(|port| matches!(side[*port], Side::North | Side::South));
    let port = ports.next()?;
    (ports.next().is_none() && !is_feedback(graph, flow, v, port)).then_some(port)
}

/// Whether feedback enters at a port.
fn is_feedback(graph: &Graph, flow: &Flow, v: usize, port: usize) -> bool {
    graph.nets.iter().zip(&flow.feedback).any(|(net, feedback)| {
        let mut ends = net.ends.iter().zip(feedback).skip(1);
        ends.any(|(end, back)| *back && end.node == v && end.port == port)
    })
}

/// Inputs left, outputs right, or the other way round; a circle takes feedback from below.
fn signal_sides(graph: &Graph, flow: &Flow, v: usize) -> Vec<Side> {
    let node = &graph.nodes[v];
    let (inlet, outlet) = if flow.mirrored[v] { (Side::East, Side::West) } else { (Side::West, Side::East) };
    let mut sides: Vec<Side> = node
        .ports
        .iter()
        .map(|port| match port {
            PortKind::Input | PortKind::Free if node.form == Form::Hanging => Side::North,
            PortKind::Output => outlet,
            PortKind::Input | PortKind::Free => inlet,
        })
        .collect();
    if node.form != Form::Circle {
        return sides;
    }
    let back = |port: usize| is_feedback(graph, flow, v, port);
    let inputs: Vec<usize> = (0..sides.len()).filter(|port| node.ports[*port] == PortKind::Input).collect();
    let below = inputs.iter().copied().find(|port| back(*port));
    if let Some(below) = below {
        sides[below] = Side::South;
    }
    // One input stays in line with the output; what is written before it enters from above, what is written after it
    // from below as long as there is room, so that sources may stand in the order of the text.
    let rest: Vec<usize> = inputs.into_iter().filter(|port| Some(*port) != below).collect();
    let forward: Vec<usize> = rest.iter().copied().filter(|port| !back(*port)).collect();
    let straight = match forward.as_slice() {
        [_, middle, _] => Some(*middle),
        [first, ..] => Some(*first),
        [] => rest.first().copied(),
    };
    let (mut north, mut south) = (true, below.is_none());
    for port in rest.into_iter().filter(|port| Some(*port) != straight) {
        let after = straight.is_some_and(|straight| port > straight);
        if south && (after || !north) {
            (sides[port], south) = (Side::South, false);
        } else if north {
            (sides[port], north) = (Side::North, false);
        }
    }
    sides
}

/// Puts each conserving port to the side where the rest of its net is.
fn turn_free_ports(graph: &Graph, layer: &[usize], side: &mut [Vec<Side>], v: usize) {
    if graph.nodes[v].form == Form::Hanging {
        return;
    }
    let mut used = [false; 2];
    let free: Vec<usize> = (0..graph.nodes[v].ports.len())
        .filter(|port| graph.nodes[v].ports[*port] == PortKind::Free)
        .collect();
    let mut undecided = Vec::new();
    for &port in &free {
        let Some(net) =
            graph.nets.iter().find(|net| net.ends.iter().any(|end| end.node == v && end.port == port))
        else {
            undecided.push(port);
            continue;
        };
        let others = || net.ends.iter().filter(|end| end.node != v);
        let left = others().filter(|end| layer[end.node] < layer[v]).count();
        let right = others().filter(|end| layer[end.node] > layer[v]).count();
        let wanted = match (left, right) {
            (0, 0) => {
                // Beside nodes of the same layer: where they look.
                let west = others().filter(|end| side[end.node][end.port] == Side::West).count();
                if 2 * west >= others().count() { Side::West } else { Side::East }
            }
            (0, _) => Side::East,
            (_, 0) => Side::West,
            _ => {
                undecided.push(port);
                continue;
            }
        };
        used[usize::from(wanted == Side::East)] = true;
        side[v][port] = wanted;
    }
    // A net that goes on both ways takes the side that is free; the first port left, the others right.
    for port in undecided {
        let natural = if free.first() == Some(&port) { Side::West } else { Side::East };
        side[v][port] = match used {
            [true, false] => Side::East,
            [false, true] => Side::West,
            _ => natural,
        };
        used[usize::from(side[v][port] == Side::East)] = true;
    }
}

/// A net runs past a layer once; a second block that would hang from it there takes it from the left.
fn one_lane_a_layer(graph: &Graph, layer: &[usize], side: &mut [Vec<Side>]) {
    for net in &graph.nets {
        let mut taken = Vec::new();
        for end in &net.ends {
            let mine = &mut side[end.node][end.port];
            if matches!(*mine, Side::North | Side::South) {
                if taken.contains(&layer[end.node]) {
                    *mine = Side::West;
                } else {
                    taken.push(layer[end.node]);
                }
            }
        }
        // A wire from a block to itself, or between two that hang side by side, needs a channel.
        let all_hang =
            net.ends.iter().all(|end| matches!(side[end.node][end.port], Side::North | Side::South));
        if all_hang
            && taken.len() == 1
            && let Some(end) = net.ends.first()
        {
            side[end.node][end.port] = Side::West;
        }
    }
}
