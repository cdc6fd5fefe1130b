use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Measures the voltage from `p` to `n` without drawing current.
///
/// ```ron
/// VoltageSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Meter("V"))]
pub struct VoltageSensor;

impl Component for VoltageSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .measures("v", "V", Needs::Electrics, "voltage from p to n")
            .element(Element::VoltageProbe { p: Pin::Port(0), n: Pin::Port(1) })
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y[0] = c.voltage[0];
    }
}
