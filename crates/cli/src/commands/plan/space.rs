//! The shapes of the robot and of what stands around it, for collisions.

use blocksim_blocks::robotics::{RobotDescription, Surroundings};
use blocksim_diagram::{Reader, Sources, has_parameter};
use blocksim_robotics::planner::Space;
use blocksim_robotics::robot::Robot;

use super::{read as value, told};
use crate::args::plan::PlanCommon;
use crate::failure::Failure;

/// What can collide; `None` where the robot has no shapes.
///
/// # Errors
/// Surroundings that cannot be read, and pairs that may touch of which there is no such part.
pub fn read(
    common: &PlanCommon,
    reader: &dyn Reader,
    robot: &Robot,
    description: &RobotDescription,
) -> Result<Option<Space>, Failure> {
    let around = around(common, reader)?;
    description.space(robot, around.as_ref(), "surroundings").map_err(|error| told(&error))
}

fn around(common: &PlanCommon, reader: &dyn Reader) -> Result<Option<Surroundings>, Failure> {
    const NAME: &str = "surroundings";
    match &common.surroundings {
        Some(file) => value(reader, file, &[], NAME).map(Some),
        None if has_parameter(&Sources::new(reader), &common.robot, NAME) => {
            value(reader, &common.robot, &common.set, NAME).map(Some)
        }
        None => Ok(None),
    }
}
