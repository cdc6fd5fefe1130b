use blocksim_block::physical::{Element, Handle, Pin};
use blocksim_block::prelude::*;

/// Measures the voltage from `p` to `n` without drawing current.
///
/// ```ron
/// VoltageSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Meter("V"))]
pub struct VoltageSensor;

const PROBE: Handle = Handle::new("probe");

impl Component for VoltageSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .reads("v", "V", Reading::Voltage(PROBE), "voltage from p to n")
            .named(PROBE, Element::VoltageProbe { p: Pin::Port(0), n: Pin::Port(1) })
    }
}
