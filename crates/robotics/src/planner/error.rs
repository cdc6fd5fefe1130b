//! Why a move cannot be planned.

use std::fmt;

use crate::motion::{AxisKind, MoveError};

use crate::planner::course::Way;

/// A refusal: which member of the request it is about, what is wrong, and what helps.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanError {
    /// Member of the request: `start`, `configuration`, `target`, `via`, `velocity`, `acceleration`, `rotation_velocity`,
    /// `rotation_acceleration`, `jerk`, `resolution`.
    pub member: &'static str,
    /// What is wrong.
    pub reason: Reason,
}

/// What is wrong with a request.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// A number is infinite or none.
    NotFinite,
    /// Another number of positions than axes.
    WrongLength {
        /// Positions given.
        given: usize,
        /// Axes of the robot.
        axes: usize,
    },
    /// A number is outside what it may be; in the unit that people use.
    OutOfRange {
        /// The number.
        value: f64,
        /// Lower end.
        lower: f64,
        /// Upper end.
        upper: f64,
        /// Unit of the three.
        unit: &'static str,
    },
    /// A start position is outside the limits of its axis.
    StartOutside {
        /// Index of the axis.
        axis: usize,
        /// How it moves.
        kind: AxisKind,
        /// Position, rad or m.
        value: f64,
        /// Lower limit, rad or m.
        lower: f64,
        /// Upper limit, rad or m.
        upper: f64,
    },
    /// Start and target are the same place.
    Nothing,
    /// The three points of an arc lie on a line.
    Straight,
    /// There would be more waypoints than can be kept.
    TooManyWaypoints {
        /// How many there would be.
        count: f64,
        /// How many there may be.
        most: usize,
    },
    /// The arm does not reach a place of the path.
    Unreachable {
        /// Share of the path, 0 to 1.
        at: f64,
        /// How far it is along the path.
        way: Way,
        /// By how much, m, where it is known.
        distance: Option<f64>,
    },
    /// The arm does not reach a place within the limits of its axes.
    OutsideLimits {
        /// Share of the path.
        at: f64,
        /// How far it is along the path.
        way: Way,
        /// Index of the axis that comes nearest to its limit.
        axis: usize,
        /// By how much it would leave its limits, rad.
        excess: f64,
    },
    /// The path leads through a pose in which axes lose a direction.
    Singular {
        /// Share of the path.
        at: f64,
        /// How far it is along the path.
        way: Way,
    },
    /// No positions of the axes within their limits have the tool at the start.
    NoneStarts {
        /// Why the nearest ones do not.
        reason: String,
    },
    /// The arm does not have the configuration at the start that was asked for.
    OtherConfigurations {
        /// The word for it.
        wanted: String,
        /// Words of those that it has.
        has: Vec<String>,
    },
    /// The arm is not of the kind that has configurations.
    NoConfigurations,
    /// A joint move is wrong.
    Joint(MoveError),
}

impl PlanError {
    pub(crate) fn new(member: &'static str, reason: Reason) -> Self {
        PlanError { member, reason }
    }

    /// What helps.
    pub fn help(&self) -> String {
        match &self.reason {
            Reason::NotFinite => "give a finite number".into(),
            Reason::WrongLength { axes, .. } => {
                format!("give {axes} positions, one for each axis; a decimal comma is written as a point")
            }
            Reason::OutOfRange { lower, upper, unit, .. } => {
                format!("choose from {} to {} {unit}", short(*lower), short(*upper))
            }
            Reason::StartOutside { axis, kind, lower, upper, .. } => format!(
                "start axis {} from {} to {} {}",
                axis + 1,
                kind.text(*lower),
                kind.text(*upper),
                kind.unit()
            ),
            Reason::Nothing => {
                "give a target at another place, or another orientation (interpolated) to turn on the spot".into()
            }
            Reason::Straight => "choose a point beside the way, or plan a linear move".into(),
            Reason::TooManyWaypoints { .. } => "choose a coarser resolution".into(),
            Reason::Unreachable { at, .. } if *at == 1.0 => {
                "move the target nearer to the robot; axes, tool and base of its description determine its reach".into()
            }
            Reason::NoneStarts { .. } => "begin at another place, or with another orientation".into(),
            Reason::OtherConfigurations { has, .. } => format!("choose {}", has.join(", ")),
            Reason::NoConfigurations => "leave the configuration out, and give the positions of the axes".into(),
            Reason::Unreachable { .. } => {
                "move start or target nearer to the robot, turn the tool, or let its orientation be free".into()
            }
            Reason::OutsideLimits { .. } => {
                "turn the tool, let its orientation be free, or move the target".into()
            }
            Reason::Singular { .. } => {
                "start in another configuration, let the tool turn about its axis (tool-axis) or be free, or plan a \
                 joint move past this place"
                    .into()
            }
            Reason::Joint(error) => match error.to_string().split_once("; ") {
                Some((_, help)) => help.to_owned(),
                None => "correct the request".into(),
            },
        }
    }
}

impl std::error::Error for PlanError {}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = self.member;
        let place = |at: f64, way: Way| format!("at {} % of the path ({})", short(100.0 * at), way.text());
        match &self.reason {
            Reason::NotFinite => write!(f, "the {what} is infinite or no number"),
            Reason::WrongLength { given, axes } => {
                write!(f, "the {what} has {given} positions, but the robot has {axes} axes")
            }
            Reason::OutOfRange { value, unit, lower, upper } => write!(
                f,
                "the {what} is {} {unit}, allowed is {} to {} {unit}",
                short(*value),
                short(*lower),
                short(*upper)
            ),
            Reason::StartOutside { axis, kind, value, lower, upper } => {
                let (side, limit) = if value < lower { ("below", lower) } else { ("above", upper) };
                write!(
                    f,
                    "axis {} starts at {} {unit}, which is {side} its limit {} {unit}",
                    axis + 1,
                    kind.text(*value),
                    kind.text(*limit),
                    unit = kind.unit()
                )
            }
            Reason::Nothing => write!(f, "start and target are the same place"),
            Reason::Straight => write!(f, "start, via point and target of the arc lie on a line"),
            Reason::TooManyWaypoints { count, most } => {
                write!(f, "the path would have {count:.0} waypoints, at most {most} can be planned")
            }
            Reason::NoneStarts { reason } => {
                write!(f, "no positions of the axes within their limits have the tool at the start: {reason}")
            }
            Reason::OtherConfigurations { wanted, .. } => {
                write!(f, "the arm cannot begin in the configuration {wanted}")
            }
            Reason::NoConfigurations => {
                write!(f, "the arm is not of the kind that has configurations: six axes with a wrist")
            }
            Reason::Unreachable { at, way, distance } => {
                match *at {
                    0.0 => write!(f, "the arm does not reach the start")?,
                    1.0 => write!(f, "the arm does not reach the target")?,
                    at => write!(f, "the arm does not reach the path {}", place(at, *way))?,
                }
                match distance {
                    Some(distance) => {
                        write!(f, ": the wrist would be {} mm out of reach", short(1e3 * distance))
                    }
                    None => Ok(()),
                }
            }
            Reason::OutsideLimits { at, way, axis, excess } => write!(
                f,
                "{} the arm reaches only with axis {} {} deg outside its limits",
                place(*at, *way),
                axis + 1,
                short(excess.to_degrees())
            ),
            Reason::Singular { at, way } => write!(
                f,
                "{} the arm is singular: it cannot move on along the path with the required orientation",
                place(*at, *way)
            ),
            Reason::Joint(error) => {
                let text = error.to_string();
                f.write_str(text.split_once("; ").map_or(text.as_str(), |(fact, _)| fact))
            }
        }
    }
}

/// At most three decimals, no zeros at the end.
pub(crate) fn short(value: f64) -> String {
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e9) {
        return format!("{value:.3e}");
    }
    let text = format!("{value:.3}");
    let trimmed = text.trim_end_matches('0').trim_end_matches('.');
    (if trimmed.is_empty() || trimmed == "-0" { "0" } else { trimmed }).to_owned()
}
