//! What the blocks of a robot have in common.

use blocksim_block::prelude::*;
use blocksim_multibody::Frame;
use blocksim_robot::Robot;

use super::RobotDescription;

/// The robot of a block, once it is loaded.
#[derive(Debug, Clone, Default)]
pub(super) struct Arm(Option<Robot>);

impl Arm {
    /// A description that makes no robot is reported by [`Arm::check`].
    pub(super) fn of(description: &RobotDescription) -> Self {
        Arm(description.robot("robot").ok())
    }

    pub(super) fn check(description: &RobotDescription) -> Result<(), ParamError> {
        description.robot("robot").map(drop)
    }

    /// The robot; without one the simulation stops.
    pub(super) fn robot(&self, c: &Context) -> Option<&Robot> {
        if self.0.is_none() {
            c.fail("the robot was not assembled");
        }
        self.0.as_ref()
    }

    /// A workspace of the mechanism.
    pub(super) fn scratch(&self) -> Scratch {
        self.0.as_ref().map(|robot| Scratch::new(robot.model().data())).unwrap_or_default()
    }

    /// An input with a value for each joint.
    pub(super) fn positions(name: &str, joints: usize, doc: &'static str) -> Input {
        Self::vector(name, joints, "rad", doc)
    }

    /// An input with a value for each joint.
    pub(super) fn vector(name: &str, joints: usize, unit: &str, doc: &'static str) -> Input {
        Input::real(name).shape(Shape::Vector(joints)).unit(unit).doc(doc)
    }
}

/// A frame at the end of the arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum End {
    /// The tool, with its origin in the tool centre point.
    Tool,
    /// The flange.
    Flange,
}

impl End {
    pub(super) fn of(self, robot: &Robot) -> Frame {
        match self {
            End::Tool => robot.tool(),
            End::Flange => robot.flange(),
        }
    }
}
