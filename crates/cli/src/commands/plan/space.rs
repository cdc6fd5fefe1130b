//! The shapes of the robot and of what stands around it, for collisions.

use blocksim_block::ParamError;
use blocksim_blocks::robotics::{RobotDescription, Surroundings};
use blocksim_diagram::{Sources, has_parameter};
use blocksim_planner::{RobotShapes, Rules, Space};
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
    let shapes = description.shapes();
    let none = RobotShapes { links: vec![Vec::new(); shapes.links.len()], ..RobotShapes::default() };
    if shapes == none && common.surroundings.is_none() {
        return Ok(None);
    }
    let may_touch = [&description.may_touch[..], &around.may_touch].concat();
    let things = around.space("surroundings").map_err(|error| told(&error))?;
    let space =
        Space::new(robot, &shapes, &things, &Rules { may_touch: may_touch.clone(), ..Rules::default() });
    let names = space.names();
    if let Some(unknown) = may_touch.iter().flatten().find(|name| !names.contains(&name.as_str())) {
        let message = format!("there is no part `{unknown}` with shapes");
        return Err(told(
            &ParamError::new("may_touch", message).help(format!("choose {}", names.join(", "))),
        ));
    }
    Ok(Some(space))
}

fn around(common: &PlanCommon) -> Result<Surroundings, Failure> {
    const NAME: &str = "surroundings";
    let disk = Disk::default();
    match &common.surroundings {
        Some(file) => value(&disk, file, &[], NAME),
        None if has_parameter(&Sources::new(&disk), &common.robot, NAME) => {
            value(&disk, &common.robot, &common.set, NAME)
        }
        None => Ok(Surroundings::default()),
    }
}
