//! What a diagram should warn of before its robot moves.

use std::sync::{Arc, Mutex, PoisonError};

use blocksim_block::prelude::*;
use blocksim_robotics::motion::AxisLimits;
use blocksim_robotics::planner::{Course, Finding, Review, Severity, inspect_axes, review};
use blocksim_robotics::robot::Robot;

use super::joint_path::JointPath;
use crate::robotics::{RobotDescription, Surroundings};

/// All that the findings of a move follow from.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Subject {
    pub path: JointPath,
    pub limits: Vec<AxisLimits>,
    pub as_printed: bool,
    pub robot: Option<RobotDescription>,
    /// Whether collisions are looked for.
    pub collides: bool,
    pub surroundings: Option<Surroundings>,
}

/// What was found of a move.
#[derive(Debug, Clone)]
struct Found {
    all: Arc<Vec<Finding>>,
    /// Where a robot does it.
    review: Option<Arc<Review>>,
}

/// Moves that were looked at last. A diagram has the same move in a block for each axis and in one for the tool, and an editor
/// compiles it again after each change elsewhere: the findings are the same.
static SEEN: Mutex<Vec<(Subject, Found)>> = Mutex::new(Vec::new());
/// How many of them are kept.
const KEPT: usize = 8;

/// Warns of limits that a move exceeds, of what it hits, and of where it is not what was requested.
pub(super) fn forewarn(subject: Subject, course: &dyn Course, robot: Option<&Robot>, files: &dyn Files) {
    for finding in findings(subject, course, robot).all.iter() {
        let source = finding.source.as_ref().map(|source| format!(" ({source})")).unwrap_or_default();
        let message = format!("{}{source}", finding.message);
        let exceeded =
            LoadError { param: "path", code: "move_limits", message, help: Some(finding.help.clone()) };
        files.warn(match (finding.severity, finding.code) {
            (Severity::Note, _) => LoadError { code: "move_adjusted", ..exceeded },
            (Severity::Violation, "collision") => LoadError { code: "move_collision", ..exceeded },
            (Severity::Violation, _) => exceeded,
        });
    }
}

fn findings(subject: Subject, course: &dyn Course, robot: Option<&Robot>) -> Found {
    // A panic elsewhere leaves a list that is as good as before.
    let seen = || SEEN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, known)) = seen().iter().find(|(known, _)| *known == subject) {
        return known.clone();
    }
    let found = look(&subject, course, robot);
    let mut seen = seen();
    if seen.len() == KEPT {
        seen.remove(0);
    }
    seen.push((subject, found.clone()));
    found
}

fn look(subject: &Subject, course: &dyn Course, robot: Option<&Robot>) -> Found {
    let scrutiny = subject.path.scrutiny();
    let (Some(description), Some(robot)) = (&subject.robot, robot) else {
        let all = inspect_axes(&subject.limits, course, &scrutiny);
        return Found { all: Arc::new(all), review: None };
    };
    let reviewed =
        |review: Review| Found { all: Arc::new(review.all.clone()), review: Some(Arc::new(review)) };
    if !subject.collides {
        let velocity = subject.path.tool.as_ref().map(|tool| tool.velocity);
        return reviewed(review(robot, course, None, &scrutiny, velocity));
    }
    // All but the collisions is the same as for blocks that do not look for these.
    let alone = Subject { collides: false, surroundings: None, ..subject.clone() };
    let found = findings(alone, course, Some(robot));
    // Surroundings that make no sense are reported by `check`.
    let space = description.space(robot, subject.surroundings.as_ref(), "surroundings").ok().flatten();
    match (space, &found.review) {
        (Some(space), Some(review)) => {
            reviewed(Review::clone(review).among(robot, course, &space, &scrutiny))
        }
        _ => found,
    }
}
