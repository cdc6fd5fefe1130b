//! Wires that run past layers on as few levels as they may.
//!
//! Where a wire has to change its height somewhere, the least length leaves open where, and it may go down in steps. Here
//! stretches of a wire are brought to the height of what is before or behind them, where there is room.

use crate::order::crossings::channel_cost;
use crate::order::lanes::{Item, Plan};
use crate::structure::sides::Sides;

/// What a step costs, in crossings.
const STEP: f64 = 0.3;
const ROUNDS: usize = 6;

/// Moves lanes within their rooms, in the given order, for fewer steps.
pub(crate) fn straighten(plan: &Plan, sides: &Sides, y: &mut [f64]) {
    let rooms = Rooms::of(plan);
    for _ in 0..ROUNDS {
        let mut better = false;
        for net in 0..plan.lanes.len() {
            let mut lanes = plan.lanes[net].clone();
            lanes.sort_unstable();
            let mut first = 0;
            while first < lanes.len() {
                let mut last = first + 1;
                while last < lanes.len()
                    && lanes[last].0 == lanes[last - 1].0 + 1
                    && y[lanes[last].1] == y[lanes[first].1]
                {
                    last += 1;
                }
                better |= level(plan, sides, &rooms, y, net, &lanes[first..last]);
                first = last;
            }
        }
        if !better {
            break;
        }
    }
}

/// What stands above and below each item.
struct Rooms {
    above: Vec<Option<usize>>,
    below: Vec<Option<usize>>,
}

impl Rooms {
    fn of(plan: &Plan) -> Rooms {
        let none = vec![None; plan.items.len()];
        let mut rooms = Rooms { above: none.clone(), below: none };
        for row in &plan.rows {
            let items: Vec<usize> = row.iter().flatten().copied().collect();
            for pair in items.windows(2) {
                rooms.below[pair[0]] = Some(pair[1]);
                rooms.above[pair[1]] = Some(pair[0]);
            }
        }
        rooms
    }

    fn hold(&self, plan: &Plan, y: &[f64], item: usize, at: f64) -> bool {
        self.above[item].is_none_or(|above| y[above] + plan.distance(above, item) <= at)
            && self.below[item].is_none_or(|below| at + plan.distance(item, below) <= y[below])
    }
}

/// Brings a level stretch of a net to a better height, if there is one.
fn level(
    plan: &Plan,
    sides: &Sides,
    rooms: &Rooms,
    y: &mut [f64],
    net: usize,
    stretch: &[(usize, usize)],
) -> bool {
    let (from, to) = (stretch[0].0, stretch[stretch.len() - 1].0 + 1);
    let group = |channel: usize| {
        let groups = plan.groups[channel].iter().map(|group| &plan.channels[channel][group.clone()]);
        groups.into_iter().find(|taps| taps[0].net == net).unwrap_or(&[])
    };
    let cost = |y: &[f64]| {
        let steps = |channel: usize| {
            let mut levels: Vec<f64> =
                group(channel).iter().map(|tap| plan.tap_y(sides, y, tap).round()).collect();
            levels.sort_by(f64::total_cmp);
            levels.dedup();
            levels.len().saturating_sub(1) as f64
        };
        (from..=to).map(|channel| channel_cost(plan, sides, y, channel) + STEP * steps(channel)).sum::<f64>()
    };
    let was = y[stretch[0].1];
    let mut best = (cost(y) - 1e-9, was);
    let mut wishes: Vec<f64> = [from, to]
        .into_iter()
        .flat_map(group)
        .filter(|tap| !stretch.iter().any(|(_, lane)| *lane == tap.item))
        .map(|tap| match plan.items[tap.item] {
            Item::Node(_) => plan.tap_y(sides, y, tap).round(),
            Item::Lane(_) => y[tap.item],
        })
        .collect();
    wishes.retain(|wish| stretch.iter().all(|(_, lane)| rooms.hold(plan, y, *lane, *wish)));
    for wish in wishes {
        stretch.iter().for_each(|(_, lane)| y[*lane] = wish);
        let cost = cost(y);
        if cost < best.0 {
            best = (cost, wish);
        }
    }
    stretch.iter().for_each(|(_, lane)| y[*lane] = best.1);
    best.1 != was
}
