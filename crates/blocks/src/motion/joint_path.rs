//! What a file says of a move of all axes.

use blocksim_block::in_unit::{self, AxisValue};
use blocksim_block::prelude::*;
use blocksim_robotics::planner::Scrutiny;
use serde::de::IgnoredAny;

use super::tool_path::ToolPath;

/// A move of all axes from rest to rest: to a target of the axes, or along a path of the tool.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointPath {
    /// Positions at the start, one for each axis, rad or m.
    #[serde(deserialize_with = "in_unit::axis_positions")]
    pub start: Vec<AxisValue>,
    /// Positions at the end of a joint move, one for each axis, rad or m.
    #[serde(default, deserialize_with = "in_unit::axis_positions")]
    pub target: Vec<AxisValue>,
    /// Share of each axis' maximum speed, above 0 and at most 1; for joint moves.
    #[serde(default, deserialize_with = "in_unit::share_if_given")]
    pub velocity: Option<f64>,
    /// Share of the move time spent accelerating, above 0 and at most 0.5; for joint moves.
    #[serde(default, deserialize_with = "in_unit::share_if_given")]
    pub acceleration: Option<f64>,
    /// Distance between two rows of a table of the move, rad, positive. The set values do not depend on it.
    #[serde(default = "half_a_degree", deserialize_with = "in_unit::angle")]
    pub resolution: f64,
    /// A line or an arc of the tool, in the place of `target`, `velocity` and `acceleration`.
    #[serde(default)]
    pub tool: Option<ToolPath>,
    /// Radius around the end of this move within which the next may begin, m; 0 for a stop.
    #[serde(default, deserialize_with = "in_unit::length")]
    pub zone: f64,
    /// How long the robot rests at the end of this move before the next one begins, s.
    #[serde(default, deserialize_with = "in_unit::time")]
    pub wait: f64,
    /// Moves behind this one.
    #[serde(default)]
    pub moves: Vec<NextMove>,
    /// Smallest singular value of what is prescribed of the tool, m and rad, that the move may come to without a warning;
    /// 0.01 if it is not given.
    #[serde(default, deserialize_with = "in_unit::share_if_given")]
    pub singular_limit: Option<f64>,
    #[serde(default, rename = "result")]
    _result: Unread,
}

/// A move that begins where the one before ends.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NextMove {
    /// Positions at the end of a joint move, rad or m.
    #[serde(default, deserialize_with = "in_unit::axis_positions")]
    pub target: Vec<AxisValue>,
    /// Share of each axis' maximum speed.
    #[serde(default, deserialize_with = "in_unit::share_if_given")]
    pub velocity: Option<f64>,
    /// Share of the move time spent accelerating.
    #[serde(default, deserialize_with = "in_unit::share_if_given")]
    pub acceleration: Option<f64>,
    /// A line or an arc of the tool.
    #[serde(default)]
    pub tool: Option<ToolPath>,
    /// Radius around the end of this move within which the next may begin, m.
    #[serde(default, deserialize_with = "in_unit::length")]
    pub zone: f64,
    /// How long the robot rests at the end of this move, s.
    #[serde(default, deserialize_with = "in_unit::time")]
    pub wait: f64,
}

/// What a plan came to, which is for people and not read.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Unread;

impl<'de> Deserialize<'de> for Unread {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        IgnoredAny::deserialize(deserializer).map(|_| Unread)
    }
}

impl JointPath {
    /// A joint move; positions in rad or m.
    pub fn joint(start: Vec<f64>, target: Vec<f64>, velocity: f64, acceleration: f64) -> Self {
        let (velocity, acceleration) = (Some(velocity), Some(acceleration));
        let [start, target] = [start, target].map(|all| all.into_iter().map(AxisValue::bare).collect());
        JointPath { start, target, velocity, acceleration, resolution: half_a_degree(), ..Self::default() }
    }

    /// How closely the move is looked at.
    pub fn scrutiny(&self) -> Scrutiny {
        let usual = Scrutiny::default();
        Scrutiny { narrow: self.singular_limit.unwrap_or(usual.narrow), ..usual }
    }

    /// Positions at the start, rad or m.
    pub fn start_values(&self) -> Vec<f64> {
        self.start.iter().map(|position| position.value).collect()
    }
}

/// How the axes are made to start, cruise and brake together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub enum Rule {
    /// In the longest times that any axis needs; never exceeds a limit.
    Feasible,
    /// In the times of the axis that takes longest alone.
    AsPrinted,
}

/// Spacing of a table of set values where a move says none, rad.
fn half_a_degree() -> f64 {
    0.5_f64.to_radians()
}
