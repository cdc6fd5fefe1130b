//! Which wires run forward, which back, and which blocks stand in a feedback path.

use crate::graph::{Form, Graph, Net, Node, PortKind, Standing};

/// The direction of everything.
#[derive(Debug, Clone)]
pub(crate) struct Flow {
    /// For each net and end: the wire to this end is feedback.
    pub feedback: Vec<Vec<bool>>,
    /// For each node: inputs are right and outputs left.
    pub mirrored: Vec<bool>,
    /// For each node: it only looks at signals. Such a block stands where there is room and moves nothing else.
    pub watching: Vec<bool>,
    /// For each node: a source of one block alone that is not the first of the text.
    pub lone: Vec<bool>,
}

/// A wire to a block that is not later in the file and closes a loop is feedback; loops go through conserving
/// connections as well, both ways. A block with one input whose outputs all are feedback is mirrored.
pub(crate) fn flow(graph: &Graph) -> Flow {
    let loops = loops(graph);
    let feedback = |net: &crate::Net, end: usize| {
        let (from, to) = (net.ends[0].node, net.ends[end].node);
        net.directed && end > 0 && to <= from && loops[from] == loops[to]
    };
    let mut flow = Flow {
        feedback: graph
            .nets
            .iter()
            .map(|net| (0..net.ends.len()).map(|end| feedback(net, end)).collect())
            .collect(),
        mirrored: vec![false; graph.nodes.len()],
        watching: watching(graph),
        lone: Vec::new(),
    };
    flow.lone = (0..graph.nodes.len()).map(|v| lone_source(graph, &flow, v)).collect();
    // What is written last is the most likely to lead back.
    while let Some(node) = (0..graph.nodes.len()).rev().find(|node| turns(graph, &flow, *node)) {
        flow.mirrored[node] = true;
    }
    flow
}

/// For each net whether it leads back, to some of its ends.
pub fn feedback(graph: &Graph) -> Vec<bool> {
    flow(graph).feedback.iter().map(|ends| ends.contains(&true)).collect()
}

/// Sinks, and blocks in a wire that branches off and leads to nothing else.
fn watching(graph: &Graph) -> Vec<bool> {
    let mut watching: Vec<bool> = graph.nodes.iter().map(Node::is_sink).collect();
    let n = watching.len();
    let of_source = |v: usize| graph.nets.iter().filter(move |net| net.directed && net.ends[0].node == v);
    let leads_there = |watching: &[bool], v: usize| {
        let mut ends = of_source(v).flat_map(|net| &net.ends[1..]).peekable();
        ends.peek().is_some() && ends.all(|end| watching[end.node])
    };
    let stands_in_wire = |v: &usize| graph.nodes[*v].standing == Standing::Free && siso(graph, *v);
    while let Some(v) =
        (0..n).rev().filter(stands_in_wire).find(|v| !watching[*v] && leads_there(&watching, *v))
    {
        watching[v] = true;
    }
    // A path that is alone is the main one.
    let alone = |watching: &[bool], v: usize| {
        let feeds = |net: &&Net| net.directed && net.ends[1..].iter().any(|end| end.node == v);
        let Some(net) = graph.nets.iter().find(feeds) else { return true };
        let source = net.ends[0].node;
        let others = graph.nodes[source].ports.iter().filter(|port| **port != PortKind::Input).count();
        !watching[source]
            && others == 1
            && net.ends[1..].iter().all(|end| end.node == v || watching[end.node])
    };
    while let Some(v) = (0..n).filter(stands_in_wire).find(|v| watching[*v] && alone(&watching, *v)) {
        watching[v] = false;
    }
    watching
}

/// A source that only one other block takes from, apart from those that watch. The first of a level begins its path.
fn lone_source(graph: &Graph, flow: &Flow, v: usize) -> bool {
    let node = &graph.nodes[v];
    let nets =
        graph.nets.iter().filter(|net| net.directed && net.ends.first().is_some_and(|end| end.node == v));
    let taken = nets.flat_map(|net| &net.ends[1..]).filter(|end| !flow.watching[end.node]).count();
    node.standing == Standing::Free
        && !node.ports.is_empty()
        && node.is_source()
        && taken == 1
        && graph.nodes[..v].iter().any(Node::is_source)
}

fn siso(graph: &Graph, node: usize) -> bool {
    let ports = &graph.nodes[node].ports;
    ports.iter().filter(|port| **port == PortKind::Input).count() == 1 && !ports.contains(&PortKind::Free)
}

/// Whether a node is to be mirrored and is not yet. What only looks at its signal matters where nothing else decides.
fn turns(graph: &Graph, flow: &Flow, node: usize) -> bool {
    if flow.mirrored[node] || !siso(graph, node) || !matches!(graph.nodes[node].form, Form::Box | Form::Bar) {
        return false;
    }
    let back = |net: usize, end: usize| {
        let to = graph.nets[net].ends[end].node;
        flow.feedback[net][end] || flow.mirrored[to]
    };
    let sink = |net: usize, end: &usize| flow.watching[graph.nets[net].ends[*end].node];
    let (mut outputs, mut watched) = (0, false);
    for (n, net) in graph.nets.iter().enumerate().filter(|(_, net)| net.directed && net.ends[0].node == node)
    {
        let ends = || (1..net.ends.len()).filter(|end| !sink(n, end));
        outputs += ends().count();
        watched |= ends().count() + 1 < net.ends.len();
        if !ends().all(|end| back(n, end)) {
            return false;
        }
    }
    // The forward path must not end here: its source goes on elsewhere, or is no such block.
    outputs > 0
        && graph.nets.iter().enumerate().any(|(n, net)| {
            let feeds = net.directed && net.ends[1..].iter().any(|end| end.node == node);
            let source = net.ends.first().map_or(0, |end| end.node);
            let goes_on = || {
                let mut others =
                    (1..net.ends.len()).filter(|end| net.ends[*end].node != node && !sink(n, end));
                others.any(|end| !back(n, end)) || flow.mirrored[source]
            };
            feeds && source != node && (goes_on() || !watched && !siso(graph, source))
        })
}

/// A number for each node; nodes on a common loop share it (Tarjan's algorithm, without recursion).
fn loops(graph: &Graph) -> Vec<usize> {
    let n = graph.nodes.len();
    let mut next = vec![Vec::new(); n];
    for net in &graph.nets {
        let ends = || net.ends.iter().map(|end| end.node);
        for to in ends().skip(1) {
            let from = net.ends[0].node;
            next[from].push(to);
            if !net.directed {
                next[to].push(from);
            }
        }
    }
    let (mut index, mut low, mut group) = (vec![usize::MAX; n], vec![0; n], vec![usize::MAX; n]);
    let (mut stack, mut count) = (Vec::new(), 0);
    for start in 0..n {
        if index[start] != usize::MAX {
            continue;
        }
        let mut calls = vec![(start, 0)];
        while let Some((v, child)) = calls.pop() {
            if child == 0 {
                index[v] = count;
                low[v] = count;
                count += 1;
                stack.push(v);
            }
            if let Some(&w) = next[v].get(child) {
                calls.push((v, child + 1));
                if index[w] == usize::MAX {
                    calls.push((w, 0));
                } else if group[w] == usize::MAX {
                    low[v] = low[v].min(index[w]);
                }
                continue;
            }
            if low[v] == index[v] {
                while let Some(w) = stack.pop() {
                    group[w] = index[v];
                    if w == v {
                        break;
                    }
                }
            }
            if let Some(&(above, _)) = calls.last() {
                low[above] = low[above].min(low[v]);
            }
        }
    }
    group
}
