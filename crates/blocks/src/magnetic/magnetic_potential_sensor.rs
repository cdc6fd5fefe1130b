use blocksim_block::physical::{Element, Handle, Pin};
use blocksim_block::prelude::*;

use super::poles;

/// What is looked at.
const PROBE: Handle = Handle::new("probe");

/// Measures the magnetic potential difference from `p` to `n` without leading flux.
///
/// ```ron
/// MagneticPotentialSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Magnetic", symbol = Meter("V"))]
pub struct MagneticPotentialSensor;

impl Component for MagneticPotentialSensor {
    fn part(&self, _given: &Given) -> Part {
        poles().named(PROBE, Element::VoltageProbe { p: Pin::Port(0), n: Pin::Port(1) }).reads(
            "v",
            "A",
            Reading::Voltage(PROBE),
            "magnetic potential difference from p to n",
        )
    }
}
