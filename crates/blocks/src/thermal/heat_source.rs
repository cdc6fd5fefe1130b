use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Source of a heat flow that a signal commands: $q$ flows into what is connected; below zero it takes heat away.
///
/// ```ron
/// HeatSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Thermal", symbol = MotionSource("q"))]
pub struct HeatSource;

impl Component for HeatSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("h", Domain::Thermal, "thermal port")
            .input(Input::real("q").scalar().unit("W").doc("heat flow out of the port"))
            .element(Element::CurrentSource { p: Pin::Ground, n: Pin::Port(0) })
            .current_is(Gives::Input(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_heat_is_the_input() {
        let mut q = [0.0];
        let part = HeatSource.part(&Given::nothing());
        part.write_currents(&HeatSource, &Seen { u: &[-5.0], ..law() }.loaded(), &mut q);
        assert_eq!(q, [-5.0]);
    }
}
