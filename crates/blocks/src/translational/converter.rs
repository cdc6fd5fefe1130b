//! Checks of what leads from rotation to translation.

use blocksim_block::prelude::*;

/// Length that gives the ratio; its sign is set by `direction`.
fn length(name: &'static str, value: f64) -> Result<(), ParamError> {
    positive(name, value).map_err(|error| {
        error.help("the direction of the follower is set by `direction: Same` or `Reversed`")
    })
}

pub(crate) fn radius(value: f64) -> Result<(), ParamError> {
    length("radius", value)
}

pub(crate) fn lead(value: f64) -> Result<(), ParamError> {
    length("lead", value)
}

/// The nut cannot drive the screw.
pub(crate) fn self_locking(param: &'static str, fact: String) -> ParamError {
    ParamError::new(
        param,
        format!("{fact}: the screw locks itself, and a curve of losses over the speed cannot hold the load"),
    )
    .help("write `loss: Stiction`, which holds it exactly")
}
