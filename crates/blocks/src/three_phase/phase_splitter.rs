use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Takes the three phases apart into electrical pins, or joins three pins to a three-phase connection.
///
/// ```ron
/// PhaseSplitter
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Phases)]
pub struct PhaseSplitter;

impl Component for PhaseSplitter {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new()
            .port("ac", Domain::ThreePhase, "all phases")
            .port("a", Domain::Electrical, "phase a")
            .port("b", Domain::Electrical, "phase b")
            .port("c", Domain::Electrical, "phase c");
        let joined = |k| Element::Junction { p: Pin::Phase(0, k), n: Pin::Port(k + 1) };
        (0..3).map(joined).fold(part, Part::element)
    }
}
