use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Source of a volume flow that a signal commands, whatever pressure that takes: $q$ flows in at `b` and out at `a`.
///
/// ```ron
/// HydraulicFlowSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = MotionSource("q"))]
pub struct HydraulicFlowSource;

impl Component for HydraulicFlowSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("a", Domain::Hydraulic, "outlet")
            .port("b", Domain::Hydraulic, "inlet")
            .input(Input::real("q").scalar().unit("m^3/s").doc("volume flow out of a"))
            .element(Element::CurrentSource { p: Pin::Port(1), n: Pin::Port(0) })
            .current_is(Gives::Input(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_flow_is_the_input() {
        let mut q = [0.0];
        let part = HydraulicFlowSource.part(&Given::nothing());
        part.write_currents(&HydraulicFlowSource, &Seen { u: &[-2e-4], ..law() }.loaded(), &mut q);
        assert_eq!(q, [-2e-4]);
    }
}
