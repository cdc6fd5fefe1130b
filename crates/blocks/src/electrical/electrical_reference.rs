use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// Ground: the node whose potential is zero. Every electrical network needs one.
///
/// ```ron
/// ElectricalReference
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical", symbol = Ground)]
pub struct ElectricalReference;

impl Component for ElectricalReference {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("p", Domain::Electrical, "the node at potential zero")
            .element(Element::ElectricalReference { port: 0 })
    }
}
