use blocksim_block::physical::{Domain, Element};
use blocksim_block::prelude::*;

/// Fixes two frames to each other: they coincide.
///
/// In a tree it does what a direct connection of the two frames does. Between two frames that joints already hold it
/// closes a loop.
///
/// ```ron
/// WeldJoint
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Multibody", symbol = Weld)]
pub struct WeldJoint;

impl Component for WeldJoint {
    fn part(&self, _given: &Given) -> Part {
        Part::new()
            .port("base", Domain::Frame, "one frame")
            .port("follower", Domain::Frame, "the other")
            .element(Element::Transform {
                base: 0,
                follower: 1,
                rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                translation: [0.0; 3],
            })
    }
}
