//! The place of every wire between two layers.

use crate::order::crossings::Trunk;
use crate::order::lanes::Plan;
use crate::structure::sides::Sides;

/// Two wires nearer than this look like one.
const NEAR: f64 = 5.0;
/// Room between two trunks that share a track.
const APART: f64 = 9.0;

/// A part of a net in a channel.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub net: usize,
    pub trunk: Trunk,
    /// Track from the left; none for a straight wire.
    pub track: Option<usize>,
}

/// The runs of a channel, and how many tracks they take.
pub(crate) fn runs(plan: &Plan, sides: &Sides, y: &[f64], channel: usize) -> (Vec<Run>, usize) {
    let taps = &plan.channels[channel];
    let mut runs: Vec<Run> = plan.groups[channel]
        .iter()
        .map(|group| {
            let trunk = Trunk::of(plan, sides, y, &taps[group.clone()]);
            Run { net: taps[group.start].net, trunk, track: None }
        })
        .collect();
    loop {
        let order = tracks_in_order(&runs);
        match conflict(&runs, &order) {
            Some(run) if runs.len() < 4 * plan.groups[channel].len() => split(&mut runs, run),
            _ => {
                let count = assign(&mut runs, &order);
                return (runs, count);
            }
        }
    }
}

/// What it costs that `a` runs left of `b`.
fn cost(a: &Trunk, b: &Trunk) -> f64 {
    if !a.meets(b) && !touches(a, b) {
        return 0.0;
    }
    let mut cost = a.crossings_left_of(b) as f64;
    // The tap of the left one to the right and that of the right one to the left would lie over each other.
    for mine in &a.right {
        for other in &b.left {
            let gap = (mine - other).abs();
            cost += if gap < 1.0 {
                1000.0
            } else if gap < NEAR {
                3.0
            } else {
                0.0
            };
        }
    }
    cost
}

/// Two parts of one net may meet as they like.
fn between(a: &Run, b: &Run) -> f64 {
    if a.net == b.net { 0.0 } else { cost(&a.trunk, &b.trunk) }
}

fn touches(a: &Trunk, b: &Trunk) -> bool {
    a.low <= b.high + NEAR && b.low <= a.high + NEAR
}

/// Trunks from left to right, from several beginnings the one that costs least.
fn tracks_in_order(runs: &[Run]) -> Vec<usize> {
    let begin: Vec<usize> = (0..runs.len()).filter(|i| runs[*i].trunk.high > runs[*i].trunk.low).collect();
    let price: Vec<Vec<f64>> = runs.iter().map(|a| runs.iter().map(|b| between(a, b)).collect()).collect();
    let sorted = |key: fn(&Trunk) -> f64| {
        let mut order = begin.clone();
        order.sort_by(|a, b| key(&runs[*a].trunk).total_cmp(&key(&runs[*b].trunk)));
        order
    };
    let starts = [
        begin.clone(),
        begin.iter().rev().copied().collect(),
        sorted(|trunk| trunk.low),
        sorted(|trunk| -trunk.low),
        sorted(|trunk| trunk.high),
        sorted(|trunk| -trunk.high),
    ];
    let mut best: Option<(f64, Vec<usize>)> = None;
    for mut order in starts {
        let cost = exchange_tracks(&mut order, &price);
        if best.as_ref().is_none_or(|(least, _)| cost < least - 1e-9) {
            best = Some((cost, order));
        }
    }
    best.map_or(begin, |(_, order)| order)
}

/// Brings each trunk to its best place as long as that helps; returns what the order costs.
fn exchange_tracks(order: &mut Vec<usize>, price: &[Vec<f64>]) -> f64 {
    let n = order.len();
    for _ in 0..n + 1 {
        let mut better = false;
        for from in 0..n {
            // The best new place of one trunk, all others kept.
            let one = order[from];
            let (mut sum, mut best, mut place) = (0.0, -1e-9, from);
            for to in (0..from).rev() {
                sum += price[one][order[to]] - price[order[to]][one];
                if sum < best {
                    (best, place) = (sum, to);
                }
            }
            sum = 0.0;
            for (to, other) in order.iter().enumerate().skip(from + 1) {
                sum += price[*other][one] - price[one][*other];
                if sum < best {
                    (best, place) = (sum, to);
                }
            }
            if place != from {
                order.remove(from);
                order.insert(place, one);
                better = true;
            }
        }
        if !better {
            break;
        }
    }
    let pairs = order.iter().enumerate().flat_map(|(i, a)| order[i + 1..].iter().map(move |b| (*a, *b)));
    pairs.map(|(a, b)| price[a][b]).sum()
}

/// A run that would lie over another in this order.
fn conflict(runs: &[Run], order: &[usize]) -> Option<usize> {
    order.iter().enumerate().find_map(|(i, a)| {
        order[i + 1..].iter().find(|b| between(&runs[*a], &runs[**b]) >= 1000.0).map(|_| *a)
    })
}

/// Makes two runs of one, joined by a line at a height where nothing else is.
fn split(runs: &mut Vec<Run>, run: usize) {
    let taken: Vec<f64> =
        runs.iter().flat_map(|run| run.trunk.left.iter().chain(&run.trunk.right)).copied().collect();
    let middle = (runs[run].trunk.low + runs[run].trunk.high) / 2.0;
    let free = (0..4000)
        .map(|step| middle + f64::from(if step % 2 == 0 { step / 2 } else { -(step + 1) / 2 }))
        .find(|at| taken.iter().all(|tap| (tap - at).abs() >= NEAR))
        .unwrap_or(middle);
    let whole = runs[run].clone();
    let empty = || Trunk { low: f64::INFINITY, high: f64::NEG_INFINITY, left: Vec::new(), right: Vec::new() };
    let (mut first, mut second) = (empty(), empty());
    whole.trunk.left.iter().for_each(|at| first.add(*at, false));
    first.add(free, true);
    second.add(free, false);
    whole.trunk.right.iter().for_each(|at| second.add(*at, true));
    runs[run].trunk = first;
    runs.push(Run { trunk: second, ..whole });
}

/// Gives every trunk the leftmost track that the order allows.
fn assign(runs: &mut [Run], order: &[usize]) -> usize {
    let mut count = 0;
    for (i, &run) in order.iter().enumerate() {
        let mine = runs[run].trunk.clone();
        let before = order[..i].iter().filter(|other| {
            let other = &runs[**other].trunk;
            mine.low < other.high + APART && other.low < mine.high + APART || cost(&mine, other) > 0.0
        });
        let track = before.filter_map(|other| runs[*other].track).map(|track| track + 1).max().unwrap_or(0);
        runs[run].track = Some(track);
        count = count.max(track + 1);
    }
    count
}
