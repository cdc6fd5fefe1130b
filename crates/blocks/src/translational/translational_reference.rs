use blocksim_block::prelude::*;

use crate::mechanics::quantities::TRANSLATION;

/// A part that does not slide: the bed that housings and guides are fixed to, $v_r = 0$.
///
/// ```ron
/// TranslationalReference
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Housing)]
pub struct TranslationalReference;

impl Component for TranslationalReference {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.reference()
    }
}
