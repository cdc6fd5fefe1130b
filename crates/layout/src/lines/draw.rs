//! Columns and tracks, blocks and wires in their places.

use crate::graph::{End, Graph, Layout, Placed, PlacedPort, Point, Side};
use crate::lines::channels::{Run, runs};
use crate::lines::wires::Lines;
use crate::order::lanes::{Item, Plan, label_above};
use crate::structure::flow::Flow;
use crate::structure::sides::Sides;

/// Distance of two tracks.
const TRACK: f64 = 11.0;
/// Room between a block and the wires beside it.
const MARGIN: f64 = 16.0;

/// Columns and tracks, then everything in its place.
pub(crate) fn draw(graph: &Graph, flow: &Flow, plan: &Plan, sides: &Sides, y: &[f64]) -> Layout {
    let count = plan.rows.len();
    let channels: Vec<(Vec<Run>, usize)> = (0..=count).map(|c| runs(plan, sides, y, c)).collect();
    let mut column = vec![0.0_f64; count];
    for (v, node) in graph.nodes.iter().enumerate() {
        let at = plan.layer_of[v];
        column[at] = column[at].max(sides.width[v]).max(node.label_width);
    }
    // Left edges of channels and columns.
    let (mut channel_x, mut column_x, mut x) = (Vec::new(), Vec::new(), 0.0);
    for (c, (_, tracks)) in channels.iter().enumerate() {
        channel_x.push(x);
        let outer = c == 0 || c == count;
        x += match tracks {
            0 if outer => 0.0,
            0 => 2.0 * MARGIN,
            tracks => MARGIN + (*tracks as f64 - 1.0) * TRACK + MARGIN,
        };
        column_x.push(x);
        x += column.get(c).copied().unwrap_or(0.0);
    }
    let track_x = |channel: usize, track: usize| channel_x[channel] + MARGIN + track as f64 * TRACK;
    let left_of = |v: usize| {
        let at = plan.layer_of[v];
        (column_x[at] + (column[at] - sides.width[v]) / 2.0).round()
    };
    let nodes: Vec<Placed> = (0..graph.nodes.len())
        .map(|v| {
            let (x, y) = (left_of(v), y[v]);
            let (width, height) = (sides.width[v], sides.height[v]);
            let port = |port: usize| {
                let side = sides.side[v][port];
                let across = match side {
                    Side::West => 0.0,
                    Side::East => width,
                    Side::North | Side::South => width / 2.0,
                };
                PlacedPort { at: Point { x: x + across, y: y + sides.offset(v, port).round() }, side }
            };
            Placed {
                x,
                y,
                width,
                height,
                mirrored: flow.mirrored[v],
                label_above: label_above(sides, v),
                ports: (0..graph.nodes[v].ports.len()).map(port).collect(),
            }
        })
        .collect();
    let mut lines = vec![Lines::default(); graph.nets.len()];
    for (c, (runs, _)) in channels.iter().enumerate() {
        let taps = &plan.channels[c];
        for run in runs {
            let Some(track) = run.track else { continue };
            lines[run.net].upright(track_x(c, track), run.trunk.low, run.trunk.high);
            // A net in two parts has a line between them.
            if let Some(other) = runs.iter().find(|other| other.net == run.net && other.track != run.track)
                && let Some(second) = other.track
                && let Some(level) = run.trunk.right.iter().find(|at| other.trunk.left.contains(at))
            {
                lines[run.net].level(*level, track_x(c, track), track_x(c, second));
            }
        }
        for tap in taps {
            let at = plan.tap_y(sides, y, tap).round();
            let serves = |run: &&Run| {
                let places = if tap.right { &run.trunk.right } else { &run.trunk.left };
                run.net == tap.net && places.iter().any(|place| (place - at).abs() < 0.6)
            };
            let track = runs.iter().find(serves).and_then(|run| run.track);
            // A straight wire goes to the middle of the channel.
            let middle = (channel_x[c] + column_x[c]) / 2.0;
            let trunk = track.map_or(middle, |track| track_x(c, track));
            let edge = match plan.items[tap.item] {
                Item::Node(v) => nodes[v].ports[tap.port].at.x,
                Item::Lane(_) => {
                    // To the middle of its layer, or to the block that it ends at.
                    let at = plan.layer_of[tap.item];
                    hangs_from(graph, plan, sides, tap.item)
                        .map_or(column_x[at] + column[at] / 2.0, |end| nodes[end.node].ports[end.port].at.x)
                }
            };
            lines[tap.net].level(at, trunk, edge);
        }
    }
    // What hangs from its lane.
    for (n, net) in graph.nets.iter().enumerate() {
        for end in &net.ends {
            let port = nodes[end.node].ports[end.port];
            let lane = plan.lanes[n].iter().find(|(layer, _)| *layer == plan.layer_of[end.node]);
            if let (Side::North | Side::South, Some((_, lane))) = (port.side, lane) {
                lines[n].upright(port.at.x, port.at.y, y[*lane]);
            }
        }
    }
    let mut layout =
        Layout { nodes, wires: lines.into_iter().map(Lines::wire).collect(), ..Layout::default() };
    frame(graph, &mut layout);
    layout
}

/// The block that hangs from a lane, by one of its ports.
fn hangs_from(graph: &Graph, plan: &Plan, sides: &Sides, lane: usize) -> Option<End> {
    let Item::Lane(net) = plan.items[lane] else { return None };
    let here = |end: &&End| {
        plan.layer_of[end.node] == plan.layer_of[lane]
            && matches!(sides.side[end.node][end.port], Side::North | Side::South)
    };
    graph.nets[net].ends.iter().find(here).copied()
}

/// Moves everything so that it begins at (0, 0), and tells how large it is.
fn frame(graph: &Graph, layout: &mut Layout) {
    let (mut low, mut high) = (Point { x: f64::INFINITY, y: f64::INFINITY }, Point::default());
    high.x = f64::NEG_INFINITY;
    high.y = f64::NEG_INFINITY;
    let mut cover = |x: f64, y: f64| {
        low = Point { x: low.x.min(x), y: low.y.min(y) };
        high = Point { x: high.x.max(x), y: high.y.max(y) };
    };
    for (node, placed) in graph.nodes.iter().zip(&layout.nodes) {
        let beside = ((node.label_width - placed.width) / 2.0).max(0.0);
        let (above, below) =
            if placed.label_above { (node.label_height, 0.0) } else { (0.0, node.label_height) };
        cover(placed.x - beside, placed.y - above);
        cover(placed.x + placed.width + beside, placed.y + placed.height + below);
    }
    for segment in layout.wires.iter().flat_map(|wire| &wire.segments) {
        cover(segment.from.x, segment.from.y);
        cover(segment.to.x, segment.to.y);
    }
    if low.x > high.x {
        return;
    }
    let moved = |at: &mut Point| *at = Point { x: at.x - low.x, y: at.y - low.y };
    for placed in &mut layout.nodes {
        placed.x -= low.x;
        placed.y -= low.y;
        placed.ports.iter_mut().for_each(|port| moved(&mut port.at));
    }
    for wire in &mut layout.wires {
        for segment in &mut wire.segments {
            moved(&mut segment.from);
            moved(&mut segment.to);
        }
        wire.junctions.iter_mut().for_each(moved);
    }
    layout.width = high.x - low.x;
    layout.height = high.y - low.y;
}
