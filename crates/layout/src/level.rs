//! A level that hangs together, from its skeleton to the drawing.

use crate::graph::{Graph, Layout};
use crate::heights::rows::{chains, rows};
use crate::heights::straighten::straighten;
use crate::keys::{Arranged, Drawn};
use crate::lines::draw::draw;
use crate::order::crossings::total;
use crate::order::improve::improve;
use crate::order::insert::{fit, insert, run_together};
use crate::order::lanes::{Plan, plan, settle};
use crate::order::search::order;
use crate::order::stack::stack;
use crate::structure::flow::{Flow, flow};
use crate::structure::layers::layers;
use crate::structure::sides::{Sides, sides};
use crate::structure::skeleton::{Skeleton, along, bare, skeleton};

/// Lays out nodes that hang together: first the skeleton without sinks, then with them, then everything. So what only
/// stands in a wire, and a scope, moves nothing else.
pub(crate) fn level(graph: &Graph) -> Layout {
    let full = skeleton(graph);
    let mut core = drawn(bare(&full.graph));
    let all = arranged(&full.graph, &flow(&full.graph), &core, None);
    core.skeleton = core.skeleton.of(&full, graph);
    let whole = Drawn { skeleton: full, all };
    let flow = flow(graph);
    let mut all = arranged(graph, &flow, &core, Some(&whole));
    straighten(&all.plan, &all.sides, &mut all.y);
    draw(graph, &flow, &all.plan, &all.sides, &all.y)
}

/// Arranges a skeleton without sinks.
fn drawn(skeleton: Skeleton) -> Drawn {
    let graph = &skeleton.graph;
    let flow = flow(graph);
    let layer = layers(graph, &flow, &along(graph));
    let sides = sides(graph, &flow, &layer);
    let (mut plan, mut sides) = ordered(graph, &flow, &layer, sides);
    let chains = chains(graph, &flow, &plan, &sides);
    let mut y = rows(&plan, &sides, &chains);
    improve(&mut plan, &mut sides, &mut y);
    let y = rows(&plan, &sides, &chains);
    Drawn { skeleton, all: Arranged { plan, sides, y, chains } }
}

/// A plan in its best order. It is sought without the sources of single blocks too, which are put between then: where that
/// is as good, one source more moves nothing else.
fn ordered(graph: &Graph, flow: &Flow, layer: &[usize], sides: Sides) -> (Plan, Sides) {
    let mut at_once = (plan(graph, flow, layer, &sides), sides.clone());
    order(&mut at_once.0, &mut at_once.1);
    if !flow.lone.contains(&true) {
        return at_once;
    }
    let mut sides = sides;
    let mut few = plan_without(graph, flow, layer, &sides, &flow.lone);
    order(&mut few, &mut sides);
    let mut plan = plan(graph, flow, layer, &sides);
    settle(&mut plan, &few);
    insert(&mut plan, &sides);
    plan.loose.fill(true);
    let mut y = stack(&plan);
    improve(&mut plan, &mut sides, &mut y);
    run_together(&mut plan, &sides);
    let cost = |(plan, sides): &(Plan, Sides)| total(plan, sides, &stack(plan));
    let later = (plan, sides);
    if cost(&later) < cost(&at_once) { later } else { at_once }
}

/// Arranges a level after its skeleton without sinks. Sinks stand as they do in the skeleton with sinks, or else where they
/// do best.
fn arranged(graph: &Graph, flow: &Flow, drawn: &Drawn, whole: Option<&Drawn>) -> Arranged {
    let layer = layers(graph, flow, &drawn.skeleton.along());
    let mut sides = sides(graph, flow, &layer);
    let mut core = plan_without(graph, flow, &layer, &sides, &flow.watching);
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
    let mut plan = plan(graph, flow, &layer, &sides);
    plan.kept[..graph.nodes.len()].clone_from_slice(&core.kept[..graph.nodes.len()]);
    settle(&mut plan, &core);
    match whole {
        Some(whole) => whole.insert(&mut plan, &sides),
        None => insert(&mut plan, &sides),
    }
    let mut y = rows(&plan, &sides, &chains);
    // Once more with the true heights.
    let before = plan.rows.clone();
    improve(&mut plan, &mut sides, &mut y);
    if before != plan.rows {
        y = rows(&plan, &sides, &chains);
    }
    Arranged { plan, sides, y, chains }
}

/// A plan without some of the nodes and the wires from and to them.
fn plan_without(graph: &Graph, flow: &Flow, layer: &[usize], sides: &Sides, left: &[bool]) -> Plan {
    let mut core = graph.clone();
    for net in core.nets.iter_mut().filter(|net| net.directed) {
        net.ends.retain(|end| !left[end.node]);
    }
    let mut core = plan(&core, flow, layer, sides);
    for row in &mut core.rows {
        row.retain(|unit| !unit.iter().any(|item| left.get(*item) == Some(&true)));
    }
    core
}
