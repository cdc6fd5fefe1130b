//! The order within each layer, for few crossings.

use crate::order::crossings::total;
use crate::order::improve::improve;
use crate::order::insert::run_together;
use crate::order::lanes::{Plan, Rows};
use crate::order::stack::{stack, stack_row};
use crate::structure::sides::Sides;

/// By how much another beginning must be better than the order of the text.
const WORTH: f64 = 0.5;
/// From how many beginnings the order is sought; the first of them come from the text, the others are shuffled, always in
/// the same way.
const STARTS: usize = 12;
const FROM_TEXT: usize = 4;

/// Sorts the rows of a plan by the means of their neighbours, from several beginnings, and exchanges neighbours as long
/// as it helps.
pub(crate) fn order(plan: &mut Plan, sides: &mut Sides) {
    let mut best: Option<(f64, Rows, Sides)> = None;
    let begin = (plan.rows.clone(), sides.clone());
    let mut random = shuffler();
    for start in 0..STARTS {
        plan.rows.clone_from(&begin.0);
        sides.clone_from(&begin.1);
        if start >= FROM_TEXT {
            for row in &mut plan.rows {
                (1..row.len()).rev().for_each(|i| row.swap(i, random(i + 1)));
            }
        }
        // Some leave the text for a while.
        plan.relaxed = start >= FROM_TEXT && start % 2 == 0;
        let (first, start) = (start == 0, start % FROM_TEXT);
        let mut y = stack(plan);
        for sweep in 0..3 * usize::from(start > 0) {
            sort_by_means(plan, sides, &mut y, (sweep + start) % 2 == 0);
        }
        improve(plan, sides, &mut y);
        if start == 3 {
            sort_by_means(plan, sides, &mut y, true);
            improve(plan, sides, &mut y);
        }
        if std::mem::replace(&mut plan.relaxed, false) {
            improve(plan, sides, &mut y);
        }
        let cost = total(plan, sides, &y);
        // The first beginning is the text.
        let cost = if first { cost - WORTH } else { cost };
        if best.as_ref().is_none_or(|(least, ..)| cost < least - 1e-9) {
            best = Some((cost, plan.rows.clone(), sides.clone()));
        }
    }
    if let Some((_, rows, best)) = best {
        plan.rows = rows;
        *sides = best;
    }
    run_together(plan, sides);
}

/// Numbers below a given one that look like chance and are always the same.
fn shuffler() -> impl FnMut(usize) -> usize {
    let mut seed = 1_u64;
    move |n| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n
    }
}

/// Sorts every layer by the mean place of what its units are connected to on one side.
fn sort_by_means(plan: &mut Plan, sides: &Sides, y: &mut [f64], to_the_right: bool) {
    let count = plan.rows.len();
    for step in 0..count {
        let at = if to_the_right { step } else { count - 1 - step };
        let channel = if to_the_right { at } else { at + 1 };
        let mut sum = vec![(0.0, 0.0); plan.items.len()];
        for group in &plan.groups[channel] {
            let taps = &plan.channels[channel][group.clone()];
            for mine in taps.iter().filter(|tap| tap.right == to_the_right) {
                for other in taps.iter().filter(|tap| tap.right != to_the_right) {
                    let shift = plan.tap_y(sides, y, mine) - y[mine.item];
                    sum[mine.item].0 += plan.tap_y(sides, y, other) - shift;
                    sum[mine.item].1 += 1.0;
                }
            }
        }
        let mut row = std::mem::take(&mut plan.rows[at]);
        let key = |unit: &Vec<usize>| {
            let (total, count) =
                unit.iter().fold((0.0, 0.0), |acc, item| (acc.0 + sum[*item].0, acc.1 + sum[*item].1));
            if count > 0.0 { total / count } else { y[unit[0]] }
        };
        row.sort_by(|a, b| key(a).total_cmp(&key(b)));
        stack_row(plan, &row, y);
        plan.rows[at] = row;
    }
}
