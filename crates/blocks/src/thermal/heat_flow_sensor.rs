use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What is looked at.
const PROBE: Handle = Handle::new("probe");

/// Measures the heat flow from `a` to `b`; both have one temperature.
///
/// ```ron
/// HeatFlowSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Thermal", symbol = Meter("q"))]
pub struct HeatFlowSensor;

impl Component for HeatFlowSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("a", Domain::Thermal, "thermal port that heat enters by")
            .port("b", Domain::Thermal, "thermal port that it leaves by")
            .named(PROBE, Element::CurrentProbe { p: Pin::Port(0), n: Pin::Port(1) })
            .reads("q", "W", Reading::Current(PROBE), "heat flow from a to b")
    }
}
