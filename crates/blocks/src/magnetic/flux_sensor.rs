use blocksim_block::physical::{Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::poles;

/// What is looked at.
const PROBE: Handle = Handle::new("probe");

/// Measures the flux from `p` to `n`; both have one magnetic potential.
///
/// ```ron
/// FluxSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Magnetic", symbol = Meter("Φ"))]
pub struct FluxSensor;

impl Component for FluxSensor {
    fn part(&self, _given: &Given) -> Part {
        poles().named(PROBE, Element::CurrentProbe { p: Pin::Port(0), n: Pin::Port(1) }).reads(
            "flux",
            "Wb",
            Reading::Current(PROBE),
            "flux from p to n",
        )
    }
}
