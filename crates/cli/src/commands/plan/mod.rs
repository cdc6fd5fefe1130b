//! `blocksim plan`: moves of a robot, checked along their whole way, as files for diagrams.

mod meeting;
mod report;
pub mod request;
mod space;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use blocksim_block::ParamError;
use blocksim_blocks::motion::{JointPath, Rule, Segments, ToolPath, refused, replanned};
use blocksim_blocks::robotics::RobotDescription;
use blocksim_diagram::{Reader, Sources, parameter};
use blocksim_multibody::{EulerZyx, Placement};
use blocksim_robotics::kinematics::Configuration;
use blocksim_robotics::motion::AxisLimits;
use blocksim_robotics::planner::{
    CartesianRequest, Chosen, Course, Findings, Quantity, Review, Space, Start, choose, configurations,
    review,
};
use blocksim_robotics::robot::Robot;
use nalgebra::Vector3;
use serde_json::Value;

use crate::args::plan::{PlanCommand, PlanCommon, ToolArgs};
use crate::disk::{Disk, readable, write_file};
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::terminal::console::Console;

/// Name of a text that no file holds.
const COMMAND_LINE: &str = "command line";

/// A robot among what surrounds it.
pub struct Setting {
    /// The robot.
    pub robot: Robot,
    /// What can collide; nothing where nothing has a shape.
    space: Option<Space>,
}

impl Setting {
    /// The robot that a move is for, and its surroundings.
    ///
    /// # Errors
    /// What of the two cannot be read.
    pub fn read(common: &PlanCommon, reader: &dyn Reader) -> Result<Setting, Failure> {
        let (robot, description) = robot_from(common, reader)?;
        let space = space::read(common, reader, &robot, &description)?;
        Ok(Setting { robot, space })
    }
}

/// A move that was looked at along its whole way.
pub struct Considered {
    /// What it is for.
    pub setting: Arc<Setting>,
    /// The move.
    pub course: Arc<dyn Course>,
    /// How near it comes to limits and to what stands around, and what is to be known of it.
    pub review: Review,
    /// As the text of a move.
    text: String,
    chosen: Option<Chosen>,
    kept: Option<CartesianRequest>,
}

/// Plans a move and looks at it along its whole way.
///
/// # Errors
/// Why there is no such move.
pub fn consider(command: &PlanCommand) -> Result<Considered, Failure> {
    let setting = Arc::new(Setting::read(command.common(), &Disk::default())?);
    let asked = ask(command, &setting.robot)?;
    let choice = report::chosen(asked.chosen.as_ref());
    examine(setting, asked, &mut Segments::default()).map_err(|error| {
        let failure = told(&error);
        if choice.is_empty() {
            failure
        } else {
            failure.note(choice.trim_end().replacen("starts     ", "starts ", 1))
        }
    })
}

/// Plans what was asked and looks at it along its whole way. What stands in `segments` is not planned again.
///
/// # Errors
/// The member at fault, what is wrong, and what helps.
pub fn examine(
    setting: Arc<Setting>,
    asked: Asked,
    segments: &mut Segments,
) -> Result<Considered, ParamError> {
    let Asked { text, path, chosen, kept } = asked;
    let robot = &setting.robot;
    let course = replanned(&path, &robot.limits(), Rule::Feasible, Some(robot), "move", segments)?;
    let velocity = path.tool.as_ref().map(|tool| tool.velocity);
    let review = review(robot, course.as_ref(), setting.space.as_ref(), &path.scrutiny(), velocity);
    Ok(Considered { setting, course, review, text, chosen, kept })
}

impl Considered {
    /// Whether it keeps all limits and touches nothing.
    pub fn passes(&self) -> bool {
        self.review.passes()
    }

    /// For programs; SI units.
    pub fn data(&self) -> Value {
        let mut data = report::data(&self.setting.robot, self.course.as_ref(), &self.review);
        data["configuration"] = report::choice(self.chosen.as_ref());
        let met = self.setting.space.as_ref().zip(self.review.met.as_ref());
        data["collisions"] = met.map_or(Value::Null, |(space, met)| meeting::data(space, met));
        data
    }

    /// The text of a file with the move.
    pub fn file(&self) -> String {
        report::file(&self.text, self.course.as_ref(), &self.review.findings)
    }
}

/// Plans a move, tells how near it comes to the limits, and writes it.
///
/// # Errors
/// Why there is no such move.
pub fn plan(command: &PlanCommand, console: Console) -> Outcome {
    let common = command.common();
    let found = consider(command)?;
    let Considered { setting, course, review, chosen, kept, .. } = &found;
    let Setting { robot, space } = setting.as_ref();
    match common.json {
        true => console.data(&format!("{}\n", found.data()))?,
        false => {
            console.data(&report::text(robot, course.as_ref(), review))?;
            console.data(&report::chosen(chosen.as_ref()))?;
            let stuck = kept.as_ref().filter(|_| stuck(&review.findings));
            if let Some(word) = stuck.and_then(|kept| other(robot, kept)) {
                console.data(&format!("           --configuration {word} can go the whole way\n"))?;
            }
            console.data(&meeting::text(space.as_ref().zip(review.met.as_ref())))?;
        }
    }
    if !found.passes() && !common.accept_violations {
        if common.out.is_some() {
            console.say("nothing was written\n  = help: --accept-violations writes the move as it is");
        }
        return Ok(Exit::Failed);
    }
    if let Some(out) = &common.out {
        write_file(out, found.file().as_bytes(), common.yes)?;
        if !common.json {
            console.data(&format!("written    {}\n", out.display()))?;
        }
    }
    Ok(Exit::Done)
}

/// Whether another configuration of the arm may help.
fn stuck(findings: &Findings) -> bool {
    let of_pose = [Quantity::Lower, Quantity::Upper, Quantity::Jump, Quantity::Singularity];
    findings.violations.iter().any(|violation| of_pose.contains(&violation.quantity))
}

/// A configuration that keeps all limits on the whole path.
fn other(robot: &Robot, request: &CartesianRequest) -> Option<String> {
    let passes =
        |configuration| choose(robot, request, Some(configuration)).is_ok_and(|chosen| chosen.passes);
    configurations().into_iter().find(|(_, configuration)| passes(*configuration)).map(|(word, _)| word)
}

/// The robot that the move is for.
///
/// # Errors
/// If the model has none.
pub fn robot(common: &PlanCommon) -> Result<(Robot, RobotDescription), Failure> {
    robot_from(common, &Disk::default())
}

fn robot_from(common: &PlanCommon, reader: &dyn Reader) -> Result<(Robot, RobotDescription), Failure> {
    let read: RobotDescription = read(reader, &common.robot, &common.set, "manipulator")?;
    let robot = read.robot("manipulator").map_err(|error| told(&error))?;
    Ok((robot, read))
}

/// Reads a value out of a file.
fn read<T: serde::de::DeserializeOwned>(
    reader: &dyn Reader,
    path: &Path,
    set: &[String],
    name: &str,
) -> Result<T, Failure> {
    if path != Path::new(COMMAND_LINE) {
        readable(path)?;
    }
    let sources = Sources::new(reader);
    parameter(&sources, path, set, name).map_err(|problems| Failure::of(Exit::Model, problems, sources.all()))
}

/// What was asked.
pub struct Asked {
    /// As the text of a move.
    text: String,
    path: JointPath,
    /// How the start was chosen, where there was a choice.
    chosen: Option<Chosen>,
    /// What was asked of the tool, where the positions at the start are kept.
    kept: Option<CartesianRequest>,
}

impl Asked {
    /// A text as it would stand in the file of a move.
    ///
    /// # Errors
    /// What of it is no move, with its place in the text.
    pub fn in_words(text: String) -> Result<Asked, Failure> {
        let path = on_command_line(&text)?;
        Ok(Asked { text, path, chosen: None, kept: None })
    }

    /// The move.
    pub fn path(&self) -> &JointPath {
        &self.path
    }
}

/// What was asked: as text of a move and as the move.
fn ask(command: &PlanCommand, robot: &Robot) -> Result<Asked, Failure> {
    let (start, rest, chosen) = match command {
        PlanCommand::Sequence(args) => {
            let disk = Disk::default();
            let path = read(&disk, &args.file, &[], "move")?;
            let text = disk.read(&args.file).map_err(Failure::unreadable)?;
            return Ok(Asked { text, path, chosen: None, kept: None });
        }
        PlanCommand::Joint(args) => (start(args.from.from.as_deref(), robot)?, request::joint(args)?, None),
        PlanCommand::Linear(args) => tool(&args.tool, None, robot)?,
        PlanCommand::Circular(args) => tool(&args.tool, Some(&args.via), robot)?,
    };
    let text = format!("JointMove(\n    start: {start},\n{rest})\n");
    let path: JointPath = on_command_line(&text)?;
    let acceleration = robot.tcp_limits().acceleration;
    let request =
        |tool: &ToolPath| tool.request(Start::Joints(path.start_values()), acceleration, "move.tool");
    let kept = path.tool.as_ref().filter(|_| chosen.is_none()).and_then(|tool| request(tool).ok());
    Ok(Asked { text, path, chosen, kept })
}

/// Positions at the start as text.
fn start(from: Option<&str>, robot: &Robot) -> Result<String, Failure> {
    match from {
        Some(from) => request::list("--from", from, "deg"),
        None => Ok(positions(&robot.start(), robot)),
    }
}

/// Positions of the axes as a list of texts, with all digits.
fn positions(q: &[f64], robot: &Robot) -> String {
    let axes = q.iter().zip(robot.limits());
    let items: Vec<String> =
        axes.map(|(q, AxisLimits { kind, .. })| format!("\"{} {}\"", kind.shown(*q), kind.unit())).collect();
    format!("[{}]", items.join(", "))
}

/// Start and path of the tool as texts, and how the start was chosen. A start at a point, or in a configuration that is
/// asked for, is solved for the positions of the axes.
fn tool(
    args: &ToolArgs,
    via: Option<&str>,
    robot: &Robot,
) -> Result<(String, String, Option<Chosen>), Failure> {
    let rest = request::tool(args, via)?;
    let wanted = args.configuration.as_deref().map(configuration).transpose()?;
    let given = start(args.from.from.as_deref(), robot)?;
    if args.from_point.is_none() && wanted.is_none() {
        return Ok((given, rest, None));
    }
    let path: JointPath = on_command_line(&format!("JointMove(start: {given},\n{rest})"))?;
    let Some(tool) = &path.tool else { return Err(Failure::usage("no path of the tool")) };
    let from = begin(args, &path.start_values())?;
    let request =
        tool.request(from, robot.tcp_limits().acceleration, "move.tool").map_err(|error| told(&error))?;
    let chosen = choose(robot, &request, wanted).map_err(|error| told(&refused(&error, "move")))?;
    Ok((positions(&chosen.q, robot), rest, Some(chosen)))
}

/// Where the tool begins.
fn begin(args: &ToolArgs, q: &[f64]) -> Result<Start, Failure> {
    let Some(point) = &args.from_point else { return Ok(Start::Joints(q.to_vec())) };
    let point: Vec<f64> = on_command_line(&format!("({})", coordinates("--from-point", point, "mm")?))
        .map(|Triple { at }| at.to_vec())?;
    let point = Vector3::new(point[0], point[1], point[2]);
    let Some(angles) = &args.from_rotation else { return Ok(Start::Point(point)) };
    let text = coordinates("--from-rotation", angles, "deg")?.replacen("at", "angles", 1);
    let Angles { angles: [alpha, beta, gamma] } = on_command_line(&format!("({text})"))?;
    let rotation = EulerZyx { alpha, beta, gamma }.rotation();
    Ok(Start::Pose(Placement { rotation, translation: point }))
}

/// The configuration that a word names.
fn configuration(word: &str) -> Result<Configuration, Failure> {
    let all = configurations();
    let words: Vec<&str> = all.iter().map(|(word, _)| word.as_str()).collect();
    let found = all.iter().find(|(known, _)| known == word);
    found.map(|(_, configuration)| *configuration).ok_or_else(|| {
        let known = words.join(", ");
        Failure::usage(format!("there is no configuration `{word}`")).help(format!("choose {known}"))
    })
}

fn coordinates(option: &str, values: &str, unit: &str) -> Result<String, Failure> {
    request::three(option, values, unit).map(|list| format!("at: {list}"))
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
pub fn on_command_line<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, Failure> {
    struct Asked<'t>(&'t str);
    impl Reader for Asked<'_> {
        fn read(&self, path: &Path) -> Result<String, String> {
            match path == Path::new(COMMAND_LINE) {
                true => Ok(self.0.to_owned()),
                false => Err("a move of the command line names no files".to_owned()),
            }
        }
    }
    read(&Asked(text), &PathBuf::from(COMMAND_LINE), &[], "move")
}

/// A refusal of the planner in words.
fn told(error: &ParamError) -> Failure {
    Failure::parameter(error)
}
