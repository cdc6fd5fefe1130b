use blocksim_block::physical::{Element, Pin};
use blocksim_block::prelude::*;

/// Measures the current from `p` to `n`; it is a wire.
///
/// ```ron
/// CurrentSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Meter("A"))]
pub struct CurrentSensor;

impl Component for CurrentSensor {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .pins()
            .measures("i", "A", Needs::Electrics, "current from p to n")
            .element(Element::CurrentProbe { p: Pin::Port(0), n: Pin::Port(1) })
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y[0] = c.current[0];
    }
}
