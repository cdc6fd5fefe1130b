//! What a request prescribes: the path of the tool and what of it, checked before anything is followed.

use crate::motion::{Path, PathError};
use crate::robot::Robot;
use blocksim_multibody::Placement;

use crate::planner::course::Way;
use crate::planner::error::{PlanError, Reason};
use crate::planner::joint_path::MOST;
use crate::planner::request::{CartesianRequest, Orientation, Speeds, Timing};
use crate::planner::task::Task;
use crate::planner::workspace::Workspace;

/// Places along the path that are tried before it is followed.
pub(crate) const PLACES: usize = 200;

/// Distance of waypoints of a turn on the spot, rad.
const TURN_SPACING: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// What the tool shall do from its start.
pub(crate) struct Prescribed {
    /// Where it goes, in the reference.
    pub path: Path,
    /// What of it is prescribed.
    pub task: Task,
    /// Distance of waypoints, m; of a turn on the spot, rad.
    pub spacing: f64,
}

impl Prescribed {
    /// The path of a request from where the tool is, all of it within the workspace.
    pub fn of(robot: &Robot, request: &CartesianRequest, start: &Placement) -> Result<Prescribed, PlanError> {
        let (path, task) = (path(start, request)?, task(request, start));
        reachable(robot, &task, &path)?;
        let spacing = if path.is_turn() { TURN_SPACING } else { request.resolution };
        Ok(Prescribed { path, task, spacing })
    }
}

/// Checks what can be checked before anything is solved; the acceleration, m/s².
pub(crate) fn check(robot: &Robot, request: &CartesianRequest) -> Result<f64, PlanError> {
    let limits = robot.tcp_limits();
    let range = |member, value: f64, lower: f64, upper: f64, unit: &'static str| {
        if !value.is_finite() {
            return Err(PlanError::new(member, Reason::NotFinite));
        }
        match value >= lower * (1.0 - 1e-12) && value <= upper * (1.0 + 1e-12) {
            true => Ok(()),
            false => Err(PlanError::new(member, Reason::OutOfRange { value, lower, upper, unit })),
        }
    };
    let Speeds { velocity, acceleration, timing } = request.speeds;
    range("velocity", 1e3 * velocity, 1e-3, 1e3 * limits.speed, "mm/s")?;
    range("acceleration", 1e2 * acceleration, 1e-3, 1e2, "%")?;
    range("resolution", 1e3 * request.resolution, 1e-3, 1e4, "mm")?;
    if let Timing::SCurve { jerk } = timing {
        range("jerk", jerk, 1e-3, 1e9, "m/s^3")?;
    }
    range("rotation_velocity", request.turning.velocity.to_degrees(), 1e-3, 1e5, "deg/s")?;
    range("rotation_acceleration", request.turning.acceleration.to_degrees(), 1e-3, 1e6, "deg/s^2")?;
    let acceleration = acceleration * limits.acceleration;
    if !acceleration.is_finite() {
        return Err(PlanError::new("tcp_limits.acceleration", Reason::NotFinite));
    }
    let finite = |member, values: &[f64]| match values.iter().all(|x| x.is_finite()) {
        true => Ok(()),
        false => Err(PlanError::new(member, Reason::NotFinite)),
    };
    finite("target", request.target.as_slice())?;
    if let Orientation::Interpolated(rotation) = request.orientation {
        finite("target", rotation.as_slice())?;
    }
    finite("via", request.via.as_ref().map_or(&[], |via| via.as_slice()))?;
    Ok(acceleration)
}

/// What of the tool is prescribed.
fn task(request: &CartesianRequest, start: &Placement) -> Task {
    match request.orientation {
        Orientation::Free => Task::Point,
        Orientation::Axis => Task::axis(start),
        Orientation::Fixed | Orientation::Interpolated(_) => Task::Pose,
    }
}

/// The path from where the tool is.
fn path(start: &Placement, request: &CartesianRequest) -> Result<Path, PlanError> {
    let rotation = match request.orientation {
        Orientation::Interpolated(rotation) => rotation,
        _ => start.rotation,
    };
    // A micrometre: less is the same place for a robot.
    const SAME: f64 = 1e-6;
    let rests = (request.target - start.translation).norm() < SAME;
    let end = Placement { rotation, translation: if rests { start.translation } else { request.target } };
    let path = match request.via {
        Some(via) => Path::arc(*start, via, end),
        None => Path::line(*start, end),
    };
    let path = path.map_err(|error| match error {
        PathError::Nothing => PlanError::new("target", Reason::Nothing),
        PathError::Straight => PlanError::new("via", Reason::Straight),
        PathError::NotFinite => PlanError::new("target", Reason::NotFinite),
    })?;
    if path.length() < SAME {
        return Err(PlanError::new("target", Reason::Nothing));
    }
    let count = path.length() / request.resolution;
    // not so for NaN
    let few = path.is_turn() || count <= MOST as f64;
    match few {
        true => Ok(path),
        false => Err(PlanError::new("resolution", Reason::TooManyWaypoints { count, most: MOST })),
    }
}

/// Whether the target is in the workspace, and all places on the way there; whatever the limits of the axes.
fn reachable(robot: &Robot, task: &Task, path: &Path) -> Result<(), PlanError> {
    const SLACK: f64 = 1e-9;
    let workspace = Workspace::of(robot);
    let length = path.length();
    let shortage = |way: f64| workspace.shortage(task, &path.at(way).placement);
    let distance = shortage(length);
    if distance > SLACK {
        let way = Way { length, done: length, turn: path.is_turn() };
        let reason = Reason::Unreachable { at: 1.0, way, distance: Some(distance) };
        return Err(PlanError::new("target", reason));
    }
    let place = |k: usize| length * (k as f64 / PLACES as f64);
    let Some(first) = (0..=PLACES).find(|k| shortage(place(*k)) > SLACK) else { return Ok(()) };
    let (mut inside, mut outside) = (place(first.saturating_sub(1)), place(first));
    for _ in 0..30 {
        let middle = 0.5 * (inside + outside);
        if shortage(middle) > SLACK { outside = middle } else { inside = middle }
    }
    let furthest = (first..=PLACES).map(|k| shortage(place(k))).fold(0.0, f64::max);
    let way = Way { length, done: outside, turn: path.is_turn() };
    let reason = Reason::Unreachable { at: outside / length, way, distance: Some(furthest) };
    Err(PlanError::new("path", reason))
}
