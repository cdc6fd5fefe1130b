//! Places of the items of a layer, one below the other as near as they may be.

use crate::order::lanes::Plan;

/// Places of all items, each layer stacked around zero.
pub(crate) fn stack(plan: &Plan) -> Vec<f64> {
    let mut y = vec![0.0; plan.items.len()];
    for row in &plan.rows {
        stack_row(plan, row, &mut y);
    }
    y
}

pub(crate) fn stack_row(plan: &Plan, row: &[Vec<usize>], y: &mut [f64]) {
    let (mut at, mut last) = (0.0, None);
    for &item in row.iter().flatten() {
        at += last.map_or(0.0, |last| plan.distance(last, item));
        y[item] = at;
        last = Some(item);
    }
    let bottom = last.map_or(0.0, |last| at + plan.extent[last].1);
    row.iter().flatten().for_each(|item| y[*item] -= bottom / 2.0);
}
