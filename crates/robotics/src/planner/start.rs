//! Joint positions in which a move begins.

use crate::kinematics::{Constraint, InverseError, Options, Solver, Status};
use crate::robot::Robot;
use blocksim_multibody::Placement;

use crate::planner::arm::Arm;
use crate::planner::course::Way;
use crate::planner::error::{PlanError, Reason};
use crate::planner::request::Start;
use crate::planner::task::Task;
use crate::planner::workspace::Workspace;

/// A position that went through degrees or millimetres and back is off by a few 1e-16.
const SLACK: f64 = 1e-9;

/// Positions of the axes at the start, and where the tool then is.
pub(crate) fn begin(robot: &Robot, start: &Start) -> Result<(Vec<f64>, Placement), PlanError> {
    let fail = |reason| Err(PlanError::new("start", reason));
    let numbers: Vec<f64> = match start {
        Start::Joints(q) => q.clone(),
        Start::Pose(at) => at.translation.iter().chain(at.rotation.iter()).copied().collect(),
        Start::Point(at) => at.iter().copied().collect(),
    };
    if !numbers.iter().all(|x| x.is_finite()) {
        return fail(Reason::NotFinite);
    }
    let q = match start {
        Start::Joints(q) if q.len() != robot.axes() => {
            return fail(Reason::WrongLength { given: q.len(), axes: robot.axes() });
        }
        Start::Joints(q) => q.clone(),
        Start::Pose(at) => {
            within(robot, &Task::Pose, at)?;
            posed(robot, at)?
        }
        Start::Point(at) => {
            within(robot, &Task::Point, &Placement { translation: *at, ..Placement::identity() })?;
            solved(robot, &[Constraint::position(robot.tool(), robot.reference(), *at)])?
        }
    };
    for (axis, (value, limits)) in q.iter().zip(robot.limits()).enumerate() {
        let (lower, upper) = (limits.lower, limits.upper);
        if *value < lower - SLACK || *value > upper + SLACK {
            return fail(Reason::StartOutside { axis, kind: limits.kind, value: *value, lower, upper });
        }
    }
    let mut arm = Arm::new(robot);
    arm.look(&q);
    Ok((q, arm.tool))
}

/// Whether a place is in the workspace of the arm, whatever the limits of the axes.
fn within(robot: &Robot, task: &Task, at: &Placement) -> Result<(), PlanError> {
    let distance = Workspace::of(robot).shortage(task, at);
    match distance > 1e-9 {
        true => {
            let reason = Reason::Unreachable { at: 0.0, way: Way::START, distance: Some(distance) };
            Err(PlanError::new("start", reason))
        }
        false => Ok(()),
    }
}

fn posed(robot: &Robot, at: &Placement) -> Result<Vec<f64>, PlanError> {
    match reach(robot, at, &robot.start()) {
        Some(Ok(q)) => Ok(q),
        Some(Err(error)) => Err(PlanError::new("start", refusal(&error, 0.0, Way::START))),
        None => solved(robot, &[Constraint::pose(robot.tool(), robot.reference(), *at)]),
    }
}

/// In closed form, where the arm has one: the positions nearest to `near` that put the tool at a place of the reference.
pub(crate) fn reach(robot: &Robot, at: &Placement, near: &[f64]) -> Option<Result<Vec<f64>, InverseError>> {
    let closed_form = robot.closed_form()?;
    let near: [f64; 6] = near.try_into().ok()?;
    let ranges = robot.ranges().try_into().ok()?;
    let reference = robot.reference().placement;
    Some(closed_form.nearest(&(reference * *at), &near, &ranges).map(|solution| solution.q.to_vec()))
}

/// What the closed form says of a place of the path.
pub(crate) fn refusal(error: &InverseError, at: f64, way: Way) -> Reason {
    match *error {
        InverseError::Unreachable { distance } => Reason::Unreachable { at, way, distance: Some(distance) },
        InverseError::OutsideRanges { axis, excess } => Reason::OutsideLimits { at, way, axis, excess },
        _ => Reason::NotFinite,
    }
}

fn solved(robot: &Robot, constraints: &[Constraint]) -> Result<Vec<f64>, PlanError> {
    let fail = || PlanError::new("start", Reason::Unreachable { at: 0.0, way: Way::START, distance: None });
    let mut solver = Solver::new(robot.model(), &robot.ranges()).map_err(|_| fail())?;
    let solved = solver.solve(constraints, &robot.start(), &Options::default()).map_err(|_| fail())?;
    match solved.status {
        Status::Success => Ok(solved.q),
        Status::BestAvailable => Err(fail()),
    }
}
