use blocksim_block::prelude::*;

use crate::mechanics::quantities::TRANSLATION;

/// Prescribes the velocity between two sliding parts, whatever force that takes: $v_r - v_c = v$.
///
/// Parts with mass that are coupled to it need its derivative as well to be exact: connect `dv` unless the velocity is
/// constant. A warning shows where that is forgotten.
///
/// ```ron
/// IdealVelocitySource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Translational", symbol = MotionSource("v"))]
pub struct IdealVelocitySource;

impl Component for IdealVelocitySource {
    fn part(&self, _given: &Given) -> Part {
        TRANSLATION.speed_source()
    }

    fn speeds(&self, c: &Known, v: &mut [f64], dv: &mut [f64]) {
        (v[0], dv[0]) = (c.scalar(0), c.scalar(1));
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        y[0] = -c.torque[0];
    }
}
