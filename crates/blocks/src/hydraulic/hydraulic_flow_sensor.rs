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
        ends().named(PROBE, Element::CurrentProbe { p: Pin::Port(0), n: Pin::Port(1) }).measures(
            "q",
            "m^3/s",
            Needs::Electrics,
            "volume flow from a to b",
        )
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y[0] = c.current(PROBE);
    }
}
