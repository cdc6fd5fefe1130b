//! `blocksim identify`: experiments with the robot of a diagram, and what they tell of its parameters; parameters of any model from a
//! measurement.

mod axis_friction;
mod bench;
mod constant_speed;
mod course;
mod drive;
mod dynamics;
mod dynamics_recorded;
mod dynamics_report;
mod failure;
mod friction;
mod friction_recorded;
mod friction_report;
mod law;
mod look_into;
mod out;
mod parameters;
mod parameters_report;
mod pose;
mod recorded;

use std::path::{Path, PathBuf};

use bench::Bench;

use crate::args::identify::{Common, IdentifyCommand};
use crate::args::model::ModelArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::loaded::load;
use crate::terminal::console::Console;
use crate::trust::Purpose;

/// Runs experiments with the robot of a diagram, or a model again and again.
///
/// # Errors
/// Why nothing could be identified.
pub fn identify(command: &IdentifyCommand, console: Console) -> Outcome {
    match command {
        IdentifyCommand::Friction(args) => match &args.recorded.from {
            Some(from) => friction_recorded::friction(args, from, console),
            None => friction::friction(args, console),
        },
        IdentifyCommand::Dynamics(args) => match &args.recorded.from {
            Some(from) => dynamics_recorded::dynamics(args, from, console),
            None => dynamics::dynamics(args, console),
        },
        IdentifyCommand::Parameters(args) => parameters::parameters(args, console),
    }
}

/// The robot that is measured in a clone of blocksim where no other model is named.
const OWN_ROBOT: &str = "diagrams/irb2600/irb2600.ron";

/// The file of the model.
///
/// # Errors
/// None is named, and the robot of blocksim is not here.
fn model(common: &Common) -> Result<PathBuf, Failure> {
    match &common.model {
        Some(model) => Ok(model.clone()),
        None if Path::new(OWN_ROBOT).exists() => Ok(PathBuf::from(OWN_ROBOT)),
        None => Err(Failure::new(Exit::Usage, "identify", "no model is named").help(
            "name the model of a robot; `blocksim explain identify` lists what it needs, with an example",
        )),
    }
}

/// Compiles the diagram and puts its robot on the bench.
fn load_bench(common: &Common, console: Console) -> Result<Bench, Failure> {
    let file = model(common)?;
    let with = |set: Vec<String>| ModelArgs { model: file.clone(), set, plugins: common.plugins };
    let asked = common.set.iter().any(|set| set.split('=').next().is_some_and(|name| name.trim() == "drive"));
    let mut set = common.set.clone();
    if let Some(drive) = &common.drive {
        set.push(format!("drive={drive}"));
    } else if !asked {
        set.push("drive=torque".to_owned());
    }
    let mut loaded = load(&with(set), Purpose::Run)?;
    let has_no_drive = |problem: &blocksim_block::problem::Problem| problem.code == "unknown_override";
    if common.drive.is_none() && !asked && loaded.compiled.problems.iter().any(has_no_drive) {
        // A diagram without this choice is taken as it is.
        loaded = load(&with(common.set.clone()), Purpose::Run)?;
    }
    let schedule = loaded.take_schedule("nothing was run", console)?;
    if let Some(understood) = loaded.understood() {
        console.say(&understood);
    }
    Bench::new(schedule)
}

/// An object for programs, with its version and what it is.
pub(super) fn typed(what: &str, mut value: serde_json::Value) -> serde_json::Value {
    if let Some(fields) = value.as_object_mut() {
        fields.insert("v".to_owned(), 1.into());
        fields.insert("type".to_owned(), what.into());
    }
    value
}
