use blocksim_block::prelude::*;
use blocksim_multibody::{Data, forward_kinematics, relative_jacobian};
use blocksim_robotics::robot::Robot;

use super::RobotDescription;
use super::arm::{Arm, End, OfArm, OfAxes};

/// How the tool of a robot moves with its joints: $(\omega; v) = J \dot q$.
///
/// Row 1 to 3 are the angular velocity, row 4 to 6 the velocity of the origin of the frame, all along the axes of the
/// reference frame of the robot. A joint torque $\tau = J^\top (n; f)$ balances the torque $n$ and the force $f$ that
/// the tool exerts at its origin.
///
/// ```ron
/// Jacobian(robot: (
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
#[block(category = "Robotics", symbol = Arm("J(q)"), builds = OfArm<Jacobian>)]
pub struct Jacobian {
    /// The robot: links with axes and limits, frames and tool.
    pub robot: RobotDescription,
    /// The frame: `Tool` or `Flange`.
    #[block(default = End::Tool)]
    pub end: End,
}

impl Arm for Jacobian {
    fn description(&self) -> &RobotDescription {
        &self.robot
    }

    fn ports(&self, _robot: &Robot) -> Interface {
        let joints = self.robot.links.len();
        let q = OfAxes::Position.input(&self.robot, "q", "positions of the joints");
        Interface::new()
            .input(q)
            .output(Output::real("j").shape(Shape::Matrix(6, joints)).doc("rows: angular velocity, velocity"))
    }

    fn compute(&self, robot: &Robot, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(data) = w.get::<Data>() else { return };
        forward_kinematics(robot.model(), data, c.input(0));
        relative_jacobian(robot.model(), data, &self.end.of(robot), &robot.reference(), y);
    }
}
