use blocksim_block::prelude::*;
use blocksim_multibody::Data;

use super::RobotDescription;
use super::arm::{Arm, OfAxes};

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
#[block(category = "Robotics", symbol = Arm("g(q)"))]
pub struct GravityCompensation {
    /// The robot: links with axes and bodies.
    pub robot: RobotDescription,
    /// The assembled robot; made by `load`.
    #[block(skip)]
    arm: Arm,
}

impl Block for GravityCompensation {
    fn load(&mut self, _files: &dyn Files) -> Result<(), LoadError> {
        self.arm = Arm::of(&self.robot);
        Ok(())
    }

    fn check(&self) -> Result<(), ParamError> {
        Arm::check(&self.robot)
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new()
            .input(OfAxes::Position.input(&self.robot, "q", "positions of the joints"))
            .output(OfAxes::Force.output(
                &self.robot,
                "tau",
                "torques at the joints, forces where they slide",
            )))
    }

    fn scratch(&self) -> Scratch {
        self.arm.scratch()
    }

    fn outputs(&self, _group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let (Some(robot), Some(data)) = (self.arm.robot(c), w.get::<Data>()) else { return };
        robot.gravity_torques(data, c.input(0), y);
    }
}
