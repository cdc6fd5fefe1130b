//! What remains of a level when everything that only stands in a wire is taken out: blocks with one input and one output,
//! two-pole elements in series, and sinks.
//!
//! A block more or less in a wire leaves the skeleton as it is, so an order found there holds for both.

use crate::flow::flow;
use crate::graph::{End, Form, Graph, Net, PortKind, Standing};

/// A level without what stands in its wires.
#[derive(Debug, Clone)]
pub(crate) struct Skeleton {
    pub graph: Graph,
    /// The node of the skeleton that a node of the level became.
    pub node: Vec<Option<usize>>,
    /// For each net of the level: the ends of the skeleton that it leads from and to, through all that stands in it.
    pub reach: Vec<Reach>,
    /// For each node that stands in a wire: the net of the level behind it, or before it where it ends.
    pub behind: Vec<Option<usize>>,
}

/// Ends of the level that a wire comes from and leads to.
#[derive(Debug, Clone, Default)]
pub(crate) struct Reach {
    pub from: Vec<End>,
    pub to: Vec<End>,
}

/// Takes out what stands in wires, the last of the text first.
pub(crate) fn skeleton(graph: &Graph) -> Skeleton {
    let n = graph.nodes.len();
    let mut nets: Vec<Option<Net>> = graph.nets.iter().cloned().map(Some).collect();
    let mut gone = flow(graph).watching;
    for net in nets.iter_mut().flatten() {
        net.ends.retain(|end| !gone[end.node]);
    }
    let mut behind = vec![None; n];
    while let Some((node, taken)) =
        (0..n).rev().filter(|v| !gone[*v]).find_map(|v| Some((v, taken(graph, &nets, v)?)))
    {
        gone[node] = true;
        behind[node] = behind_of(graph, node);
        match taken {
            Taken::Series(before, after) => {
                let Some(after) = nets[after].take() else { continue };
                let Some(before) = nets[before].as_mut() else { continue };
                let Some(at) = before.ends.iter().position(|end| end.node == node) else { continue };
                before.ends.splice(at..=at, after.ends.into_iter().filter(|end| end.node != node));
            }
            Taken::End(before) => {
                if let Some(before) = nets[before].as_mut() {
                    before.ends.retain(|end| end.node != node);
                }
            }
        }
    }
    let mut node = vec![None; n];
    let mut kept = Vec::new();
    for v in (0..n).filter(|v| !gone[*v]) {
        node[v] = Some(kept.len());
        kept.push(graph.nodes[v].clone());
    }
    let nets = nets
        .into_iter()
        .flatten()
        .filter(|net| net.ends.len() > 1)
        .map(|net| Net {
            ends: net.ends.iter().filter_map(|end| Some(End { node: node[end.node]?, ..*end })).collect(),
            ..net
        })
        .collect();
    let reach = (0..graph.nets.len()).map(|net| reach(graph, &node, net)).collect();
    Skeleton { graph: parted(Graph { nodes: kept, nets }), node, reach, behind }
}

/// The same with a net of its own for what leads back: so a block in a branch changes nothing.
fn parted(mut graph: Graph) -> Graph {
    let feedback = flow(&graph).feedback;
    let mut back = Vec::new();
    for (net, feedback) in graph.nets.iter_mut().zip(feedback) {
        if !feedback.contains(&true) || !feedback[1..].contains(&false) {
            continue;
        }
        let side = |wanted: bool| {
            let ends = net.ends.iter().zip(&feedback).enumerate();
            let ends = ends.filter(|(i, (_, back))| *i == 0 || **back == wanted);
            ends.map(|(_, (end, _))| *end).collect::<Vec<End>>()
        };
        back.push(Net { ends: side(true), directed: true });
        net.ends = side(false);
    }
    graph.nets.extend(back);
    graph
}

/// The nodes of each net.
pub(crate) fn along(graph: &Graph) -> Vec<Vec<usize>> {
    graph.nets.iter().map(|net| net.ends.iter().map(|end| end.node).collect()).collect()
}

impl Skeleton {
    /// The nodes of each net of the level, seen through what stands in the wire.
    pub fn along(&self) -> Vec<Vec<usize>> {
        let nodes = |reach: &Reach| {
            let mut nodes: Vec<usize> = reach.from.iter().chain(&reach.to).map(|end| end.node).collect();
            nodes.sort_unstable();
            nodes.dedup();
            nodes
        };
        self.reach.iter().map(nodes).collect()
    }
}

enum Taken {
    /// Between two nets.
    Series(usize, usize),
    /// At the end of a net.
    End(usize),
}

fn taken(graph: &Graph, nets: &[Option<Net>], v: usize) -> Option<Taken> {
    let node = &graph.nodes[v];
    if node.standing != Standing::Free || matches!(node.form, Form::Circle | Form::Hanging) {
        return None;
    }
    let net_at = |port: usize| {
        nets.iter().position(|net| net.as_ref().is_some_and(|net| net.ends.contains(&End { node: v, port })))
    };
    let ends = |net: usize| nets[net].as_ref().map_or(0, |net| net.ends.len());
    match node.ports.as_slice() {
        [PortKind::Input, PortKind::Output] => {
            let before = net_at(0)?;
            match net_at(1) {
                Some(after) if after == before => None,
                Some(after) if ends(after) > 1 => Some(Taken::Series(before, after)),
                _ => Some(Taken::End(before)),
            }
        }
        [PortKind::Free, PortKind::Free] => {
            let (a, b) = (net_at(0)?, net_at(1)?);
            if a == b || ends(a) < 2 || ends(b) < 2 || ends(a) > 2 && ends(b) > 2 {
                return None;
            }
            let only_ground = |net: usize| {
                nets[net].as_ref().is_some_and(|net| {
                    net.ends.iter().all(|end| end.node == v || graph.nodes[end.node].form == Form::Hanging)
                })
            };
            if only_ground(a) || only_ground(b) {
                return None;
            }
            let first = |net: usize| nets[net].as_ref().is_some_and(|net| net.ends[0].node == v);
            match (first(a), first(b)) {
                (false, true) => Some(Taken::Series(a, b)),
                (true, false) => Some(Taken::Series(b, a)),
                _ => None,
            }
        }
        _ => None,
    }
}

/// The net behind a node that stands in a wire.
fn behind_of(graph: &Graph, v: usize) -> Option<usize> {
    let at = |port: usize| graph.nets.iter().position(|net| net.ends.contains(&End { node: v, port }));
    let led = at(1).filter(|net| graph.nets[*net].ends.len() > 1);
    led.or(at(0))
}

/// Where a net comes from and leads to.
fn reach(graph: &Graph, kept: &[Option<usize>], net: usize) -> Reach {
    let mut found = Reach::default();
    for (i, end) in graph.nets[net].ends.iter().enumerate() {
        let side = if i == 0 { &mut found.from } else { &mut found.to };
        beyond(graph, kept, *end, net, side);
    }
    found
}

/// The ends of the skeleton at an end of a net, or behind it if its node stands in a wire.
pub(crate) fn beyond(graph: &Graph, kept: &[Option<usize>], end: End, net: usize, found: &mut Vec<End>) {
    let mut seen = vec![false; graph.nets.len()];
    let mut stack = vec![(end, net)];
    while let Some((end, net)) = stack.pop() {
        seen[net] = true;
        if kept[end.node].is_some() {
            if !found.contains(&end) {
                found.push(end);
            }
            continue;
        }
        for (other, about) in graph.nets.iter().enumerate().filter(|(other, _)| *other != net) {
            let Some(at) = about.ends.iter().position(|there| there.node == end.node) else { continue };
            if seen[other] {
                continue;
            }
            // Against the direction of a signal there is only its source.
            let ends = if about.directed && at > 0 { &about.ends[..1] } else { &about.ends };
            stack.extend(ends.iter().filter(|there| there.node != end.node).map(|there| (*there, other)));
        }
    }
}
