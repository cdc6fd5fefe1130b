use blocksim_block::physical::{Domain, Element, Pin};
use blocksim_block::prelude::*;

/// Star point at potential zero: the sum of the three currents flows into the ground.
///
/// ```ron
/// GroundedNeutral
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Three-phase", symbol = Ground)]
pub struct GroundedNeutral;

impl Component for GroundedNeutral {
    fn part(&self, _given: &Given) -> Part {
        let part = Part::new().port("ac", Domain::ThreePhase, "what is joined in the star point");
        let joined = |k| Element::Junction { p: Pin::Phase(0, k), n: Pin::Ground };
        (0..3).map(joined).fold(part, Part::element)
    }
}
