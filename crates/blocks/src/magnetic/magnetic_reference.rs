use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// Magnetic potential zero. Every magnetic circuit needs one; where it is does not matter.
///
/// ```ron
/// MagneticReference
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Magnetic", symbol = Ground)]
pub struct MagneticReference;

impl Component for MagneticReference {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("p", Domain::Magnetic, "magnetic potential zero")
            .element(Element::ElectricalReference { port: 0 })
    }
}
