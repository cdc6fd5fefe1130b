use blocksim_block::prelude::*;

use crate::mechanics::quantities::ROTATION;

/// A part that does not turn: the frame that housings are fixed to, $w_r = 0$.
///
/// ```ron
/// RotationalReference
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Housing)]
pub struct RotationalReference;

impl Component for RotationalReference {
    fn part(&self, _given: &Given) -> Part {
        ROTATION.reference()
    }
}
