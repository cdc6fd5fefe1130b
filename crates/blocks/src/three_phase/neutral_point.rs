use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Star point with a pin: the sum of the three currents leaves by `n`.
///
/// ```ron
/// NeutralPoint
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Star)]
pub struct NeutralPoint;

impl Component for NeutralPoint {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().port("ac", Domain::ThreePhase, "what is joined in the star point").port(
            "n",
            Domain::Electrical,
            "star point",
        );
        let joined = |k| Element::Junction { p: Pin::Phase(0, k), n: Pin::Port(1) };
        (0..3).map(joined).fold(part, Part::element)
    }
}
