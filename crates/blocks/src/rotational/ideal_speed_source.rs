use blocksim_block::prelude::*;

use crate::mechanics::quantities::ROTATION;

/// Prescribes the speed between two turning parts, whatever torque that takes: $w_r - w_c = w$.
///
/// Parts with inertia that are coupled to it need its derivative as well to be exact: connect `dw` unless the
/// speed is constant. A warning shows where that is forgotten.
///
/// ```ron
/// IdealSpeedSource
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = MotionSource("ω"))]
pub struct IdealSpeedSource;

impl Component for IdealSpeedSource {
    fn part(&self, _given: &Given) -> Part {
        ROTATION.speed_source()
    }

    fn speeds(&self, c: &Known, w: &mut [f64], dw: &mut [f64]) {
        w[0] = c.scalar(0);
        dw[0] = c.scalar(1);
    }

    fn measure_motion(&self, c: &Loaded, y: &mut [f64]) {
        y[0] = -c.torque[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::{Seen, law};

    #[test]
    fn speed_and_derivative_are_the_inputs() {
        let (mut w, mut dw) = ([0.0], [0.0]);
        IdealSpeedSource.speeds(&Seen { u: &[3.0, -4.0], ..law() }.loaded(), &mut w, &mut dw);
        assert_eq!((w[0], dw[0]), (3.0, -4.0));
    }
}
