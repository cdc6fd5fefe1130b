//! The order of evaluation, and where every value lies.

mod clock;
mod layout;
mod loops;
mod order;
mod when;

use blocksim_block::schedule::{Schedule, Settings};

use crate::flatten::Flat;
use crate::infer::Typed;
use crate::problems::Problems;
use clock::clock;
use layout::lay_out;
use order::Order;

/// Sorts the output groups and lays out all values.
pub(crate) fn sort(
    title: String,
    flat: &Flat,
    typed: &Typed,
    settings: Settings,
    problems: &mut Problems,
) -> Option<Schedule> {
    let order = Order::new(flat, typed);
    let sorted = match order.topological() {
        Ok(sorted) => sorted,
        Err(loops) => {
            loops.into_iter().for_each(|problem| problems.push(problem));
            return None;
        }
    };
    let clock = clock(flat, typed, problems);
    if problems.any_error() {
        return None;
    }
    Some(lay_out(title, &order, settings, &sorted, clock))
}

/// The longest time that a block has something to show, for `stop_time: Auto`.
pub(crate) fn end_time(flat: &Flat) -> Option<f64> {
    flat.blocks.iter().filter_map(|block| block.block.end_time()).max_by(f64::total_cmp)
}
