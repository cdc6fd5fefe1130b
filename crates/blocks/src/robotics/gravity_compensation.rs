use blocksim_block::prelude::*;
use blocksim_multibody::Data;
use blocksim_robotics::robot::Robot;

use super::RobotDescription;
use super::arm::{Arm, OfArm, OfAxes};

/// Torques that hold a robot at rest against gravity: $\tau = g(q)$.
///
/// ```ron
/// GravityCompensation(robot: (
///     links: [
///         (axis: [0, 1, 0], limits: (lower: "-90 deg", upper: "90 deg", speed: "2 rad/s", acceleration: "9 rad/s^2"),
///          bodies: [(mass: "3 kg", com: [0, 0, "0.25 m"], moi: ["0.06 kg*m^2", "0.06 kg*m^2", "0.003 kg*m^2"])]),
///         (origin: (translation: [0, 0, "0.5 m"]), axis: [0, 1, 0],
///          limits: (lower: "-150 deg", upper: "150 deg", speed: "2 rad/s", acceleration: "9 rad/s^2"),
///          bodies: [(mass: "2 kg", com: [0, 0, "0.2 m"], moi: ["0.03 kg*m^2", "0.03 kg*m^2", "0.002 kg*m^2"])]),
///     ],
///     flange: (translation: [0, 0, "0.4 m"]),
/// ))
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Robotics", symbol = Arm("g(q)"), builds = OfArm<GravityCompensation>)]
pub struct GravityCompensation {
    /// The robot: links with axes and bodies.
    pub robot: RobotDescription,
}

impl Arm for GravityCompensation {
    fn description(&self) -> &RobotDescription {
        &self.robot
    }

    fn ports(&self, _robot: &Robot) -> Interface {
        Interface::new().input(OfAxes::Position.input(&self.robot, "q", "positions of the joints")).output(
            OfAxes::Force.output(&self.robot, "tau", "torques at the joints, forces where they slide"),
        )
    }

    fn compute(&self, robot: &Robot, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(data) = w.get::<Data>() else { return };
        robot.gravity_torques(data, c.input(0), y);
    }
}
