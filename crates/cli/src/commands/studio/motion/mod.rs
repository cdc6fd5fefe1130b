//! Moves of the robot of a model: planned while one types, looked at along their whole way, kept as files.

mod draft;
mod fields;
mod planner;

use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use blocksim_blocks::motion::{JointPath, Segments};
use blocksim_diagram::{Reader, Sources, has_parameter, parameter};
use blocksim_robotics::motion::{AxisKind, AxisLimits};
use blocksim_robotics::planner::{Course, pose};
use blocksim_robotics::robot::Robot;
use blocksim_studio::Reply;
use serde_json::{Value, json};

use self::draft::{Draft, Trouble};
pub use self::planner::Planner;
use super::values::refusal;
use crate::args::plan::PlanCommon;
use crate::commands::plan::{Considered, Setting, examine, robot};
use crate::disk::{Disk, write_file};
use crate::exit::Exit;
use crate::failure::Failure;

/// Instants of a move that the page draws.
const DRAWN: usize = 300;
/// The most moves of a sequence that have so many each.
const MOST_DRAWN: usize = 4;
/// Where moves are kept, beside the model.
const MOVES: &str = "moves";

fn common(model: &Path) -> PlanCommon {
    PlanCommon {
        robot: model.to_owned(),
        set: Vec::new(),
        surroundings: None,
        out: None,
        yes: false,
        accept_violations: false,
        json: true,
    }
}

/// The robot of a model: its axes with their ranges, and what the page draws; nothing if it has none.
pub fn robot_of(model: &Path, scene: &Value) -> Value {
    let disk = Disk::default();
    if !has_parameter(&Sources::new(&disk), model, "manipulator") {
        return Value::Null;
    }
    let (robot, _) = match robot(&common(model)) {
        Ok(robot) => robot,
        Err(failure) => return json!({ "trouble": failure.message() }),
    };
    let start = robot.start();
    let axes = robot.limits().into_iter().zip(&start).enumerate().map(|(n, (limits, start))| {
        let kind = limits.kind;
        json!({
            "name": format!("A{}", n + 1), "unit": if kind == AxisKind::Sliding { "mm" } else { "°" },
            "lower": kind.shown(limits.lower), "upper": kind.shown(limits.upper), "start": kind.shown(*start),
            "speed": kind.shown(limits.speed),
        })
    });
    let tcp = robot.tcp_limits();
    let mut data = robot.model().data();
    let tool = robot.tcp(&mut data, &start).translation;
    json!({
        "axes": axes.collect::<Vec<_>>(), "speed": 1e3 * tcp.speed, "acceleration": tcp.acceleration,
        "tool": [1e3 * tool.x, 1e3 * tool.y, 1e3 * tool.z], "moves": moves(model), "move": move_of(model), "scene": scene,
    })
}

/// The robot of a model in a few words, or why it cannot be read; nothing if it has none.
pub fn robot_in_words(model: &Path) -> Option<Result<String, String>> {
    let disk = Disk::default();
    has_parameter(&Sources::new(&disk), model, "manipulator").then(|| match robot(&common(model)) {
        Ok((robot, _)) => Ok(match robot.limits().len() {
            1 => "1 axis".to_owned(),
            count => format!("{count} axes"),
        }),
        Err(failure) => Err(failure.message()),
    })
}

/// Files with moves beside a model, as the model names them.
pub fn moves(model: &Path) -> Vec<String> {
    let folder = model.parent().unwrap_or(Path::new("")).join(MOVES);
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".ron"))
        .map(|name| format!("{MOVES}/{name}"))
        .collect();
    names.sort();
    names
}

/// The parameter of the model that a move is given to, as it is written.
pub fn move_of(model: &Path) -> Option<String> {
    let disk = Disk::default();
    let sources = Sources::new(&disk);
    let (all, _) = blocksim_diagram::targets(&sources, model);
    all.iter().find(|target| target.name == "move").map(|target| target.written.clone())
}

/// Plans what was typed. A move that cannot be planned is a normal answer, with the reason, not a failed request.
pub fn plan(planner: &Planner, model: &Path, body: &Value) -> Reply {
    let planned = planner.with(model, |setting, segments| {
        let found = consider(setting, segments, body);
        let robot = &setting.robot;
        match found {
            Ok(found) => {
                let mut data = told(&found);
                data["steps"] = steps(robot, segments, found.course.begins());
                data
            }
            Err(troubles) => {
                go_before(setting, segments, body, &troubles);
                json!({
                    "refused": reason(&troubles), "troubles": troubles.iter().map(Trouble::data).collect::<Vec<_>>(),
                    "steps": steps(robot, segments, &[]),
                })
            }
        }
    });
    planned.map_or_else(refusal, Reply::Data)
}

fn consider(
    setting: &Arc<Setting>,
    segments: &mut Segments,
    body: &Value,
) -> Result<Considered, Vec<Trouble>> {
    let asked = Draft::of(body, &setting.robot.limits()).read();
    // What was planned before is nothing to be shown with what cannot be read.
    let asked = asked.inspect_err(|_| segments.forget_row())?;
    examine(Arc::clone(setting), asked, segments).map_err(|error| vec![Trouble::of(&error)])
}

/// Plans the moves before the first one that cannot be planned, so that it is known where that one begins.
fn go_before(setting: &Arc<Setting>, segments: &mut Segments, body: &Value, troubles: &[Trouble]) {
    let Some(first) = troubles.iter().map(Trouble::step).min().flatten() else { return };
    if segments.row().len() == first {
        return;
    }
    let mut before = body.clone();
    if let Some(moves) = before["moves"].as_array_mut() {
        moves.truncate(first);
        if let Some(last) = moves.last_mut() {
            (last["zone"], last["wait"]) = ("".into(), "".into());
        }
        // Why one of these cannot be planned either is not what somebody has to correct first.
        drop(consider(setting, segments, &before));
    }
}

/// The first of all troubles, as a request is refused.
fn reason(troubles: &[Trouble]) -> Value {
    troubles.first().map_or(Value::Null, |trouble| {
        let data = trouble.data();
        json!({ "message": data["message"], "help": data["help"] })
    })
}

/// Each move of what was planned: when it begins, how long it takes, and the poses between which it goes.
fn steps(robot: &Robot, segments: &Segments, begins: &[f64]) -> Value {
    let mut data = robot.model().data();
    let kinds: Vec<AxisKind> = robot.limits().into_iter().map(|limits| limits.kind).collect();
    let mut pose_of = |q: &[f64]| {
        let (at, angles) = pose(&robot.tcp(&mut data, q));
        let turns = [angles.alpha, angles.beta, angles.gamma];
        json!({
            "axes": kinds.iter().zip(q).map(|(kind, q)| kind.shown(*q)).collect::<Vec<_>>(),
            "tool": at.map(|x| 1e3 * x), "rotation": turns.map(f64::to_degrees),
        })
    };
    let mut one = |(n, course): (usize, &Arc<dyn Course>)| {
        let duration = course.duration();
        let [from, to] = [0.0, duration].map(|t| pose_of(&course.positions(t)));
        json!({ "begin": begins.get(n), "duration": duration, "from": from, "to": to })
    };
    segments.row().iter().enumerate().map(&mut one).collect()
}

fn told(found: &Considered) -> Value {
    let mut data = found.data();
    let course = found.course.as_ref();
    let count = DRAWN * course.begins().len().min(MOST_DRAWN);
    let times: Vec<f64> = (0..=count).map(|n| course.duration() * n as f64 / count as f64).collect();
    let of_axis = |axis: usize| {
        let states: Vec<_> = times.iter().map(|t| course.at(axis, *t)).collect();
        let AxisLimits { kind, speed, .. } = found.setting.robot.limits()[axis];
        json!({
            "q": states.iter().map(|[q, ..]| *q).collect::<Vec<_>>(),
            "shown": states.iter().map(|[q, ..]| kind.shown(*q)).collect::<Vec<_>>(),
            "speed": states.iter().map(|[_, v, _]| 100.0 * v / speed).collect::<Vec<_>>(),
        })
    };
    data["times"] = times.clone().into();
    data["course"] = (0..course.axes()).map(of_axis).collect();
    data["passes"] = found.passes().into();
    let first = found.review.met.as_ref().and_then(|met| met.first.as_ref());
    data["collision"] = first.map_or(Value::Null, |first| {
        json!({ "what": first.to_string(), "help": first.help(), "move": first.spot.step.map(|step| step + 1) })
    });
    data
}

/// Keeps a move as a file beside the model; returns how the model would name it.
///
/// # Errors
/// What keeps it from being kept.
pub fn save(planner: &Planner, model: &Path, body: &Value) -> Result<String, Reply> {
    let Some(name) = body["name"].as_str().map(str::trim).filter(|name| is_name(name)) else {
        return Err(Reply::refused("the name of a move is a word", "letters, digits, - and _ make one"));
    };
    let found = planner
        .with(model, |setting, segments| consider(setting, segments, body))
        .map_err(refusal)?
        .map_err(|troubles| Reply::Refused(reason(&troubles)))?;
    if !found.passes() {
        return Err(Reply::refused(
            "the move exceeds a limit or touches something",
            "it can be kept when nothing is red",
        ));
    }
    let folder = model.parent().unwrap_or(Path::new("")).join(MOVES);
    std::fs::create_dir_all(&folder).map_err(|error| {
        refusal(Failure::unwritable(format!("cannot make `{}`: {error}", folder.display())))
    })?;
    let file: PathBuf = folder.join(format!("{name}.ron"));
    if file.exists() && body["replace"] != true {
        return Err(Reply::refused(
            format!("there is a move `{name}` already"),
            "choose another name, or tick `replace`",
        ));
    }
    let text = found.file();
    let text = blocksim_syntax::format(&text).unwrap_or(text);
    write_file(&file, text.as_bytes(), body["replace"] == true).map_err(refusal)?;
    Ok(format!("{MOVES}/{name}.ron"))
}

/// Whether a name makes a file beside the others, and nothing else.
pub fn is_name(name: &str) -> bool {
    let is_one = Path::new(name).components().collect::<Vec<_>>();
    matches!(is_one.as_slice(), [Component::Normal(_)])
        && name.len() <= 80
        && name.chars().all(|sign| sign.is_alphanumeric() || "-_".contains(sign))
}

/// A move or a sequence that was kept, as the fields of the form.
pub fn kept(model: &Path, name: &str) -> Reply {
    if !moves(model).iter().any(|known| known == name) {
        return Reply::Missing;
    }
    let file = model.parent().unwrap_or(Path::new("")).join(name);
    let disk = Disk::default();
    let read: Result<JointPath, _> = parameter(&Sources::new(&disk), &file, &[], "move");
    let path = match read {
        Ok(path) => path,
        Err(problems) => return refusal(Failure::of(Exit::Model, problems, Vec::new())),
    };
    let robot = match robot(&common(model)) {
        Ok((robot, _)) => robot,
        Err(failure) => return refusal(failure),
    };
    let fields = disk.read(&file).and_then(|text| fields::of_file(&text, &path, &robot.limits()));
    fields.map_or_else(
        |reason| {
            Reply::refused(
                format!("`{name}` cannot be edited here: {reason}"),
                "change it in an editor; `blocksim plan sequence` checks it",
            )
        },
        Reply::Data,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_cannot_lead_elsewhere() {
        assert!(is_name("pick") && is_name("heb-an_2") && is_name("größer"));
        for bad in ["", "..", "a/b", "a\\b", ".hidden", "a b", "a.ron", "/etc"] {
            assert!(!is_name(bad), "{bad}");
        }
    }
}
