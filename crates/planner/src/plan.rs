//! A move of the tool along a path.

use blocksim_motion::{Path, PathError};
use blocksim_multibody::{EulerZyx, Placement};
use blocksim_robot::Robot;

use crate::course::{Course, Narrow, State};
use crate::error::{PlanError, Reason};
use crate::joint_path::{JointPath, MOST};
use crate::law::TimeLaw;
use crate::phase_plane::{Bounds, Knot, time_optimal};
use crate::request::{CartesianRequest, Orientation, Speeds, Timing};
use crate::start::{begin, reach, refusal};
use crate::task::Task;

/// Places along the path that are tried before it is followed.
const COARSE: usize = 20;

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
        let (q, start) = begin(robot, &request.start)?;
        let path = path(&start, request)?;
        let spacing = request.resolution;
        let count = path.length() / spacing;
        // not so for NaN
        let few = count <= MOST as f64;
        if !few {
            return Err(PlanError::new("resolution", Reason::TooManyWaypoints { count, most: MOST }));
        }
        let task = match request.orientation {
            Orientation::Free => Task::Point,
            Orientation::Axis => Task::axis(&start),
            Orientation::Fixed | Orientation::Interpolated(_) => Task::Pose,
        };
        if task == Task::Pose {
            try_out(robot, &path, &q)?;
        }
        let joints = JointPath::follow(robot, &task, &path, &q, spacing)?;
        let law = law(robot, &joints, &path, &request.speeds, acceleration)?;
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

    fn way(&self, t: f64) -> Option<(f64, f64)> {
        Some((self.path.length(), self.law.at(t)[0]))
    }

    fn narrowest(&self) -> Option<Narrow> {
        Some(self.narrow)
    }
}

/// Checks what can be checked before anything is solved; the acceleration, m/s².
fn check(robot: &Robot, request: &CartesianRequest) -> Result<f64, PlanError> {
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

/// The path from where the tool is.
fn path(start: &Placement, request: &CartesianRequest) -> Result<Path, PlanError> {
    let rotation = match request.orientation {
        Orientation::Interpolated(rotation) => rotation,
        _ => start.rotation,
    };
    let end = Placement { rotation, translation: request.target };
    let path = match request.via {
        Some(via) => Path::arc(*start, via, end),
        None => Path::line(*start, end),
    };
    let path = path.map_err(|error| match error {
        PathError::Nothing => PlanError::new("target", Reason::Nothing),
        PathError::Straight => PlanError::new("via", Reason::Straight),
        PathError::NotFinite => PlanError::new("target", Reason::NotFinite),
    })?;
    // A micrometre: less is the same place for a robot.
    match path.is_turn() || path.length() < 1e-6 {
        true => Err(PlanError::new("target", Reason::Nothing)),
        false => Ok(path),
    }
}

/// Whether the arm reaches some places of the path at all, where there is a closed form.
fn try_out(robot: &Robot, path: &Path, q: &[f64]) -> Result<(), PlanError> {
    for k in 0..=COARSE {
        let at = k as f64 / COARSE as f64;
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
    speeds: &Speeds,
    acceleration: f64,
) -> Result<TimeLaw, PlanError> {
    let (length, v) = (path.length(), speeds.velocity);
    let law = match speeds.timing {
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
            let curvature = |k: usize| path.at(joints.place(k)).curvature.norm();
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
    Narrow { margin, t: law.time_of(joints.place(k)) }
}

/// Position (m) of a placement and its ZYX Euler angles (rad), as people write it.
pub fn pose(placement: &Placement) -> ([f64; 3], EulerZyx) {
    (placement.translation.into(), EulerZyx::from_rotation(&placement.rotation))
}
