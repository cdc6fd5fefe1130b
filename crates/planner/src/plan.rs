//! A move of the tool along a path.

use blocksim_motion::{Path, PathError};
use blocksim_multibody::{EulerZyx, Placement};
use blocksim_robot::Robot;

use crate::configuration::choose;
use crate::course::{Course, Narrow, State, Way};
use crate::error::{PlanError, Reason};
use crate::joint_path::{JointPath, MOST};
use crate::law::TimeLaw;
use crate::phase_plane::{Bounds, Knot, time_optimal};
use crate::request::{CartesianRequest, Orientation, Speeds, Start, Timing, Turning};
use crate::start::{begin, reach, refusal};
use crate::task::Task;
use crate::workspace::Workspace;

/// Places along the path that are tried before it is followed.
const PLACES: usize = 200;

/// Distance of waypoints of a turn on the spot, rad.
pub(crate) const TURN_SPACING: f64 = 0.5 * std::f64::consts::PI / 180.0;

/// A move of the tool along a line or an arc, from rest to rest.
///
/// Position, speed and acceleration of the axes belong together: with q(s) along the path and s(t),
/// $\dot q = q' \dot s$ and $\ddot q = q'' \dot s^2 + q' \ddot s$.
#[derive(Debug, Clone, PartialEq)]
pub struct CartesianMove {
    path: Path,
    joints: JointPath,
    law: TimeLaw,
    narrow: Narrow,
}

impl CartesianMove {
    /// Plans a move.
    ///
    /// # Errors
    /// [`PlanError`] names the member of the request, what is wrong, its place on the path, and a remedy. Limits that
    /// are exceeded on the way are no errors here: see [`inspect`](crate::inspect).
    pub fn plan(robot: &Robot, request: &CartesianRequest) -> Result<CartesianMove, PlanError> {
        let acceleration = check(robot, request)?;
        let (q, start) = match request.start {
            Start::Joints(_) => begin(robot, &request.start)?,
            _ => begin(robot, &Start::Joints(choose(robot, request, None)?.q))?,
        };
        let path = path(&start, request)?;
        let spacing = if path.is_turn() { TURN_SPACING } else { request.resolution };
        let task = task(request, &start);
        reachable(robot, &task, &path)?;
        if task == Task::Pose {
            try_out(robot, &path, &q)?;
        }
        let joints = JointPath::follow(robot, &task, &path, &q, spacing)?;
        let law = law(robot, &joints, &path, request, acceleration)?;
        let narrow = narrowest(&joints, &law);
        Ok(CartesianMove { path, joints, law, narrow })
    }

    /// The path of the tool in the reference.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The positions of the axes along it.
    pub fn joints(&self) -> &JointPath {
        &self.joints
    }

    /// Length over time.
    pub fn law(&self) -> &TimeLaw {
        &self.law
    }
}

impl Course for CartesianMove {
    fn axes(&self) -> usize {
        self.joints.axes()
    }

    fn duration(&self) -> f64 {
        self.law.duration()
    }

    fn at(&self, axis: usize, t: f64) -> State {
        let [s, v, a] = self.law.at(t);
        let [q, first, second] = self.joints.at(axis, s);
        [q, first * v, second * v * v + first * a]
    }

    fn seams(&self) -> Vec<f64> {
        self.law.seams()
    }

    fn way(&self, t: f64) -> Option<Way> {
        Some(Way { length: self.path.length(), done: self.law.at(t)[0], turn: self.path.is_turn() })
    }

    fn narrowest(&self) -> Option<Narrow> {
        Some(self.narrow)
    }
}

/// Checks what can be checked before anything is solved; the acceleration, m/s².
pub(crate) fn check(robot: &Robot, request: &CartesianRequest) -> Result<f64, PlanError> {
    let limits = robot.tcp_limits();
    let range = |member, value: f64, lower: f64, upper: f64, unit: &'static str| {
        if !value.is_finite() {
            return Err(PlanError::new(member, Reason::NotFinite));
        }
        match value > 0.0 && value <= upper * (1.0 + 1e-12) {
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
pub(crate) fn task(request: &CartesianRequest, start: &Placement) -> Task {
    match request.orientation {
        Orientation::Free => Task::Point,
        Orientation::Axis => Task::axis(start),
        Orientation::Fixed | Orientation::Interpolated(_) => Task::Pose,
    }
}

/// The path from where the tool is.
pub(crate) fn path(start: &Placement, request: &CartesianRequest) -> Result<Path, PlanError> {
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
pub(crate) fn reachable(robot: &Robot, task: &Task, path: &Path) -> Result<(), PlanError> {
    const SLACK: f64 = 1e-9;
    let workspace = Workspace::of(robot);
    let length = path.length();
    let shortage = |way: f64| workspace.shortage(task, &path.at(way).placement);
    let distance = shortage(length);
    if distance > SLACK {
        let reason = Reason::Unreachable { at: 1.0, way: length, distance: Some(distance) };
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
    let reason = Reason::Unreachable { at: outside / length, way: outside, distance: Some(furthest) };
    Err(PlanError::new("path", reason))
}

/// Whether the arm reaches some places of the path at all, where there is a closed form.
fn try_out(robot: &Robot, path: &Path, q: &[f64]) -> Result<(), PlanError> {
    for k in 0..=PLACES {
        let at = k as f64 / PLACES as f64;
        let way = at * path.length();
        match reach(robot, &path.at(way).placement, q) {
            Some(Err(error)) => return Err(PlanError::new("path", refusal(&error, at, way))),
            Some(Ok(_)) => {}
            None => break,
        }
    }
    Ok(())
}

fn law(
    robot: &Robot,
    joints: &JointPath,
    path: &Path,
    request: &CartesianRequest,
    acceleration: f64,
) -> Result<TimeLaw, PlanError> {
    let length = path.length();
    let Speeds { velocity, timing, .. } = request.speeds;
    let (v, acceleration, timing) = match (path.is_turn(), timing) {
        (false, timing) => (velocity, acceleration, timing),
        (true, timing) => {
            let Turning { velocity, acceleration } = request.turning;
            // as of a line without a jerk of its own: the acceleration is reached in 0.1 s
            let turning = match timing {
                Timing::SCurve { .. } => Timing::SCurve { jerk: 10.0 * acceleration },
                other => other,
            };
            (velocity, acceleration, turning)
        }
    };
    let law = match timing {
        Timing::Sin2 => TimeLaw::sin2(length, v, acceleration),
        Timing::Trapezoid => TimeLaw::jerk_limited(length, v, acceleration, f64::INFINITY),
        Timing::SCurve { jerk } => TimeLaw::jerk_limited(length, v, acceleration, jerk),
        Timing::TimeOptimal => {
            let n = joints.intervals();
            let step = length / n as f64;
            let knot = |k, axis| {
                let [_, first, second] = joints.knot(k, axis);
                Knot { first, second }
            };
            let curvatures: Vec<f64> = (0..=n).map(|k| path.at(joints.place(k)).curvature.norm()).collect();
            let curvature = |k: usize| curvatures[k];
            let bounds = Bounds { axes: robot.limits(), speed: v, acceleration };
            time_optimal(n, step, knot, curvature, &bounds).map(|squares| TimeLaw::phases(step, &squares))
        }
    };
    law.ok_or(PlanError::new("velocity", Reason::NotFinite))
}

fn narrowest(joints: &JointPath, law: &TimeLaw) -> Narrow {
    let margins = (0..=joints.intervals()).map(|k| (k, joints.margin(k)));
    let (k, margin) =
        margins.fold((0, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best });
    let t = match k {
        0 => 0.0,
        k if k == joints.intervals() => law.duration(),
        k => law.time_of(joints.place(k)),
    };
    Narrow { margin, t }
}

/// Position (m) of a placement and its ZYX Euler angles (rad), as people write it.
pub fn pose(placement: &Placement) -> ([f64; 3], EulerZyx) {
    (placement.translation.into(), EulerZyx::from_rotation(&placement.rotation))
}
