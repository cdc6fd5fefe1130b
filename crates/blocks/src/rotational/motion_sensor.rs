use blocksim_block::prelude::*;

use crate::mechanics::quantities::{ROTATION, show_motion};

/// Measures angle, speed and acceleration between two turning parts without loading them.
///
/// $$ w = w_r - w_c, \qquad \dot\varphi = w, \qquad a = \dot w $$
///
/// ```ron
/// MotionSensor(phi0: "30 deg")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Rotational", symbol = Sensor("φ ω"))]
pub struct MotionSensor {
    /// Angle at the start.
    #[block(unit = "rad", finite, default = 0.0)]
    pub phi0: f64,
}

impl Component for MotionSensor {
    fn part(&self, _given: &Given) -> Part {
        ROTATION.motion_sensor(self.phi0)
    }

    fn derivatives(&self, c: &Law, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }

    fn measure(&self, c: &Law, needs: Needs, y: &mut [f64]) {
        show_motion(c, needs, y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::testing::law;

    #[test]
    fn angle_speed_and_acceleration_come_when_they_are_known() {
        let sensor = MotionSensor { phi0: 0.5 };
        let c = Law { x: &[1.0], speed: &[2.0], acceleration: &[3.0], ..law() };
        let mut y = [0.0; 3];
        sensor.measure(&c, Needs::State, &mut y);
        assert_eq!(y, [1.0, 2.0, 0.0]);
        sensor.measure(&c, Needs::Motion, &mut y);
        assert_eq!(y, [1.0, 2.0, 3.0]);
    }
}
