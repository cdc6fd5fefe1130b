use blocksim_block::prelude::*;
use blocksim_multibody::{Data, Frame};
use blocksim_robotics::robot::Robot;

use super::RobotDescription;
use super::arm::{Arm, End, OfArm, OfAxes};
use super::pose::{Pose, pose_outputs};

/// Where the tool of a robot is at given joint positions, in the reference frame of the robot.
///
/// The orientation comes three times: as Euler angles about z, then the new y, then the new x, as quaternion with the
/// real part first (not negative), and as rotation matrix $R = R_z(\alpha) R_y(\beta) R_x(\gamma)$, whose columns are the
/// axes of the tool. Euler angles jump where $\beta = \pm 90°$.
///
/// ```ron
/// ForwardKinematics(robot: (
///     links: [
///         (axis: [0, 1, 0], limits: (lower: "-90 deg", upper: "90 deg", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///         (origin: (translation: [0, 0, "0.5 m"]), axis: [0, 1, 0],
///          limits: (lower: "-150 deg", upper: "150 deg", speed: "2 rad/s", acceleration: "9 rad/s^2")),
///     ],
///     flange: (translation: [0, 0, "0.4 m"]),
/// ))
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Robotics", symbol = Arm("T(q)"), builds = OfArm<ForwardKinematics>)]
pub struct ForwardKinematics {
    /// The robot: links with axes and limits, frames and tool.
    pub robot: RobotDescription,
    /// The frame: `Tool` or `Flange`.
    #[block(default = End::Tool)]
    pub end: End,
}

impl Arm for ForwardKinematics {
    fn description(&self) -> &RobotDescription {
        &self.robot
    }

    fn ports(&self, _robot: &Robot) -> Interface {
        let q = OfAxes::Position.input(&self.robot, "q", "positions of the joints");
        let interface = Interface::new().input(q);
        let interface = pose_outputs("origin of the frame").into_iter().fold(interface, Interface::output);
        interface.output(Output::real("r").shape(Shape::Matrix(3, 3)).unit("1").doc("rotation matrix"))
    }

    fn compute(&self, robot: &Robot, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        let Some(data) = w.get::<Data>() else { return };
        let placement = place(robot, data, self.end.of(robot), c.input(0));
        Pose::of(&placement).write(&mut y[..Pose::LEN]);
        // Signals hold matrices row by row.
        y[Pose::LEN..].copy_from_slice(placement.rotation.transpose().as_slice());
    }
}

/// A frame in the reference of the robot.
fn place(robot: &Robot, data: &mut Data, frame: Frame, q: &[f64]) -> blocksim_multibody::Placement {
    blocksim_multibody::forward_kinematics(robot.model(), data, q);
    frame.relative_to(&robot.reference(), data)
}
