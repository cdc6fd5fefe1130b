//! What the blocks of a robot have in common.

use std::any::Any;
use std::fmt::Debug;

use blocksim_block::prelude::*;
use blocksim_multibody::Frame;
use blocksim_robotics::motion::AxisKind;
use blocksim_robotics::robot::Robot;
use blocksim_signal::Unit;

use super::RobotDescription;

/// What a kind computes about the mechanism of the robot that it describes.
pub trait Arm: Any + Debug + Send + Sync + Sized {
    /// The parameter `robot`.
    fn description(&self) -> &RobotDescription;

    /// Inputs and outputs.
    fn ports(&self, robot: &Robot) -> Interface;

    /// A workspace of the mechanism.
    fn workspace(&self, robot: &Robot) -> Scratch {
        Scratch::new(robot.model().data())
    }

    /// The outputs for the inputs of `c`.
    fn compute(&self, robot: &Robot, c: &Context, w: &mut Scratch, y: &mut [f64]);

    /// The block with its robot assembled, if the description makes one.
    fn build(self, errors: &mut ParamErrors) -> Option<OfArm<Self>> {
        let robot = errors.take(self.description().robot("robot"))?;
        Some(OfArm { kind: self, robot })
    }
}

/// A block about the mechanism of a robot.
#[derive(Debug)]
pub struct OfArm<K> {
    pub(super) kind: K,
    pub(super) robot: Robot,
}

impl<K: Arm> Block for OfArm<K> {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(self.kind.ports(&self.robot))
    }

    fn scratch(&self) -> Scratch {
        self.kind.workspace(&self.robot)
    }

    fn outputs(&self, _group: usize, c: &Context, w: &mut Scratch, y: &mut [f64]) {
        self.kind.compute(&self.robot, c, w, y);
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
