//! What an order within the layers costs, in crossings.

use std::ops::Range;

use crate::order::lanes::{Item, Plan, Tap};
use crate::structure::sides::Sides;

/// What a unit of length costs: it decides between orders with the same crossings.
const LENGTH: f64 = 1e-3;
/// What a block below a wire that leads back costs.
const ABOVE: f64 = 0.4;
/// What two blocks cost that stand otherwise than in the file: the order of the text stays unless crossings fall.
const AGAINST_TEXT: f64 = 0.4;
/// The same as long as an order is sought: the text may be left for a while.
const RELAXED: f64 = 0.1 * AGAINST_TEXT;

/// What the order of all layers costs.
pub(crate) fn total(plan: &Plan, sides: &Sides, y: &[f64]) -> f64 {
    let channels = (0..plan.channels.len()).map(|channel| channel_cost(plan, sides, y, channel));
    channels.sum::<f64>() + (0..plan.rows.len()).map(|at| order_cost(plan, at)).sum::<f64>()
}

/// Blocks below wires that lead back, and blocks against the order of the text.
pub(crate) fn order_cost(plan: &Plan, at: usize) -> f64 {
    let (mut above, mut cost) = (0, 0.0);
    for (place, unit) in plan.rows[at].iter().enumerate() {
        let Some(block) = block_of(plan, unit) else {
            above += i32::from(unit.iter().all(|item| plan.back[*item]));
            continue;
        };
        if plan.back[block] {
            above += 1;
            continue;
        }
        cost += ABOVE * f64::from(above);
        // The order of the text holds among blocks of one sort: sources, sinks or others.
        let alike = |other: &usize| {
            plan.sink[*other] == plan.sink[block] && plan.source[*other] == plan.source[block]
        };
        let earlier = plan.rows[at][..place].iter().filter_map(|unit| block_of(plan, unit)).filter(alike);
        let price = if plan.relaxed { RELAXED } else { AGAINST_TEXT };
        cost += price * earlier.filter(|other| *other > block && !plan.back[*other]).count() as f64;
    }
    cost
}

/// The block of a unit.
pub(crate) fn block_of(plan: &Plan, unit: &[usize]) -> Option<usize> {
    unit.iter().copied().find(|item| matches!(plan.items[*item], Item::Node(_)))
}

/// A net in a channel: its trunk and its taps.
#[derive(Debug, Clone)]
pub(crate) struct Trunk {
    pub low: f64,
    pub high: f64,
    pub left: Vec<f64>,
    pub right: Vec<f64>,
}

impl Trunk {
    pub fn of(plan: &Plan, sides: &Sides, y: &[f64], taps: &[Tap]) -> Trunk {
        let mut trunk =
            Trunk { low: f64::INFINITY, high: f64::NEG_INFINITY, left: Vec::new(), right: Vec::new() };
        for tap in taps {
            trunk.add(plan.tap_y(sides, y, tap), tap.right);
        }
        trunk
    }

    pub fn add(&mut self, at: f64, right: bool) {
        self.low = self.low.min(at);
        self.high = self.high.max(at);
        if right { self.right.push(at) } else { self.left.push(at) }
    }

    /// Crossings where this trunk runs left of another.
    pub fn crossings_left_of(&self, other: &Trunk) -> usize {
        let within = |places: &[f64], trunk: &Trunk| {
            places.iter().filter(|at| trunk.low < **at && **at < trunk.high).count()
        };
        within(&self.right, other) + within(&other.left, self)
    }

    pub fn meets(&self, other: &Trunk) -> bool {
        self.low <= other.high && other.low <= self.high
    }
}

/// The same as a [`Trunk`], with its taps in a list of all: those on the left, then those on the right.
struct Span {
    low: f64,
    high: f64,
    left: Range<usize>,
    right: Range<usize>,
}

/// Crossings in a channel if every pair of trunks stands in its better order, and a little for lengths.
pub(crate) fn channel_cost(plan: &Plan, sides: &Sides, y: &[f64], channel: usize) -> f64 {
    let taps = &plan.channels[channel];
    // Called more often than all else, so it shares one list for all taps.
    let mut places: Vec<f64> = Vec::with_capacity(taps.len());
    let mut spans: Vec<Span> = Vec::with_capacity(plan.groups[channel].len());
    for group in &plan.groups[channel] {
        let start = places.len();
        let (mut low, mut high, mut middle) = (f64::INFINITY, f64::NEG_INFINITY, start);
        for tap in taps[group.clone()].iter().filter(|tap| !plan.absent[tap.item]) {
            let at = plan.tap_y(sides, y, tap);
            (low, high) = (low.min(at), high.max(at));
            places.push(at);
            middle += usize::from(!tap.right);
        }
        if places.len() == start {
            continue;
        }
        spans.push(Span { low, high, left: start..middle, right: middle..places.len() });
    }
    let within = |ends: &Range<usize>, span: &Span| {
        places[ends.clone()].iter().filter(|at| span.low < **at && **at < span.high).count()
    };
    let left_of = |a: &Span, b: &Span| within(&a.right, b) + within(&b.left, a);
    let mut cost = 0.0;
    for (i, a) in spans.iter().enumerate() {
        cost += LENGTH * (a.high - a.low);
        for b in spans[i + 1..].iter().filter(|b| a.low <= b.high && b.low <= a.high) {
            cost += left_of(a, b).min(left_of(b, a)) as f64;
        }
    }
    cost
}
