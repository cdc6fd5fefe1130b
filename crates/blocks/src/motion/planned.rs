//! From what a file says of a move to the move.

use std::sync::Arc;

use blocksim_block::in_unit::AxisValue;
use blocksim_block::prelude::*;
use blocksim_robotics::motion::{
    AxisKind, AxisLimits, Endpoint, JointMove, JointMoveRequest, MoveError, Synchronisation,
};
use blocksim_robotics::planner::{
    CartesianMove, Course, PlanError, Reason, Sequence, SequenceError, Start, Step,
};
use blocksim_robotics::robot::Robot;

use super::joint_path::{JointPath, NextMove, Rule};
use super::limits::of_kinds;
use super::timed::check_singular_limit;
use super::tool_path::ToolPath;

/// Plans what a file asks for. `limits` are those of joint moves; a robot is needed where its tool follows a path.
/// `param` is the path of the set, for messages.
///
/// # Errors
/// The member at fault, what is wrong, and what helps.
pub fn planned(
    path: &JointPath,
    limits: &[AxisLimits],
    rule: Rule,
    robot: Option<&Robot>,
    param: &str,
) -> Result<Arc<dyn Course>, ParamError> {
    replanned(path, limits, rule, robot, param, &mut Segments::default())
}

/// Moves of one robot that have been planned: those that have not changed are not planned again, and the result is the
/// same. For whoever plans while somebody types.
#[derive(Debug, Default)]
pub struct Segments {
    /// All that a move follows from beside the robot, and the move; those that were used last are at the end.
    known: Vec<(String, Arc<dyn Course>)>,
    row: Vec<Arc<dyn Course>>,
}

impl Segments {
    /// How many moves are kept.
    const KEPT: usize = 64;

    /// The moves of what was planned last, in their order: up to the first one that cannot be planned.
    pub fn row(&self) -> &[Arc<dyn Course>] {
        &self.row
    }

    /// Nothing was planned last.
    pub fn forget_row(&mut self) {
        self.row.clear();
    }

    fn course(
        &mut self,
        key: String,
        plan: impl FnOnce() -> Result<Arc<dyn Course>, ParamError>,
    ) -> Result<Arc<dyn Course>, ParamError> {
        let known = self.known.iter().position(|(known, _)| *known == key);
        let course = match known {
            Some(n) => self.known.remove(n).1,
            None => plan()?,
        };
        self.row.push(Arc::clone(&course));
        self.known.push((key, Arc::clone(&course)));
        if self.known.len() > Self::KEPT {
            self.known.remove(0);
        }
        Ok(course)
    }
}

/// Plans as [`planned`] does, but takes moves from those that are known. These must be of the same robot.
///
/// # Errors
/// As [`planned`].
pub fn replanned(
    path: &JointPath,
    limits: &[AxisLimits],
    rule: Rule,
    robot: Option<&Robot>,
    param: &str,
    segments: &mut Segments,
) -> Result<Arc<dyn Course>, ParamError> {
    segments.row.clear();
    check_singular_limit(path, param)?;
    let joints = (!path.target.is_empty(), path.velocity, path.acceleration);
    check_one_kind(path.tool.is_some(), joints, param)?;
    let first = match &path.tool {
        Some(tool) => Segment::Tool(tool),
        None => Segment::Joint(&path.target, path.velocity, path.acceleration),
    };
    let kinds: Vec<AxisKind> = limits.iter().map(|limits| limits.kind).collect();
    let mut start = of_kinds(&path.start, &kinds, &format!("{param}.start"))?;
    if path.moves.is_empty() && path.wait != 0.0 {
        return Err(ParamError::new(format!("{param}.wait"), "there is no move behind the wait")
            .help("leave it out, or give `moves`; a block that starts later has a `delay`"));
    }
    // With a zone it is a sequence of one move, which has a note of that.
    if path.moves.is_empty() && path.zone == 0.0 {
        return known_or_planned(&first, &start, limits, rule, robot, param, segments);
    }
    let robot = robot.ok_or_else(|| {
        no_robot(&format!("{param}.{}", if path.moves.is_empty() { "zone" } else { "moves" }))
    })?;
    let mut steps: Vec<Step> = Vec::new();
    steps.push(Step {
        course: known_or_planned(&first, &start, limits, rule, Some(robot), param, segments)?,
        zone: path.zone,
        wait: path.wait,
    });
    for (i, next) in path.moves.iter().enumerate() {
        let place = format!("{param}.moves[{i}]");
        let joints = (!next.target.is_empty(), next.velocity, next.acceleration);
        check_one_kind(next.tool.is_some(), joints, &place)?;
        if let Some(last) = steps.last() {
            start = last.course.positions(last.course.duration());
        }
        let course = known_or_planned(&next.segment(), &start, limits, rule, Some(robot), &place, segments)?;
        steps.push(Step { course, zone: next.zone, wait: next.wait });
    }
    let sequence = Sequence::join(robot, steps).map_err(|error| {
        let (step, member) = match error {
            SequenceError::Zone { step } => (step, ".zone"),
            SequenceError::Wait { step, .. } => (step, ".wait"),
            SequenceError::Gap { step, .. } => (step, ""),
            SequenceError::Empty => (0, ""),
        };
        let place = match step.checked_sub(1) {
            None => format!("{param}{member}"),
            Some(next) => format!("{param}.moves[{next}]{member}"),
        };
        split(place, &error.to_string())
    })?;
    Ok(Arc::new(sequence))
}

#[derive(Debug)]
enum Segment<'a> {
    Tool(&'a ToolPath),
    Joint(&'a [AxisValue], Option<f64>, Option<f64>),
}

impl NextMove {
    fn segment(&self) -> Segment<'_> {
        match &self.tool {
            Some(tool) => Segment::Tool(tool),
            None => Segment::Joint(&self.target, self.velocity, self.acceleration),
        }
    }
}

/// A move is one of the joints or one of the tool: of both, one would have no effect.
fn check_one_kind(
    has_tool: bool,
    (has_target, velocity, acceleration): (bool, Option<f64>, Option<f64>),
    param: &str,
) -> Result<(), ParamError> {
    let given =
        [("target", has_target), ("velocity", velocity.is_some()), ("acceleration", acceleration.is_some())];
    match given.into_iter().find(|(_, is_given)| *is_given && has_tool) {
        None => Ok(()),
        Some((member, _)) => {
            let message = format!("`{member}` is of a move of the joints, and this is one of the tool");
            let help = format!(
                "leave out `tool` or `{member}`; the tool's own members stand in `tool: (target: .., velocity: ..)`"
            );
            Err(ParamError::new(format!("{param}.{member}"), message).help(help))
        }
    }
}

fn no_robot(param: &str) -> ParamError {
    ParamError::new(param, "a move of the tool needs a robot")
        .help("give the block the robot, as in robot: \"manipulator\"")
}

fn known_or_planned(
    what: &Segment,
    start: &[f64],
    limits: &[AxisLimits],
    rule: Rule,
    robot: Option<&Robot>,
    param: &str,
    segments: &mut Segments,
) -> Result<Arc<dyn Course>, ParamError> {
    // This text has every digit of every number, and the sign of a zero.
    let key = format!("{what:?} {start:?} {limits:?} {rule:?}");
    segments.course(key, || segment(what, start, limits, rule, robot, param))
}

fn segment(
    what: &Segment,
    start: &[f64],
    limits: &[AxisLimits],
    rule: Rule,
    robot: Option<&Robot>,
    param: &str,
) -> Result<Arc<dyn Course>, ParamError> {
    match what {
        Segment::Tool(tool) => {
            let place = format!("{param}.tool");
            let robot = robot.ok_or_else(|| no_robot(&place))?;
            let request =
                tool.request(Start::Joints(start.to_vec()), robot.tcp_limits().acceleration, &place)?;
            let planned = CartesianMove::plan(robot, &request).map_err(|error| refused(&error, param))?;
            Ok(Arc::new(planned))
        }
        Segment::Joint(target, velocity, acceleration) => {
            let missing = |member: &str| {
                ParamError::new(param, format!("`{member}` is missing"))
                    .help("a joint move has start, target, velocity and acceleration; a move of the tool has `tool`")
            };
            if target.is_empty() {
                return Err(missing("target"));
            }
            let kinds: Vec<AxisKind> = limits.iter().map(|limits| limits.kind).collect();
            let request = JointMoveRequest {
                start: start.to_vec(),
                target: of_kinds(target, &kinds, &format!("{param}.target"))?,
                velocity: velocity.ok_or_else(|| missing("velocity"))?,
                acceleration: acceleration.ok_or_else(|| missing("acceleration"))?,
                rule: match rule {
                    Rule::Feasible => Synchronisation::Feasible,
                    Rule::AsPrinted => Synchronisation::AsPrinted,
                },
            };
            let planned = JointMove::plan(&request, limits);
            Ok(Arc::new(planned.map_err(|error| split(guilty(&error, param), &error.to_string()))?))
        }
    }
}

/// The refusal of a planner as the error of a parameter.
pub fn refused(error: &PlanError, param: &str) -> ParamError {
    let place = match (&error.reason, error.member) {
        (Reason::StartOutside { axis, .. }, _) => format!("{param}.start[{axis}]"),
        (_, "start" | "configuration") => format!("{param}.start"),
        (_, "path" | "tcp_limits.acceleration") => format!("{param}.tool"),
        (_, member) => format!("{param}.tool.{member}"),
    };
    ParamError::new(place, error.to_string()).help(error.help())
}

/// An error whose message has its remedy behind a semicolon.
fn split(place: String, text: &str) -> ParamError {
    match text.split_once("; ") {
        Some((fact, remedy)) => ParamError::new(place, fact).help(remedy),
        None => ParamError::new(place, text),
    }
}

/// The parameter that a plan of a joint move failed for.
fn guilty(error: &MoveError, param: &str) -> String {
    let side = |endpoint: Endpoint| match endpoint {
        Endpoint::Start => format!("{param}.start"),
        Endpoint::Target => format!("{param}.target"),
    };
    match *error {
        MoveError::NoAxes => "limits".to_owned(),
        MoveError::WrongLength { endpoint, .. } => side(endpoint),
        MoveError::NotFinite { endpoint, axis, .. } | MoveError::OutsideLimits { endpoint, axis, .. } => {
            format!("{}[{axis}]", side(endpoint))
        }
        MoveError::NothingToMove => format!("{param}.target"),
        MoveError::VelocityShare { .. } => format!("{param}.velocity"),
        MoveError::AccelerationShare { .. } => format!("{param}.acceleration"),
        MoveError::LimitsCrossed { axis, .. } => format!("limits[{axis}].upper"),
        MoveError::SpeedLimit { axis, .. } => format!("limits[{axis}].speed"),
        MoveError::AccelerationLimit { axis, .. } => format!("limits[{axis}].acceleration"),
        MoveError::NotComputable { axis, .. } => format!("{param}.target[{axis}]"),
    }
}
