//! What screws have in common.

use blocksim_block::prelude::*;

/// The nut cannot drive the screw.
pub(crate) fn self_locking(param: &'static str, fact: String) -> ParamError {
    ParamError::new(
        param,
        format!("{fact}: the screw locks itself, and a curve of losses over the speed cannot hold the load"),
    )
    .help("write `loss: Stiction`, which holds it exactly")
}
