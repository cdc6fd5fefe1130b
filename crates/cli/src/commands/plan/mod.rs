//! `blocksim plan`: moves of a robot, checked along their whole way, as files for diagrams.

mod asked;
mod said;

use std::io;
use std::path::{Path, PathBuf};

use blocksim_block::ParamError;
use blocksim_blocks::motion::{JointPath, Rule, planned, refused};
use blocksim_blocks::robotics::RobotDescription;
use blocksim_diagram::{Reader, Sources, parameter};
use blocksim_multibody::{EulerZyx, Placement};
use blocksim_planner::{CartesianMove, Course, Start, inspect};
use blocksim_robot::Robot;
use nalgebra::Vector3;

use super::tell;
use crate::args::model::Format;
use crate::args::plan::{PlanCommand, PlanCommon, ToolArgs};
use crate::disk::{Disk, refusal, write_file};
use crate::exit::Exit;
use crate::terminal::console::Console;

/// Name of a text that no file holds.
const COMMAND_LINE: &str = "command line";

/// Waypoints in time at which a move is looked at, at least.
const WAYPOINTS: usize = 2000;

/// A refusal in words, which has not been told, or the end of the program after telling.
enum Stop {
    Say(String, Exit),
    Told(Exit),
}

impl From<String> for Stop {
    fn from(said: String) -> Self {
        Stop::Say(said, Exit::Usage)
    }
}

/// Plans a move, tells how near it comes to the limits, and writes it.
///
/// # Errors
/// If the standard output cannot be written.
pub fn plan(command: &PlanCommand, console: Console) -> io::Result<Exit> {
    let common = match command {
        PlanCommand::Joint(args) => &args.common,
        PlanCommand::Linear(args) => &args.tool.common,
        PlanCommand::Circular(args) => &args.tool.common,
        PlanCommand::Sequence(args) => &args.common,
    };
    let made = robot(common, console).and_then(|robot| {
        let (text, path) = ask(command, &robot, console)?;
        let course = planned(&path, &robot.limits(), Rule::Feasible, Some(&robot), "move")
            .map_err(|error| told(&error))?;
        Ok((robot, text, path, course))
    });
    let (robot, text, path, course) = match made {
        Ok(made) => made,
        Err(Stop::Told(exit)) => return Ok(exit),
        Err(Stop::Say(said, exit)) => {
            console.say(&said);
            return Ok(exit);
        }
    };
    let findings = inspect(&robot, course.as_ref(), WAYPOINTS);
    let velocity = path.tool.as_ref().map(|tool| tool.velocity);
    match common.json {
        true => console.data(&format!("{}\n", said::data(course.as_ref(), &findings, velocity)))?,
        false => console.data(&said::text(&robot, course.as_ref(), &findings, velocity))?,
    }
    if !findings.violations.is_empty() {
        if common.out.is_some() {
            console.say("nothing was written");
        }
        return Ok(Exit::Failed);
    }
    if let Some(out) = &common.out {
        let file = said::file(&text, course.as_ref(), &findings);
        if let Err(exit) = write_file(out, file.as_bytes(), common.yes, console) {
            return Ok(exit);
        }
        if !common.json {
            console.data(&format!("written    {}\n", out.display()))?;
        }
    }
    Ok(Exit::Done)
}

/// The robot that the move is for.
fn robot(common: &PlanCommon, console: Console) -> Result<Robot, Stop> {
    let disk = Disk::default();
    let read: RobotDescription = read(&disk, &common.robot, &common.set, "manipulator", console)?;
    read.robot("manipulator").map_err(|error| told(&error))
}

/// Reads a value out of a file.
fn read<T: serde::de::DeserializeOwned>(
    reader: &dyn Reader,
    path: &Path,
    set: &[String],
    name: &str,
    console: Console,
) -> Result<T, Stop> {
    if path != Path::new(COMMAND_LINE)
        && let Some(refusal) = refusal(path)
    {
        return Err(Stop::Say(refusal, Exit::Files));
    }
    let sources = Sources::new(reader);
    parameter(&sources, path, set, name).map_err(|problems| {
        match tell(&problems, &sources.all(), Format::Full, console) {
            Ok(()) => Stop::Told(Exit::Model),
            Err(error) => Stop::Say(format!("error: {error}"), Exit::Files),
        }
    })
}

/// What was asked: as text of a move and as the move.
fn ask(command: &PlanCommand, robot: &Robot, console: Console) -> Result<(String, JointPath), Stop> {
    let (start, rest) = match command {
        PlanCommand::Sequence(args) => {
            let disk = Disk::default();
            let path = read(&disk, &args.file, &[], "move", console)?;
            let text =
                disk.read(&args.file).map_err(|said| Stop::Say(format!("error: {said}"), Exit::Files))?;
            return Ok((text, path));
        }
        PlanCommand::Joint(args) => (start(args.from.from.as_deref(), robot)?, asked::joint(args)?),
        PlanCommand::Linear(args) => tool(&args.tool, None, robot, console)?,
        PlanCommand::Circular(args) => tool(&args.tool, Some(&args.via), robot, console)?,
    };
    let text = format!("JointMove(\n    start: {start},\n{rest})\n");
    let path = on_command_line(&text, console)?;
    Ok((text, path))
}

/// Positions at the start as text.
fn start(from: Option<&str>, robot: &Robot) -> Result<String, String> {
    match from {
        Some(from) => asked::list("--from", from, "deg"),
        None => Ok(degrees(&robot.start())),
    }
}

/// Angles as a list of texts, with all digits.
fn degrees(q: &[f64]) -> String {
    let items: Vec<String> = q.iter().map(|q| format!("\"{} deg\"", q.to_degrees())).collect();
    format!("[{}]", items.join(", "))
}

/// Start and path of the tool as texts. A start at a point is solved for the positions of the axes.
fn tool(
    args: &ToolArgs,
    via: Option<&str>,
    robot: &Robot,
    console: Console,
) -> Result<(String, String), Stop> {
    let rest = asked::tool(args, via)?;
    let Some(point) = &args.from_point else { return Ok((start(args.from.from.as_deref(), robot)?, rest)) };
    let point: Vec<f64> =
        on_command_line(&format!("({})", coordinates("--from-point", point, "mm")?), console)
            .map(|Triple { at }| at.to_vec())?;
    let point = Vector3::new(point[0], point[1], point[2]);
    let start = match &args.from_rotation {
        None => Start::Point(point),
        Some(angles) => {
            let text = coordinates("--from-rotation", angles, "deg")?.replacen("at", "angles", 1);
            let Angles { angles: [alpha, beta, gamma] } = on_command_line(&format!("({text})"), console)?;
            let rotation = EulerZyx { alpha, beta, gamma }.rotation();
            Start::Pose(Placement { rotation, translation: point })
        }
    };
    let path: JointPath = on_command_line(&format!("JointMove(start: [],\n{rest})"), console)?;
    let Some(tool) = &path.tool else { return Err("error: no path of the tool".to_owned().into()) };
    let request =
        tool.request(start, robot.tcp_limits().acceleration, "move.tool").map_err(|error| told(&error))?;
    let planned = CartesianMove::plan(robot, &request).map_err(|error| told(&refused(&error, "move")))?;
    Ok((degrees(&planned.positions(0.0)), rest))
}

fn coordinates(option: &str, values: &str, unit: &str) -> Result<String, String> {
    asked::list(option, values, unit).map(|list| format!("at: {list}"))
}

/// A point.
#[derive(serde::Deserialize)]
struct Triple {
    #[serde(deserialize_with = "blocksim_block::in_unit::point")]
    at: [f64; 3],
}

/// Three angles.
#[derive(serde::Deserialize)]
struct Angles {
    #[serde(deserialize_with = "blocksim_block::in_unit::turns")]
    angles: [f64; 3],
}

/// Reads what was asked as if it stood in a file.
fn on_command_line<T: serde::de::DeserializeOwned>(text: &str, console: Console) -> Result<T, Stop> {
    struct Asked<'t>(&'t str);
    impl Reader for Asked<'_> {
        fn read(&self, path: &Path) -> Result<String, String> {
            match path == Path::new(COMMAND_LINE) {
                true => Ok(self.0.to_owned()),
                false => Err("a move of the command line names no files".to_owned()),
            }
        }
    }
    read(&Asked(text), &PathBuf::from(COMMAND_LINE), &[], "move", console)
}

/// A refusal of the planner in words.
fn told(error: &ParamError) -> Stop {
    let help = error.help.as_ref().map(|help| format!("\n  = help: {help}")).unwrap_or_default();
    Stop::Say(format!("error: {} (`{}`){help}", error.message, error.param), Exit::Model)
}
