use blocksim_block::prelude::*;

use crate::mechanics::quantities::TRANSLATION;

/// Couples two sliding parts rigidly and measures the force that passes from `r` to `c`.
///
/// ```ron
/// ForceSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Sensor("F"))]
pub struct ForceSensor;

impl Component for ForceSensor {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.load_sensor()
    }
}
