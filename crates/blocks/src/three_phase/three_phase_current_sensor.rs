use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Measures the currents of the three phases from `ac1` to `ac2`; it is three wires.
///
/// ```ron
/// ThreePhaseCurrentSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Meter("A"))]
pub struct ThreePhaseCurrentSensor;

impl Component for ThreePhaseCurrentSensor {
    fn part(&self, _given: &Given) -> Part {
        let i = Output::real("i").shape(Shape::Vector(3)).unit("A").doc("currents a, b, c from ac1 to ac2");
        let part = Part::new()
            .port("ac1", Domain::ThreePhase, "where the currents come from")
            .port("ac2", Domain::ThreePhase, "where they go to")
            .output(i, Needs::Electrics);
        let wire = |k| Element::CurrentProbe { p: Pin::Phase(0, k), n: Pin::Phase(1, k) };
        (0..3).map(wire).fold(part, Part::element)
    }

    fn measure_electrics(&self, c: &Flowing, y: &mut [f64]) {
        y.copy_from_slice(c.current);
    }
}
