use blocksim_block::prelude::*;
use blocksim_multibody::Data;
use blocksim_robotics::robot::Robot;

use super::RobotDescription;
use super::arm::{Arm, OfArm, OfAxes};

/// Torques that a robot needs for a motion (inverse dynamics, computed torque).
///
/// $$ \tau = M(q)\,\ddot q + h(q, \dot q) $$
///
/// with gravity in $h$, by the recursive Newton-Euler algorithm. With `drives` the torques are those of the motors,
/// counted at the joints: friction of the bearings, losses of the gears, inertia and damping of rotors and gears are
/// added. Divide by the reduction for the torque on the shaft of a motor.
///
/// ```ron
/// InverseDynamics(robot: (
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
///
/// Source: R. Featherstone, Rigid Body Dynamics Algorithms, 2008, table 5.1.
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Robotics", symbol = Arm("M q̈ + h"), builds = OfArm<InverseDynamics>)]
pub struct InverseDynamics {
    /// The robot: links with axes, bodies and drives.
    pub robot: RobotDescription,
    /// Whether motors must also turn their drives.
    #[block(default = false)]
    pub drives: bool,
}

impl Arm for InverseDynamics {
    fn description(&self) -> &RobotDescription {
        &self.robot
    }

    fn ports(&self, _robot: &Robot) -> Interface {
        Interface::new()
            .input(OfAxes::Position.input(&self.robot, "q", "positions of the joints"))
            .input(OfAxes::Speed.input(&self.robot, "qd", "their speeds"))
            .input(OfAxes::Acceleration.input(&self.robot, "qdd", "their accelerations"))
            .output(OfAxes::Force.output(
                &self.robot,
                "tau",
                "torques at the joints, forces where they slide",
            ))
    }

    fn compute(&self, robot: &Robot, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(data) = w.get::<Data>() else { return };
        match self.drives {
            true => robot.motor_torques(data, c.input(0), c.input(1), c.input(2), y),
            false => robot.joint_torques(data, c.input(0), c.input(1), c.input(2), y),
        }
    }
}
