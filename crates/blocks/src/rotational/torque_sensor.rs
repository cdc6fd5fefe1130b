use blocksim_block::prelude::*;

use crate::mechanics::quantities::ROTATION;

/// Couples two turning parts rigidly and measures the torque that passes from `r` to `c`.
///
/// ```ron
/// TorqueSensor
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Sensor("τ"))]
pub struct TorqueSensor;

impl Component for TorqueSensor {
    fn part(&self, _given: &Given) -> Part {
        ROTATION.load_sensor()
    }
}
