//! `blocksim identify`: experiments with the robot of a diagram, and what they tell of its parameters.

mod axis_friction;
mod bench;
mod constant_speed;
mod course;
mod drive;
mod dynamics;
mod dynamics_recorded;
mod dynamics_said;
mod friction;
mod friction_recorded;
mod friction_said;
mod look_into;
mod out;
mod pose;
mod recorded;
mod said;

use std::io;

use bench::Bench;

use super::tell;
use crate::args::identify::{Common, IdentifyCommand};
use crate::args::model::{Format, ModelArgs};
use crate::exit::Exit;
use crate::loaded::load;
use crate::terminal::console::Console;
use crate::terminal::render;

/// Runs experiments with the robot of a diagram.
///
/// # Errors
/// If the standard output cannot be written.
pub fn identify(command: &IdentifyCommand, console: Console) -> io::Result<Exit> {
    match command {
        IdentifyCommand::Friction(args) => match &args.recorded.from {
            Some(from) => friction_recorded::friction(args, from, console),
            None => friction::friction(args, console),
        },
        IdentifyCommand::Dynamics(args) => match &args.recorded.from {
            Some(from) => dynamics_recorded::dynamics(args, from, console),
            None => dynamics::dynamics(args, console),
        },
    }
}

/// Compiles the diagram and puts its robot on the bench; what is wrong has been told then.
fn load_bench(common: &Common, console: Console) -> io::Result<Result<Bench, Exit>> {
    let with = |set: Vec<String>| ModelArgs { model: common.model.clone(), set };
    let asked = common.set.iter().any(|set| set.split('=').next().is_some_and(|name| name.trim() == "drive"));
    let mut set = common.set.clone();
    if let Some(drive) = &common.drive {
        set.push(format!("drive={drive}"));
    } else if !asked {
        set.push("drive=torque".to_owned());
    }
    let Some(mut loaded) = load(&with(set), console) else { return Ok(Err(Exit::Files)) };
    let has_no_drive = |problem: &blocksim_block::problem::Problem| problem.code == "unknown_override";
    if common.drive.is_none() && !asked && loaded.compiled.problems.iter().any(has_no_drive) {
        // A diagram without this choice is taken as it is.
        match load(&with(common.set.clone()), console) {
            Some(again) => loaded = again,
            None => return Ok(Err(Exit::Files)),
        }
    }
    let problems = &loaded.compiled.problems;
    let format = if common.json { Format::Json } else { Format::Full };
    tell(problems, &loaded.files, format, console)?;
    let Some(schedule) = loaded.compiled.schedule.take() else {
        console.say(&format!("{}; nothing was run", render::tally(problems)));
        return Ok(Err(Exit::Model));
    };
    if let Some(understood) = loaded.understood() {
        console.say(&understood);
    }
    match Bench::new(schedule) {
        Ok(bench) => Ok(Ok(bench)),
        Err(refusal) => {
            console.say(&refusal.text());
            Ok(Err(Exit::Model))
        }
    }
}
