use blocksim_block::physical::{Element, Handle, Pin};
use blocksim_block::prelude::*;

/// Measures the current from `p` to `n`; it is a wire.
///
/// ```ron
/// CurrentSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Meter("A"))]
pub struct CurrentSensor;

const PROBE: Handle = Handle::new("probe");

impl Component for CurrentSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .reads("i", "A", Reading::Current(PROBE), "current from p to n")
            .named(PROBE, Element::CurrentProbe { p: Pin::Port(0), n: Pin::Port(1) })
    }
}
