use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Source of a temperature that a signal commands, whatever heat flow that takes.
///
/// ```ron
/// TemperatureSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Thermal", symbol = MotionSource("T"))]
pub struct TemperatureSource;

impl Component for TemperatureSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("h", Domain::Thermal, "thermal port")
            .input(Input::real("t").scalar().unit("K").doc("temperature"))
            .element(Element::VoltageSource { p: Pin::Port(0), n: Pin::Ground })
            .voltage_is(Gives::Input(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_temperature_is_the_input() {
        let mut t = [0.0];
        let part = TemperatureSource.part(&Given::nothing());
        part.write_voltages(&TemperatureSource, &Seen { u: &[310.0], ..law() }.loaded(), &mut t);
        assert_eq!(t, [310.0]);
    }
}
