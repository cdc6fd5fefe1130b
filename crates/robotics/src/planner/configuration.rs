//! The configuration in which a move along a path begins: which of the positions of the axes that have the tool at its
//! start.

use std::f64::consts::TAU;

use crate::kinematics::{Configuration, Elbow, Shoulder, Wrist};
use crate::motion::AxisLimits;
use crate::robot::Robot;

use crate::planner::check::NARROW;
use crate::planner::course::Way;
use crate::planner::error::{PlanError, Reason, short};
use crate::planner::joint_path::JointPath;
use crate::planner::prescribed::{Prescribed, check};
use crate::planner::request::{CartesianRequest, Start};
use crate::planner::start::begin;

/// All configurations by their words, such as `front-up-plain`.
pub fn configurations() -> Vec<(String, Configuration)> {
    let mut all = Vec::new();
    for (front, shoulder) in [("front", Shoulder::Front), ("back", Shoulder::Back)] {
        for (up, elbow) in [("up", Elbow::Up), ("down", Elbow::Down)] {
            for (plain, wrist) in [("plain", Wrist::Plain), ("flipped", Wrist::Flipped)] {
                let configuration = Configuration { shoulder, elbow, wrist };
                all.push((format!("{front}-{up}-{plain}"), configuration));
            }
        }
    }
    all
}

/// The word of a configuration.
pub fn configuration_word(configuration: Configuration) -> String {
    let all = configurations();
    all.into_iter().find(|(_, known)| *known == configuration).map(|(word, _)| word).unwrap_or_default()
}

/// A configuration that was tried, and why it was not taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Tried {
    /// Which.
    pub configuration: Configuration,
    /// Why not, as the end of a sentence.
    pub reason: String,
}

/// Positions of the axes at a start.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Positions, rad.
    pub q: Vec<f64>,
    /// Their configuration, where the arm has a closed form and a choice was made.
    pub configuration: Option<Configuration>,
    /// Whether they keep the limits on the whole path and stay away from singular poses.
    pub passes: bool,
    /// What was tried before, the nearest first.
    pub tried: Vec<Tried>,
}

/// Chooses the positions of the axes that a move begins with.
///
/// A start that is given by the positions of the axes is kept, unless a configuration is `wanted`: then the tool begins at
/// the same place in that one. Otherwise, of all configurations and all turns of the axes, the one nearest to where the
/// robot starts is taken that keeps the limits of all axes on the whole path and stays away from singular poses; where none
/// does, the nearest one.
///
/// # Errors
/// As [`CartesianMove::plan`](crate::planner::CartesianMove::plan), and where the arm does not have the configuration at the start.
pub fn choose(
    robot: &Robot,
    request: &CartesianRequest,
    wanted: Option<Configuration>,
) -> Result<Chosen, PlanError> {
    check(robot, request)?;
    let (q, start) = begin(robot, &request.start)?;
    let kept = matches!(request.start, Start::Joints(_)) && wanted.is_none();
    let closed_form = robot.closed_form().filter(|_| !kept);
    let (Some(closed_form), Ok(near)) = (closed_form, <[f64; 6]>::try_from(q.as_slice())) else {
        return match wanted {
            Some(_) => Err(PlanError::new("configuration", Reason::NoConfigurations)),
            None => Ok(Chosen { q, configuration: None, passes: true, tried: Vec::new() }),
        };
    };
    let near: [f64; 6] = match request.start {
        Start::Joints(_) => near,
        _ => robot.start().try_into().unwrap_or(near),
    };
    let prescribed = Prescribed::of(robot, request, &start)?;
    let target = robot.reference().placement * start;
    let found = closed_form
        .inverse(&target, &near)
        .map_err(|error| PlanError::new("start", crate::planner::start::refusal(&error, 0.0, Way::START)))?;
    let mut candidates: Vec<(f64, Configuration, [f64; 6])> = found
        .iter()
        .filter(|solution| wanted.is_none_or(|wanted| wanted == solution.configuration))
        .map(|solution| {
            // the turn that is nearest, within the limits or not
            let turn = |i: usize| solution.q[i] + TAU * ((near[i] - solution.q[i]) / TAU).round();
            let q: [f64; 6] = std::array::from_fn(turn);
            let distance = q.iter().zip(&near).map(|(a, b)| (a - b) * (a - b)).sum();
            (distance, solution.configuration, q)
        })
        .collect();
    candidates.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let (true, Some(wanted)) = (candidates.is_empty(), wanted) {
        let has = found.iter().map(|solution| configuration_word(solution.configuration)).collect();
        let wanted = configuration_word(wanted);
        return Err(PlanError::new("configuration", Reason::OtherConfigurations { wanted, has }));
    }
    let limits = robot.limits();
    let mut tried = Vec::new();
    let mut first = None;
    for (_, configuration, q) in candidates {
        match pass(robot, &prescribed, &q, &near, &limits) {
            Ok(q) => {
                return Ok(Chosen { q, configuration: Some(configuration), passes: true, tried });
            }
            Err(reason) => {
                let start = turned(&q.map(|q| (q, q)), &near, &limits).ok();
                first = first.or(start.map(|turns| (configuration, shifted(&q, &turns))));
                tried.push(Tried { configuration, reason });
            }
        }
    }
    match first {
        Some((configuration, q)) => {
            Ok(Chosen { q, configuration: Some(configuration), passes: false, tried })
        }
        None => {
            let reason = tried.first().map(|tried| tried.reason.clone()).unwrap_or_default();
            Err(PlanError::new("start", Reason::NoneStarts { reason }))
        }
    }
}

fn shifted(q: &[f64], turns: &[f64]) -> Vec<f64> {
    q.iter().zip(turns).map(|(q, turn)| q + turn).collect()
}

/// The positions at the start, turned so that all axes keep their limits on the whole path; else why there are none.
fn pass(
    robot: &Robot,
    prescribed: &Prescribed,
    q: &[f64; 6],
    near: &[f64; 6],
    limits: &[AxisLimits],
) -> Result<Vec<f64>, String> {
    turned(&q.map(|q| (q, q)), near, limits)
        .map_err(|axis| format!("{} at the start", outside(axis, q[axis], &limits[axis])))?;
    let Prescribed { path, task, spacing } = prescribed;
    let joints = JointPath::follow(robot, task, path, q, *spacing).map_err(|error| match error.reason {
        Reason::Singular { at, .. } => format!("the arm is singular at {} % of the path", short(100.0 * at)),
        _ => error.to_string(),
    })?;
    let knots = 0..=joints.intervals();
    let range = |axis: usize| {
        let all = knots.clone().map(|k| joints.knot(k, axis)[0]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(q), high.max(q)))
    };
    let ranges: [(f64, f64); 6] = std::array::from_fn(range);
    let percent = |k: usize| short(100.0 * k as f64 / joints.intervals() as f64);
    let turns = turned(&ranges, near, limits).map_err(|axis| {
        let turn = turned(&q.map(|q| (q, q)), near, limits).map_or(0.0, |turns| turns[axis]);
        let at = |k: usize| joints.knot(k, axis)[0] + turn;
        let leaves = |k: &usize| at(*k) < limits[axis].lower || at(*k) > limits[axis].upper;
        let k = knots.clone().find(leaves).unwrap_or(0);
        format!("{} at {} % of the path", outside(axis, at(k), &limits[axis]), percent(k))
    })?;
    match knots.clone().find(|k| joints.margin(*k) < NARROW) {
        Some(k) => Err(format!("the arm is nearly singular at {} % of the path", percent(k))),
        None => Ok(shifted(q, &turns)),
    }
}

fn outside(axis: usize, q: f64, limits: &AxisLimits) -> String {
    let (side, limit) = if q < limits.lower { ("lower", limits.lower) } else { ("upper", limits.upper) };
    format!("axis {} leaves its {side} limit of {} deg", axis + 1, short(limit.to_degrees()))
}

/// Full turns for each axis with which its range keeps the limits, nearest to `near` with its beginning; else the first
/// axis that has none.
fn turned(ranges: &[(f64, f64); 6], near: &[f64; 6], limits: &[AxisLimits]) -> Result<Vec<f64>, usize> {
    const SLACK: f64 = 1e-9;
    let of = |axis: usize| {
        let ((low, high), AxisLimits { lower, upper, .. }) = (ranges[axis], limits[axis]);
        let fits = |turn: &f64| low + turn >= lower - SLACK && high + turn <= upper + SLACK;
        let far = |turn: &f64| (0.5 * (low + high) + turn - near[axis]).abs();
        let turns = (-3..=3).map(|k| TAU * f64::from(k)).filter(fits);
        turns.min_by(|a, b| far(a).total_cmp(&far(b))).ok_or(axis)
    };
    (0..6).map(of).collect()
}
