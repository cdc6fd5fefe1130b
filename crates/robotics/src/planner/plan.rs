//! A move of the tool along a path.

use crate::motion::Path;
use crate::robot::Robot;
use blocksim_multibody::{EulerZyx, Placement};

use crate::planner::configuration::choose;
use crate::planner::course::{Course, Narrow, Note, State, Way};
use crate::planner::error::{PlanError, Reason};
use crate::planner::fastest::fastest;
use crate::planner::joint_path::JointPath;
use crate::planner::law::TimeLaw;
use crate::planner::phase_plane::Bounds;
use crate::planner::prescribed::{PLACES, Prescribed, check};
use crate::planner::request::{CartesianRequest, Speeds, Start, Timing, Turning};
use crate::planner::start::{begin, reach, refusal};
use crate::planner::task::Task;

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
    notes: Vec<Note>,
}

impl CartesianMove {
    /// Plans a move.
    ///
    /// # Errors
    /// [`PlanError`] names the member of the request, what is wrong, its place on the path, and a remedy. Limits that
    /// are exceeded on the way are no errors here: see [`inspect`](crate::planner::inspect).
    pub fn plan(robot: &Robot, request: &CartesianRequest) -> Result<CartesianMove, PlanError> {
        let acceleration = check(robot, request)?;
        let (q, start) = match request.start {
            Start::Joints(_) => begin(robot, &request.start)?,
            _ => begin(robot, &Start::Joints(choose(robot, request, None)?.q))?,
        };
        let Prescribed { path, task, spacing } = Prescribed::of(robot, request, &start)?;
        if task == Task::Pose {
            try_out(robot, &path, &q)?;
        }
        let joints = JointPath::follow(robot, &task, &path, &q, spacing)?;
        let law = law(robot, &joints, &path, request, acceleration)?;
        let narrow = narrowest(&joints, &law);
        let notes = slowed(&path, request).into_iter().collect();
        Ok(CartesianMove { path, joints, law, narrow, notes })
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

    fn notes(&self) -> Vec<Note> {
        self.notes.clone()
    }
}

/// Whether the turn of the tool on its way makes it slower than it was to be.
fn slowed(path: &Path, request: &CartesianRequest) -> Option<Note> {
    let (velocity, turning) = (request.speeds.velocity, request.turning.velocity);
    let allowed = turning * path.length() / path.angle();
    let slower = !path.is_turn() && allowed < velocity;
    slower.then_some(Note::Turning { step: None, velocity, allowed, turning, t: 0.0 })
}

/// Whether the arm reaches some places of the path at all, where there is a closed form.
fn try_out(robot: &Robot, path: &Path, q: &[f64]) -> Result<(), PlanError> {
    for k in 0..=PLACES {
        let at = k as f64 / PLACES as f64;
        let way = Way { length: path.length(), done: at * path.length(), turn: path.is_turn() };
        match reach(robot, &path.at(way.done).placement, q) {
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
    let Turning { velocity: turn_velocity, acceleration: turn_acceleration } = request.turning;
    let (v, acceleration, timing) = match (path.is_turn(), timing) {
        (false, timing) => {
            // For one metre the orientation turns by this angle; zero makes both bounds infinite.
            let turn = path.angle() / length;
            (velocity.min(turn_velocity / turn), acceleration.min(turn_acceleration / turn), timing)
        }
        (true, timing) => {
            // as of a line without a jerk of its own: the acceleration is reached in 0.1 s
            let turning = match timing {
                Timing::SCurve { .. } => Timing::SCurve { jerk: 10.0 * turn_acceleration },
                other => other,
            };
            (turn_velocity, turn_acceleration, turning)
        }
    };
    let law = match timing {
        Timing::Sin2 => TimeLaw::sin2(length, v, acceleration),
        Timing::Trapezoid => TimeLaw::jerk_limited(length, v, acceleration, f64::INFINITY),
        Timing::SCurve { jerk } => TimeLaw::jerk_limited(length, v, acceleration, jerk),
        Timing::TimeOptimal => {
            let bounds = Bounds { axes: robot.limits(), speed: v, acceleration };
            fastest(joints, path, &bounds)
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
