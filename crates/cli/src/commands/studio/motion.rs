//! Moves of the robot of a model: planned while one types, looked at along their whole way, kept as files.

use std::path::{Component, Path, PathBuf};

use blocksim_blocks::motion::JointPath;
use blocksim_blocks::robotics::Seat;
use blocksim_diagram::{Sources, has_parameter, parameter};
use blocksim_motion::{AxisKind, AxisLimits};
use blocksim_studio::Reply;
use serde_json::{Value, json};

use super::values::refusal;
use crate::args::plan::{CircularArgs, FromArgs, JointArgs, LinearArgs, PlanCommand, PlanCommon, ToolArgs};
use crate::commands::plan::{Considered, consider, robot};
use crate::disk::{Disk, write_file};
use crate::failure::Failure;

/// Instants of a move that the page draws.
const DRAWN: usize = 300;
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
        Ok((robot, _)) => Ok(plural_axes(robot.limits().len())),
        Err(failure) => Err(failure.message()),
    })
}

fn plural_axes(count: usize) -> String {
    if count == 1 { "1 axis".to_owned() } else { format!("{count} axes") }
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

/// What was asked, as the command line of `blocksim plan`: fields as typed, a decimal comma where a number alone has one.
fn command(model: &Path, body: &Value) -> Result<PlanCommand, Reply> {
    let field =
        |name: &str| body[name].as_str().map(|text| text.trim().to_owned()).filter(|text| !text.is_empty());
    let list = |name: &str, what: &str| -> Result<String, Reply> {
        let values = body[name].as_array().map(Vec::as_slice).unwrap_or_default();
        let words: Vec<String> =
            values.iter().map(|value| number(value.as_str().unwrap_or_default())).collect();
        match words.iter().position(String::is_empty) {
            Some(n) => Err(Reply::refused(format!("{what}: value {} is missing", n + 1), "fill all fields")),
            None if words.is_empty() => Err(Reply::refused(format!("{what} is missing"), "fill all fields")),
            None => Ok(words.join(", ")),
        }
    };
    let one = |name: &str, otherwise: &str| number(&field(name).unwrap_or_else(|| otherwise.to_owned()));
    let common = common(model);
    let start = list("from", "the start")?;
    match body["kind"].as_str() {
        Some("joint") => Ok(PlanCommand::Joint(JointArgs {
            common,
            from: FromArgs { from: Some(start) },
            to: list("to", "the target")?,
            velocity: one("velocity", "40 %"),
            acceleration: one("acceleration", "30 %"),
        })),
        Some(kind @ ("linear" | "circular")) => {
            let tool = ToolArgs {
                common,
                from: FromArgs { from: Some(start) },
                from_point: None,
                from_rotation: None,
                configuration: None,
                to: list("point", "the target")?,
                orientation: one("orientation", "free"),
                rotation: None,
                velocity: one("speed", "250 mm/s"),
                acceleration: one("share", "20 %"),
                rotation_velocity: None,
                rotation_acceleration: None,
                profile: one("profile", "sin2"),
                resolution: one("resolution", "1 mm"),
                singular_limit: None,
            };
            Ok(match kind {
                "linear" => PlanCommand::Linear(LinearArgs { tool }),
                _ => PlanCommand::Circular(CircularArgs { tool, via: list("via", "the point in between")? }),
            })
        }
        _ => Err(Reply::refused("a move is joint, linear or circular", "")),
    }
}

/// A number as typed, with a point in the place of a decimal comma.
fn number(text: &str) -> String {
    let text = text.trim();
    let pointed = text.replacen(',', ".", 1);
    let is_number = |text: &str| text.split(' ').next().is_some_and(|number| number.parse::<f64>().is_ok());
    if text.matches(',').count() == 1 && !text.contains('.') && is_number(&pointed) {
        pointed
    } else {
        text.to_owned()
    }
}

/// Plans a move. A move that cannot be planned is a normal answer, with the reason, not a failed request.
pub fn plan(model: &Path, body: &Value) -> Reply {
    let found = command(model, body).and_then(|command| consider(&command).map_err(refusal));
    match found {
        Ok(found) => Reply::Data(told(&found)),
        Err(Reply::Refused(reason)) => Reply::Data(json!({ "refused": reason })),
        Err(other) => other,
    }
}

fn told(found: &Considered) -> Value {
    let mut data = found.data();
    let course = found.course.as_ref();
    let times: Vec<f64> = (0..=DRAWN).map(|n| course.duration() * n as f64 / DRAWN as f64).collect();
    let of_axis = |axis: usize| {
        let states: Vec<_> = times.iter().map(|t| course.at(axis, *t)).collect();
        let kind = found.robot.limits()[axis].kind;
        let speed = found.robot.limits()[axis].speed;
        json!({
            "q": states.iter().map(|[q, ..]| *q).collect::<Vec<_>>(),
            "shown": states.iter().map(|[q, ..]| kind.shown(*q)).collect::<Vec<_>>(),
            "speed": states.iter().map(|[_, v, _]| 100.0 * v / speed).collect::<Vec<_>>(),
        })
    };
    data["times"] = times.clone().into();
    data["course"] = (0..course.axes()).map(of_axis).collect();
    data["passes"] = found.passes().into();
    data["collision"] =
        found.collision().map_or(Value::Null, |[what, help]| json!({ "what": what, "help": help }));
    data
}

/// Keeps a move as a file beside the model; returns how the model would name it.
///
/// # Errors
/// What keeps it from being kept.
pub fn save(model: &Path, body: &Value) -> Result<String, Reply> {
    let Some(name) = body["name"].as_str().map(str::trim).filter(|name| is_name(name)) else {
        return Err(Reply::refused("the name of a move is a word", "letters, digits, - and _ make one"));
    };
    let found = consider(&command(model, body)?).map_err(refusal)?;
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
    write_file(&file, found.file().as_bytes(), body["replace"] == true).map_err(refusal)?;
    Ok(format!("{MOVES}/{name}.ron"))
}

/// Whether a name makes a file beside the others, and nothing else.
fn is_name(name: &str) -> bool {
    let is_one = Path::new(name).components().collect::<Vec<_>>();
    matches!(is_one.as_slice(), [Component::Normal(_)])
        && name.len() <= 80
        && name.chars().all(|sign| sign.is_alphanumeric() || "-_".contains(sign))
}

/// A move that was kept, as the fields of the form.
pub fn kept(model: &Path, name: &str) -> Reply {
    if !moves(model).iter().any(|known| known == name) {
        return Reply::Missing;
    }
    let file = model.parent().unwrap_or(Path::new("")).join(name);
    let disk = Disk::default();
    let read: Result<JointPath, _> = parameter(&Sources::new(&disk), &file, &[], "move");
    match read {
        Ok(path) if !path.moves.is_empty() => Reply::refused(
            format!("`{name}` has several moves in a row"),
            "the page plans single moves; `blocksim plan sequence` checks a sequence",
        ),
        Ok(path)
            if path.singular_limit.is_some()
                || path.tool.as_ref().is_some_and(|tool| tool.work_object != Seat::default()) =>
        {
            Reply::refused(
                format!("`{name}` has a work object or a threshold of singular poses of its own"),
                "the page has no fields for these; `blocksim plan sequence` checks such a file",
            )
        }
        Ok(path) => match robot(&common(model)) {
            Ok((robot, _)) => Reply::Data(fields(&path, &robot.limits())),
            Err(failure) => refusal(failure),
        },
        Err(problems) => refusal(Failure::of(crate::exit::Exit::Model, problems, Vec::new())),
    }
}

/// A move as the page has it in its fields.
fn fields(path: &JointPath, limits: &[AxisLimits]) -> Value {
    let short = |value: f64| format!("{}", format!("{value:.9}").parse::<f64>().unwrap_or(value));
    let shown = |values: Vec<f64>| -> Vec<String> {
        values.iter().zip(limits).map(|(value, limits)| short(limits.kind.shown(*value))).collect()
    };
    let percent = |share: f64| format!("{} %", short(100.0 * share));
    let point = |at: [f64; 3]| at.map(|x| short(1e3 * x));
    let mut fields = json!({ "from": shown(path.start_values()) });
    let Some(tool) = &path.tool else {
        fields["kind"] = "joint".into();
        fields["to"] = shown(path.target.iter().map(|position| position.value).collect()).into();
        fields["velocity"] = path.velocity.map(percent).into();
        fields["acceleration"] = path.acceleration.map(percent).into();
        return fields;
    };
    fields["kind"] = if tool.via.is_some() { "circular" } else { "linear" }.into();
    fields["point"] = json!(point(tool.target));
    fields["via"] = tool.via.map(|via| json!(point(via.at))).unwrap_or_default();
    fields["orientation"] = tool.orientation.clone().into();
    fields["profile"] = tool.profile.clone().into();
    fields["speed"] = format!("{} mm/s", short(1e3 * tool.velocity)).into();
    fields["share"] = percent(tool.acceleration).into();
    fields["resolution"] = format!("{} mm", short(1e3 * tool.resolution)).into();
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_comma_is_one_where_it_can_be_nothing_else() {
        assert_eq!(
            ["1,5", "1,5 m", "1.5", "a,b", "1,5,2", "1,000.5"].map(number),
            ["1.5", "1.5 m", "1.5", "a,b", "1,5,2", "1,000.5"]
        );
    }

    #[test]
    fn a_name_cannot_lead_elsewhere() {
        assert!(is_name("pick") && is_name("heb-an_2") && is_name("größer"));
        for bad in ["", "..", "a/b", "a\\b", ".hidden", "a b", "a.ron", "/etc"] {
            assert!(!is_name(bad), "{bad}");
        }
    }
}
