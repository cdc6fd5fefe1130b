//! What stands in the layers and what ends in the channels between them.
//!
//! A net that runs past a layer has a lane there, which takes part in the order of the layer like a block. So no wire
//! runs through a block. A wire that enters a block from above or below does so from a lane next to it.

use std::ops::Range;

use crate::graph::{Graph, Node, Side};
use crate::structure::flow::Flow;
use crate::structure::sides::{Sides, position};

/// What has a place in the order of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Item {
    /// A block.
    Node(usize),
    /// A net that runs past.
    Lane(usize),
}

/// Where a net touches the edge of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Tap {
    pub net: usize,
    pub item: usize,
    /// The port, if the item is a block.
    pub port: usize,
    /// On the right edge of the channel.
    pub right: bool,
}

/// Layers of units of items.
pub(crate) type Rows = Vec<Vec<Vec<usize>>>;

/// All items and taps.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub items: Vec<Item>,
    pub layer_of: Vec<usize>,
    /// The lane leads back to an earlier block.
    pub back: Vec<bool>,
    /// Height above and below the upper edge of an item.
    pub extent: Vec<(f64, f64)>,
    /// Layers of units of items. A unit is a block with the lanes that it hangs from, or a lane.
    pub rows: Rows,
    /// Taps of each channel, by net.
    pub channels: Vec<Vec<Tap>>,
    /// The taps of each net in a channel, as a range of them.
    pub groups: Vec<Vec<Range<usize>>>,
    /// The lane of a net in a layer.
    pub lanes: Vec<Vec<(usize, usize)>>,
    /// The block is a source, or only watches.
    pub source: Vec<bool>,
    pub sink: Vec<bool>,
    /// The block has a name beside it.
    pub named: Vec<bool>,
    /// Items that may still change places with others.
    pub loose: Vec<bool>,
    /// Blocks that keep their order among each other.
    pub kept: Vec<bool>,
    /// Items that have no place yet.
    pub absent: Vec<bool>,
    /// The order of the text counts little for now.
    pub relaxed: bool,
}

impl Plan {
    /// Place of a tap, given those of the items.
    pub fn tap_y(&self, sides: &Sides, y: &[f64], tap: &Tap) -> f64 {
        match self.items[tap.item] {
            Item::Node(node) => y[tap.item] + sides.offset(node, tap.port),
            Item::Lane(_) => y[tap.item],
        }
    }

    /// Least distance between the upper edges of two items, the second below the first.
    pub fn distance(&self, above: usize, below: usize) -> f64 {
        let gap = match (self.items[above], self.items[below]) {
            // Where no name stands between them.
            (Item::Node(_), Item::Node(_)) if !self.named[above] && !self.named[below] => 18.0,
            (Item::Node(_), Item::Node(_)) => 22.0,
            (Item::Lane(_), Item::Lane(_)) => 12.0,
            _ => 12.0,
        };
        (self.extent[above].1 + gap + self.extent[below].0).ceil()
    }
}

/// Whether the name of a node stands above it.
pub(crate) fn label_above(sides: &Sides, node: usize) -> bool {
    sides.side[node].contains(&Side::South)
}

pub(crate) fn plan(graph: &Graph, flow: &Flow, layer: &[usize], sides: &Sides) -> Plan {
    let count = layer.iter().max().map_or(0, |last| last + 1);
    let mut plan = Plan {
        items: (0..graph.nodes.len()).map(Item::Node).collect(),
        layer_of: layer.to_vec(),
        back: flow.mirrored.clone(),
        extent: (0..graph.nodes.len()).map(|node| extent(graph, sides, node)).collect(),
        rows: vec![Vec::new(); count],
        channels: vec![Vec::new(); count + 1],
        groups: Vec::new(),
        lanes: vec![Vec::new(); graph.nets.len()],
        source: graph.nodes.iter().map(Node::is_source).collect(),
        sink: flow.watching.clone(),
        named: graph.nodes.iter().map(|node| node.label_height > 0.0).collect(),
        loose: Vec::new(),
        kept: Vec::new(),
        absent: Vec::new(),
        relaxed: false,
    };
    for (n, net) in graph.nets.iter().enumerate().filter(|(_, net)| net.ends.len() > 1) {
        let places = || net.ends.iter().map(|end| position(layer[end.node], sides.side[end.node][end.port]));
        let (Some(least), Some(most)) = (places().min(), places().max()) else { continue };
        for end in &net.ends {
            let at = layer[end.node];
            let tap = Tap { net: n, item: end.node, port: end.port, right: true };
            match sides.side[end.node][end.port] {
                Side::West => plan.channels[at].push(tap),
                Side::East => plan.channels[at + 1].push(Tap { right: false, ..tap }),
                Side::North | Side::South => {}
            }
        }
        let source = places().next().unwrap_or(0);
        for at in (0..count).filter(|at| (least..=most).contains(&(2 * at + 1))) {
            let item = plan.items.len();
            plan.items.push(Item::Lane(n));
            plan.layer_of.push(at);
            let mirrored = net.ends.first().is_some_and(|end| flow.mirrored[end.node]);
            plan.back.push(net.directed && (mirrored || 2 * at + 1 < source));
            plan.extent.push((0.0, 0.0));
            plan.lanes[n].push((at, item));
            let tap = Tap { net: n, item, port: 0, right: true };
            if least < 2 * at + 1 {
                plan.channels[at].push(tap);
            }
            if most > 2 * at + 1 {
                plan.channels[at + 1].push(Tap { right: false, ..tap });
            }
        }
    }
    plan.channels
        .iter_mut()
        .for_each(|taps| taps.sort_by_key(|tap| (tap.net, tap.right, tap.item, tap.port)));
    plan.groups = plan.channels.iter().map(|taps| groups(taps)).collect();
    units(graph, sides, &mut plan);
    plan.loose = vec![true; plan.items.len()];
    plan.kept = vec![false; plan.items.len()];
    plan.absent = vec![false; plan.items.len()];
    plan
}

/// Takes over the order of a plan without sinks; only sinks and their lanes stay loose, at the end of their rows.
pub(crate) fn settle(plan: &mut Plan, core: &Plan) {
    let lane_in_core = |net: usize, at: usize| {
        let lane = core.lanes[net].iter().find(|(layer, _)| *layer == at);
        lane.map(|(_, lane)| *lane)
    };
    for at in 0..plan.rows.len() {
        let settled: Vec<usize> = core.rows[at].iter().flatten().copied().collect();
        let place = |item: usize| {
            let known = match plan.items[item] {
                Item::Node(node) => Some(node),
                Item::Lane(net) => lane_in_core(net, at),
            };
            known.and_then(|known| settled.iter().position(|item| *item == known))
        };
        let mut row: Vec<(usize, Vec<usize>)> = Vec::new();
        for unit in std::mem::take(&mut plan.rows[at]) {
            let first = unit.iter().find_map(|item| place(*item));
            unit.iter().for_each(|item| plan.loose[*item] = first.is_none());
            row.push((first.unwrap_or(usize::MAX), unit));
        }
        row.sort_by_key(|(place, _)| *place);
        plan.rows[at] = row.into_iter().map(|(_, unit)| unit).collect();
    }
}

fn extent(graph: &Graph, sides: &Sides, node: usize) -> (f64, f64) {
    let (label, height) = (graph.nodes[node].label_height, sides.height[node]);
    if label_above(sides, node) { (label, height) } else { (0.0, height + label) }
}

fn groups(taps: &[Tap]) -> Vec<Range<usize>> {
    let mut groups: Vec<Range<usize>> = Vec::new();
    for (i, tap) in taps.iter().enumerate() {
        match groups.last_mut() {
            Some(last) if taps[last.start].net == tap.net => last.end = i + 1,
            _ => groups.push(i..i + 1),
        }
    }
    groups
}

/// Blocks in the order of the file with their own lanes, then all other lanes; what leads back comes last.
fn units(graph: &Graph, sides: &Sides, plan: &mut Plan) {
    let mut bound = vec![false; plan.items.len()];
    for node in 0..graph.nodes.len() {
        let at = plan.layer_of[node];
        let mut lanes = |side: Side| -> Vec<usize> {
            let mut found = Vec::new();
            for (n, net) in graph.nets.iter().enumerate() {
                let hangs = net.ends.iter().any(|end| end.node == node && sides.side[node][end.port] == side);
                let lane = plan.lanes[n].iter().find(|(layer, _)| *layer == at);
                if let Some((_, lane)) = lane.filter(|(_, lane)| hangs && !bound[*lane]) {
                    bound[*lane] = true;
                    found.push(*lane);
                }
            }
            found
        };
        let mut unit = lanes(Side::North);
        unit.push(node);
        unit.extend(lanes(Side::South));
        plan.rows[at].push(unit);
    }
    for lane in (graph.nodes.len()..plan.items.len()).filter(|lane| !bound[*lane]) {
        plan.rows[plan.layer_of[lane]].push(vec![lane]);
    }
    let key = |unit: &Vec<usize>| {
        let leads_back = unit.iter().all(|item| plan.back[*item]);
        let first = match plan.items[unit[0]] {
            Item::Lane(net) if unit.len() == 1 => graph.nets[net].ends[0].node,
            _ => unit.iter().copied().find(|item| *item < graph.nodes.len()).unwrap_or(0),
        };
        (leads_back, first)
    };
    plan.rows.iter_mut().for_each(|row| row.sort_by_key(key));
}
