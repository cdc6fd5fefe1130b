//! What remains of a level when everything that only stands in a wire is taken out: blocks with one input and one output,
//! and two-pole elements in series. Without sinks it is bare.
//!
//! A block more or less in a wire leaves the skeleton as it is, so an order found there holds for both.

use crate::graph::{End, Form, Graph, Net, Node, PortKind, Standing};
use crate::structure::flow::flow;

/// A level without what stands in its wires.
#[derive(Debug, Clone)]
pub(crate) struct Skeleton {
    pub graph: Graph,
    /// The node of the skeleton that a node of the level became.
    pub node: Vec<Option<usize>>,
    /// For each net of the level: the ends of the skeleton that it leads from and to, through all that stands in it.
    pub reach: Vec<Reach>,
    /// For each net of the level: it is a signal.
    pub directed: Vec<bool>,
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
    let mut gone = vec![false; n];
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
    let nets: Vec<Net> = nets.into_iter().flatten().collect();
    let (left, node) = remaining(&graph.nodes, &nets, &gone);
    let reach = reach_of_all(graph, &node);
    Skeleton { graph: parted(left), node, reach, behind, directed: directed(graph) }
}

/// A level without the nodes that only watch.
pub(crate) fn bare(graph: &Graph) -> Skeleton {
    let (left, node) = remaining(&graph.nodes, &graph.nets, &flow(graph).watching);
    let reach = reach_of_all(graph, &node);
    Skeleton { graph: left, node, reach, behind: vec![None; graph.nodes.len()], directed: directed(graph) }
}

/// The nodes that are not gone and the nets between them, and which node of them a node became.
fn remaining(nodes: &[Node], nets: &[Net], gone: &[bool]) -> (Graph, Vec<Option<usize>>) {
    let mut node = vec![None; nodes.len()];
    let mut kept = Vec::new();
    for v in (0..nodes.len()).filter(|v| !gone[*v]) {
        node[v] = Some(kept.len());
        kept.push(nodes[v].clone());
    }
    let nets = nets
        .iter()
        .map(|net| Net {
            ends: net.ends.iter().filter_map(|end| Some(End { node: node[end.node]?, ..*end })).collect(),
            ..*net
        })
        .filter(|net| net.ends.len() > 1)
        .collect();
    (Graph { nodes: kept, nets }, node)
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
    /// What is left of another skeleton, which this one is a level of, as a skeleton of that one's level.
    pub fn of(self, outer: &Skeleton, level: &Graph) -> Skeleton {
        let node: Vec<Option<usize>> = outer.node.iter().map(|node| self.node[(*node)?]).collect();
        let reach = reach_of_all(level, &node);
        let (behind, directed) = (outer.behind.clone(), directed(level));
        Skeleton { graph: self.graph, node, reach, behind, directed }
    }

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

fn directed(graph: &Graph) -> Vec<bool> {
    graph.nets.iter().map(|net| net.directed).collect()
}

fn reach_of_all(graph: &Graph, kept: &[Option<usize>]) -> Vec<Reach> {
    (0..graph.nets.len()).map(|net| reach(graph, kept, net)).collect()
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
