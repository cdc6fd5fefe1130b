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

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y[0] = c.torque[0];
    }
}
