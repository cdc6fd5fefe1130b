//! What the blocks of a robot have in common.

use blocksim_block::prelude::*;
use blocksim_motion::AxisKind;
use blocksim_multibody::Frame;
use blocksim_robot::Robot;
use blocksim_signal::Unit;

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

    /// The robot, once it is loaded.
    pub(super) fn loaded(&self) -> Option<&Robot> {
        self.0.as_ref()
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
}

/// What a vector over the axes of a robot holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OfAxes {
    /// rad or m.
    Position,
    /// rad/s or m/s.
    Speed,
    /// rad/s^2 or m/s^2.
    Acceleration,
    /// N*m or N.
    Force,
}

impl OfAxes {
    /// Its dimension; none is known where some axes turn and others slide.
    fn dimension(self, robot: &RobotDescription) -> Option<Dimension> {
        let [turning, sliding] = match self {
            OfAxes::Position => ["rad", "m"],
            OfAxes::Speed => ["rad/s", "m/s"],
            OfAxes::Acceleration => ["rad/s^2", "m/s^2"],
            OfAxes::Force => ["N*m", "N"],
        };
        let slides = robot.links.iter().filter(|link| link.kind() == AxisKind::Sliding).count();
        let unit = match slides {
            0 => turning,
            n if n == robot.links.len() => sliding,
            _ => return None,
        };
        Unit::parse(unit).ok().map(|unit| unit.dimension)
    }

    /// An input with a value for each axis.
    pub(crate) fn input(self, robot: &RobotDescription, name: &str, doc: &'static str) -> Input {
        Input::real(name).shape(Shape::Vector(robot.links.len())).dimension(self.dimension(robot)).doc(doc)
    }

    /// An output with a value for each axis.
    pub(crate) fn output(self, robot: &RobotDescription, name: &str, doc: &'static str) -> Output {
        Output::real(name).shape(Shape::Vector(robot.links.len())).dimension(self.dimension(robot)).doc(doc)
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
