use blocksim_block::physical::{Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::ends;

/// What is looked at.
const PROBE: Handle = Handle::new("probe");

/// Measures the volume flow from `a` to `b`; both have one pressure.
///
/// ```ron
/// HydraulicFlowSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Meter("q"))]
pub struct HydraulicFlowSensor;

impl Component for HydraulicFlowSensor {
    fn part(&self, _given: &Given) -> Part {
        ends().named(PROBE, Element::CurrentProbe { p: Pin::Port(0), n: Pin::Port(1) }).reads(
            "q",
            "m^3/s",
            Reading::Current(PROBE),
            "volume flow from a to b",
        )
    }
}
