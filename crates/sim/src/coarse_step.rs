//! Fixed steps that pass over what swings with time alone.

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{Instance, Schedule, Solver};

use crate::stepping::methods::{PER_PERIOD, swinging};

/// Most blocks that are named.
const NAMED: usize = 3;

/// A warning where a fixed step is longer than methods that choose their steps would make it: a source has gone through much of its
/// period between two steps, at which alone conditions are looked at and valves commutate.
pub(crate) fn coarse_step(schedule: &Schedule) -> Option<Problem> {
    let Solver::Fixed { step, .. } = schedule.settings.solver else { return None };
    let swings = swinging(schedule).map(|(block, period)| (period / PER_PERIOD, block));
    let limits = schedule.blocks.iter().filter_map(|block| Some((block.interface.max_step?, block)));
    let is_passed = |(longest, _): &(f64, &Instance)| step > longest * (1.0 + ROUNDING);
    let mut passed: Vec<(f64, &Instance)> = swings.chain(limits).filter(is_passed).collect();
    passed.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.path.cmp(&b.1.path)));
    passed.dedup_by(|a, b| a.1.path == b.1.path);
    let (longest, _) = passed.first()?;
    let names: Vec<String> =
        passed.iter().take(NAMED).map(|(_, block)| format!("`{}`", block.path)).collect();
    let more = match passed.len() - names.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let message = format!(
        "a fixed step of {step} s is too long for {}{more}, which may change and change back within it",
        names.join(", ")
    );
    Some(Problem::warning("coarse_step", message).help(format!(
        "take steps of at most {longest:.2e} s, or a method that chooses its steps, such as `Auto`"
    )))
}

/// Steps that are an eighth of a period but for rounding are none too long.
const ROUNDING: f64 = 1e-9;
