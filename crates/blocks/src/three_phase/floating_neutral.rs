use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Star point that is connected to nothing else: the three currents add up to zero, and the potential of the point
/// follows.
///
/// ```ron
/// FloatingNeutral
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Star)]
pub struct FloatingNeutral;

impl Component for FloatingNeutral {
    fn part(&self, _given: &Given) -> Part {
        let joined = |k| Element::Junction { p: Pin::Phase(0, k), n: Pin::Phase(0, k + 1) };
        Part::new()
            .port("ac", Domain::ThreePhase, "what is joined in the star point")
            .element(joined(0))
            .element(joined(1))
    }
}
