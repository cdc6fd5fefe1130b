use blocksim_block::prelude::*;

use crate::mechanics::quantities::ROTATION;

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

    fn derivatives(&self, c: &Flowing, dx: &mut [f64]) {
        dx[0] = c.speed[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angle_speed_and_acceleration_are_numbers_of_the_network() {
        let part = MotionSensor { phi0: 0.5 }.part(&Given::nothing());
        let readings = [Reading::State(0), Reading::Speed(0), Reading::Acceleration(0)];
        assert_eq!(part.readings, readings.map(Some));
        assert_eq!(part.states[0].initial, 0.5);
    }
}
