use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What is looked at.
const PROBE: Handle = Handle::new("probe");

/// Measures the temperature of a node, in K, without taking heat.
///
/// ```ron
/// TemperatureSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Thermal", symbol = Meter("T"))]
pub struct TemperatureSensor;

impl Component for TemperatureSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("h", Domain::Thermal, "thermal port")
            .named(PROBE, Element::VoltageProbe { p: Pin::Port(0), n: Pin::Ground })
            .reads("t", "K", Reading::Voltage(PROBE), "temperature")
    }
}
