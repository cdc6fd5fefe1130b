use blocksim_block::prelude::*;

use crate::mechanics::quantities::TRANSLATION;

/// Measures position, velocity and acceleration between two sliding parts without loading them.
///
/// $$ v = v_r - v_c, \qquad \dot x = v, \qquad a = \dot v $$
///
/// ```ron
/// TranslationalMotionSensor(x0: "120 mm")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = Sensor("x v"))]
pub struct TranslationalMotionSensor {
    /// Position at the start.
    #[block(unit = "m", finite, default = 0.0)]
    pub x0: f64,
}

impl Component for TranslationalMotionSensor {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.motion_sensor(self.x0)
    }

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }
}
