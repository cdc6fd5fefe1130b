//! All that is to be known of a move before it is run, as one list.

use crate::motion::AxisLimits;
use crate::robot::Robot;

use crate::planner::check::{Findings, Scrutiny, Violation, axes_alone, inspect};
use crate::planner::collide::{Encounter, Encounters, Space, encounters};
use crate::planner::course::{Course, Note, Spot};

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The robot cannot do this, or must not.
    Violation,
    /// It can, but not quite as it was asked for.
    Note,
}

/// Something to be known of a move.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// A word for programs: `axis_range`, `axis_speed`, `axis_acceleration`, `axis_torque`, `axis_jump`, `tool_speed`,
    /// `tool_acceleration`, `singular`, `collision`, `corner_shortened`, `slowed_by_turning`.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What, where, when and how much, in one sentence.
    pub message: String,
    /// Where on the move it is first.
    pub spot: Spot,
    /// Index of the axis, where it is about one.
    pub axis: Option<usize>,
    /// The value there; SI.
    pub value: f64,
    /// The value that is furthest beyond; of a collision the distance, m, which is not positive. SI.
    pub worst: f64,
    /// What it may be. SI.
    pub limit: f64,
    /// Member of the description of the robot that holds the limit.
    pub source: Option<String>,
    /// What helps.
    pub help: String,
}

/// A move that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Review {
    /// Extremes and limits.
    pub findings: Findings,
    /// Collisions and distances, where the robot has shapes.
    pub met: Option<Encounters>,
    /// What is to be known: violations first, each in the order of time.
    pub all: Vec<Finding>,
}

impl Review {
    /// The same move, of which collisions were not looked at, in a space.
    #[must_use]
    pub fn among(self, robot: &Robot, course: &dyn Course, space: &Space, scrutiny: &Scrutiny) -> Review {
        let met = encounters(robot, course, space, scrutiny.waypoints);
        let Review { findings, mut all, .. } = self;
        if let Some(collision) = collision(&met) {
            let is_before = |finding: &Finding| {
                finding.severity == Severity::Violation && finding.spot.t <= collision.spot.t
            };
            let place = all.iter().take_while(|finding| is_before(finding)).count();
            all.insert(place, collision);
        }
        Review { findings, met: Some(met), all }
    }

    /// Whether the robot can do the move without exceeding or hitting anything.
    pub fn passes(&self) -> bool {
        self.all.iter().all(|finding| finding.severity == Severity::Note)
    }
}

/// Looks at limits, singular poses, torques and, in a space, collisions of a move. `velocity` is the speed along the path that
/// was asked for, m/s, where there is one: it is used in remedies.
///
/// A function of its arguments alone, for whoever shows moves: commands, diagrams, editors.
pub fn review(
    robot: &Robot,
    course: &dyn Course,
    space: Option<&Space>,
    scrutiny: &Scrutiny,
    velocity: Option<f64>,
) -> Review {
    let findings = inspect(robot, course, scrutiny);
    let mut all: Vec<Finding> =
        findings.violations.iter().map(|violation| exceeded(violation, velocity)).collect();
    all.extend(course.notes().iter().map(|note| noted(course, note)));
    let review = Review { findings, met: None, all };
    match space {
        Some(space) => review.among(robot, course, space, scrutiny),
        None => review,
    }
}

/// The same of axes alone, where there is no robot: positions, speeds and accelerations against their limits.
///
/// # Panics
/// If there are fewer limits than axes.
pub fn inspect_axes(limits: &[AxisLimits], course: &dyn Course, scrutiny: &Scrutiny) -> Vec<Finding> {
    let violations = axes_alone(limits, course, scrutiny);
    let mut all: Vec<Finding> = violations.iter().map(|violation| exceeded(violation, None)).collect();
    // There is no description of a robot that would hold them.
    all.iter_mut().for_each(|finding| finding.source = None);
    all
}

fn exceeded(violation: &Violation, velocity: Option<f64>) -> Finding {
    // Of several moves each has its own.
    let velocity = velocity.filter(|_| violation.spot.step.is_none());
    Finding {
        code: violation.code(),
        severity: Severity::Violation,
        message: violation.to_string(),
        spot: violation.spot,
        axis: violation.axis,
        value: violation.value,
        worst: violation.worst,
        limit: violation.limit,
        source: violation.source(),
        help: violation.help(velocity),
    }
}

/// The code of a collision.
const COLLISION: &str = "collision";

/// The first collision, with the depth of the deepest one.
fn collision(met: &Encounters) -> Option<Finding> {
    let first = met.first.as_ref()?;
    let deepest = [&met.own, &met.around].into_iter().flatten().map(|met| met.distance).fold(0.0, f64::min);
    Some(Finding {
        code: COLLISION,
        severity: Severity::Violation,
        message: format!("{first}{}", depth(met)),
        spot: first.spot,
        axis: None,
        value: first.distance,
        worst: deepest,
        limit: 0.0,
        source: None,
        help: first.help().to_owned(),
    })
}

/// Where something is deepest in something else.
fn depth(met: &Encounters) -> String {
    let all = [&met.own, &met.around].into_iter().flatten().filter(|met| met.distance < 0.0);
    match all.min_by(|a, b| a.distance.total_cmp(&b.distance)) {
        Some(Encounter { names: [a, b], distance, spot, .. }) => {
            format!("; `{a}` is {:.1} mm in `{b}` {spot}", -1e3 * distance)
        }
        None => String::new(),
    }
}

fn noted(course: &dyn Course, note: &Note) -> Finding {
    let [limit, worst] = note.values();
    Finding {
        code: note.code(),
        severity: Severity::Note,
        message: note.to_string(),
        spot: Spot::of(course, note.t()),
        axis: None,
        value: worst,
        worst,
        limit,
        source: None,
        help: note.help().to_owned(),
    }
}
