use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What is looked at.
const PROBE: Handle = Handle::new("probe");

/// Measures the pressure of a node, above that of the atmosphere, without taking fluid.
///
/// ```ron
/// PressureSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = Meter("p"))]
pub struct PressureSensor;

impl Component for PressureSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("a", Domain::Hydraulic, "hydraulic port")
            .named(PROBE, Element::VoltageProbe { p: Pin::Port(0), n: Pin::Ground })
            .reads("p", "Pa", Reading::Voltage(PROBE), "pressure")
    }
}
