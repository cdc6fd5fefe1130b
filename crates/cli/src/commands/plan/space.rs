//! The shapes of the robot and of what stands around it, for collisions.

use blocksim_blocks::robotics::{RobotDescription, Surroundings};
use blocksim_diagram::{Sources, has_parameter};
use blocksim_planner::Space;
use blocksim_robot::Robot;

use super::{read as value, told};
use crate::args::plan::PlanCommon;
use crate::disk::Disk;
use crate::failure::Failure;

/// What can collide; `None` where the robot has no shapes.
///
/// # Errors
/// Surroundings that cannot be read, and pairs that may touch of which there is no such part.
pub fn read(
    common: &PlanCommon,
    robot: &Robot,
    description: &RobotDescription,
) -> Result<Option<Space>, Failure> {
    let around = around(common)?;
    description.space(robot, around.as_ref(), "surroundings").map_err(|error| told(&error))
}

fn around(common: &PlanCommon) -> Result<Option<Surroundings>, Failure> {
    const NAME: &str = "surroundings";
    let disk = Disk::default();
    match &common.surroundings {
        Some(file) => value(&disk, file, &[], NAME).map(Some),
        None if has_parameter(&Sources::new(&disk), &common.robot, NAME) => {
            value(&disk, &common.robot, &common.set, NAME).map(Some)
        }
        None => Ok(None),
    }
}
