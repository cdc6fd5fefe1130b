//! Small edits of a level.

use blocksim_layout::{End, Form, Graph, Net, Node, PortKind, Standing};

/// A level after an edit.
pub struct Edit {
    pub what: String,
    pub graph: Graph,
    /// Each block that was there before, and is still, with its place after.
    pub pairs: Vec<(usize, usize)>,
}

fn same(graph: &Graph) -> Vec<(usize, usize)> {
    (0..graph.nodes.len()).map(|node| (node, node)).collect()
}

fn signals(graph: &Graph) -> impl Iterator<Item = usize> {
    (0..graph.nets.len()).filter(|net| graph.nets[*net].directed)
}

fn small(ports: Vec<PortKind>) -> Node {
    Node {
        width: 44.0,
        height: 36.0,
        label_width: 30.0,
        label_height: 14.0,
        form: Form::Box,
        standing: Standing::Free,
        ports,
    }
}

/// Blocks that are wider, or have a longer name.
pub fn wider(graph: &Graph) -> Vec<Edit> {
    let edit = |node: usize| {
        let (mut box_wider, mut renamed) = (graph.clone(), graph.clone());
        box_wider.nodes[node].width += 30.0;
        renamed.nodes[node].label_width += 60.0;
        [("wider", box_wider), ("renamed", renamed)].map(|(what, changed)| Edit {
            what: format!("node {node} {what}"),
            graph: changed,
            pairs: same(graph),
        })
    };
    (0..graph.nodes.len()).flat_map(edit).collect()
}

/// Scopes more and fewer.
pub fn scopes(graph: &Graph) -> Vec<Edit> {
    let mut edits = Vec::new();
    for net in signals(graph) {
        let mut changed = graph.clone();
        changed.nodes.push(small(vec![PortKind::Input]));
        changed.nets[net].ends.push(End { node: graph.nodes.len(), port: 0 });
        edits.push(Edit { what: format!("scope at net {net}"), graph: changed, pairs: same(graph) });
    }
    for (sink, _) in graph.nodes.iter().enumerate().filter(|(_, node)| node.ports == [PortKind::Input]) {
        let mut changed = graph.clone();
        changed.nets.iter_mut().for_each(|net| net.ends.retain(|end| end.node != sink));
        let kept = same(graph).into_iter().filter(|(node, _)| *node != sink).collect();
        edits.push(Edit { what: format!("without node {sink}"), graph: changed, pairs: kept });
    }
    edits
}

/// The level with one more block at a place in the text, without connections.
fn with_node(graph: &Graph, new: usize, node: Node) -> (Graph, Vec<(usize, usize)>) {
    let later = |node: usize| node + usize::from(node >= new);
    let mut changed = graph.clone();
    changed.nodes.insert(new, node);
    changed.nets.iter_mut().flat_map(|net| &mut net.ends).for_each(|end| end.node = later(end.node));
    (changed, (0..graph.nodes.len()).map(|node| (node, later(node))).collect())
}

/// A block in each wire: behind the source of a signal, in each of its branches, and an element at each end of a
/// conserving connection. It is written after the block before it or, in a branch, also before the block behind it.
pub fn inserted(graph: &Graph) -> Vec<Edit> {
    let mut edits = Vec::new();
    for (net, about) in graph.nets.iter().enumerate() {
        let last = about.ends.len();
        let ends: Vec<usize> = match (about.directed, last) {
            (true, _) => (0..last).collect(),
            (false, 2) => vec![0],
            (false, _) => (0..last).collect(),
        };
        for end in ends {
            let behind = about.ends[0].node + 1;
            let places = match (about.directed, end) {
                (true, 0) => vec![behind],
                (true, _) if last == 2 => vec![about.ends[end].node],
                (true, _) => vec![behind, about.ends[end].node],
                (false, _) => vec![about.ends[end].node + 1],
            };
            for new in places {
                let (graph, pairs) = in_wire(graph, net, end, new);
                edits.push(Edit { what: format!("block {new} in net {net} at its end {end}"), graph, pairs });
            }
        }
    }
    edits
}

fn in_wire(graph: &Graph, net: usize, end: usize, new: usize) -> (Graph, Vec<(usize, usize)>) {
    let directed = graph.nets[net].directed;
    let ports =
        if directed { vec![PortKind::Input, PortKind::Output] } else { vec![PortKind::Free, PortKind::Free] };
    let (mut changed, pairs) = with_node(graph, new, small(ports));
    let (before, behind) = (End { node: new, port: 0 }, End { node: new, port: 1 });
    if end == 0 {
        let mut rest = changed.nets[net].ends.split_off(1);
        rest.insert(0, behind);
        changed.nets[net].ends.push(before);
        changed.nets.insert(net + 1, Net { ends: rest, directed });
    } else {
        let to = std::mem::replace(&mut changed.nets[net].ends[end], before);
        changed.nets.insert(net + 1, Net { ends: vec![behind, to], directed });
    }
    (changed, pairs)
}

/// Blocks that stand in a wire are taken out and the wire closed: those with one input and one output, and elements in
/// series.
pub fn taken_out(graph: &Graph) -> Vec<Edit> {
    let mut edits = Vec::new();
    for (v, node) in graph.nodes.iter().enumerate() {
        let net_at =
            |port: usize| graph.nets.iter().position(|net| net.ends.contains(&End { node: v, port }));
        let (Some(a), Some(b)) = (net_at(0), net_at(1)) else { continue };
        let signal = node.ports == [PortKind::Input, PortKind::Output];
        let in_series = node.ports == [PortKind::Free, PortKind::Free]
            && [a, b].iter().any(|net| graph.nets[*net].ends.len() == 2);
        if a == b || !(signal || in_series) {
            continue;
        }
        let (first, second) = if signal { (a, b) } else { (a.min(b), a.max(b)) };
        let mut changed = graph.clone();
        let behind: Vec<End> =
            changed.nets[second].ends.iter().copied().filter(|end| end.node != v).collect();
        let ends = &mut changed.nets[first].ends;
        let at = ends.iter().position(|end| end.node == v).unwrap_or(0);
        ends.splice(at..=at, behind);
        changed.nets.remove(second);
        changed.nodes.remove(v);
        let earlier = |node: usize| node - usize::from(node > v);
        changed.nets.iter_mut().flat_map(|net| &mut net.ends).for_each(|end| end.node = earlier(end.node));
        let pairs =
            (0..graph.nodes.len()).filter(|node| *node != v).map(|node| (node, earlier(node))).collect();
        edits.push(Edit { what: format!("wire closed in place of node {v}"), graph: changed, pairs });
    }
    edits
}

fn takes_several(node: &Node) -> bool {
    let inputs = node.ports.iter().filter(|port| **port == PortKind::Input).count();
    let several = inputs > 1 || inputs == node.ports.len() && inputs > 0;
    several && node.form == Form::Box && node.standing == Standing::Free
}

/// One input more at a node, after its others.
fn with_input(graph: &mut Graph, to: usize) -> usize {
    let ports = &mut graph.nodes[to].ports;
    let port = ports.iter().rposition(|port| *port == PortKind::Input).map_or(0, |last| last + 1);
    ports.insert(port, PortKind::Input);
    for end in graph.nets.iter_mut().flat_map(|net| &mut net.ends) {
        end.port += usize::from(end.node == to && end.port >= port);
    }
    port
}

/// From each signal two wires more to blocks that take several inputs, or to scopes.
pub fn wires(graph: &Graph) -> Vec<Edit> {
    let mut seed = 7_u64;
    let mut random = move |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n
    };
    let mut edits = Vec::new();
    for net in signals(graph) {
        let new = |v: &usize| !graph.nets[net].ends.iter().any(|end| end.node == *v);
        let targets: Vec<usize> =
            (0..graph.nodes.len()).filter(|v| takes_several(&graph.nodes[*v])).filter(new).collect();
        for _ in 0..if targets.is_empty() { 0 } else { 2 } {
            let to = targets[random(targets.len())];
            let mut changed = graph.clone();
            let port = with_input(&mut changed, to);
            changed.nets[net].ends.push(End { node: to, port });
            edits.push(Edit { what: format!("net {net} to node {to}"), graph: changed, pairs: same(graph) });
        }
    }
    edits
}

/// A source more, at each block that takes several inputs, written before it.
pub fn sources(graph: &Graph) -> Vec<Edit> {
    let mut edits = Vec::new();
    for to in (0..graph.nodes.len()).filter(|v| takes_several(&graph.nodes[*v])) {
        let (mut changed, pairs) = with_node(graph, to, small(vec![PortKind::Output]));
        let to = to + 1;
        let port = with_input(&mut changed, to);
        changed
            .nets
            .push(Net { ends: vec![End { node: to - 1, port: 0 }, End { node: to, port }], directed: true });
        edits.push(Edit { what: format!("source {} to it", to - 1), graph: changed, pairs });
    }
    edits
}
