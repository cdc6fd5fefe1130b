use blocksim_block::physical::{Domain, Element, Handle, Pin};
use blocksim_block::prelude::*;

/// What is given.
const GIVEN: Handle = Handle::new("given");

/// Source of a pressure that a signal commands, whatever flow that takes: $p_a - p_b = p$.
///
/// ```ron
/// HydraulicPressureSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Hydraulic", symbol = MotionSource("p"))]
pub struct HydraulicPressureSource;

impl Component for HydraulicPressureSource {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("a", Domain::Hydraulic, "outlet")
            .port("b", Domain::Hydraulic, "inlet")
            .input(Input::real("p").scalar().unit("Pa").doc("pressure at a above that at b"))
            .named(GIVEN, Element::VoltageSource { p: Pin::Port(0), n: Pin::Port(1) })
            .voltage_is(Gives::Input(0))
            .measures("q", "m^3/s", Needs::Electrics, "volume flow out of a")
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y[0] = -c.current(GIVEN);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn the_pressure_is_the_input() {
        let mut p = [0.0];
        let part = HydraulicPressureSource.part(&Given::nothing());
        part.write_voltages(&HydraulicPressureSource, &Seen { u: &[3e6], ..law() }.loaded(), &mut p);
        assert_eq!(p, [3e6]);
    }
}
