//! Why a move cannot be planned, in words for the person who asked for it.

use std::fmt;

use crate::motion::axis_kind::{AxisKind, short};

/// One of the two ends of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Endpoint {
    /// Where the move starts.
    Start,
    /// Where it ends.
    Target,
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Endpoint::Start => "start",
            Endpoint::Target => "target",
        })
    }
}

/// Why a move cannot be planned. Axes are indices from 0 here and numbers from 1 in the message; values are
/// in SI units here, in degrees or millimetres in the message.
#[derive(Debug, Clone, PartialEq)]
pub enum MoveError {
    /// There is no axis to move.
    NoAxes,
    /// Start or target does not have one position per axis.
    WrongLength {
        /// Which of the two.
        endpoint: Endpoint,
        /// Positions given.
        given: usize,
        /// Axes to move.
        axes: usize,
    },
    /// A position is infinite or not a number.
    NotFinite {
        /// Start or target.
        endpoint: Endpoint,
        /// Index of the axis.
        axis: usize,
        /// How it moves.
        kind: AxisKind,
        /// The position given.
        value: f64,
    },
    /// A position is outside the limits of its axis.
    OutsideLimits {
        /// Start or target.
        endpoint: Endpoint,
        /// Index of the axis.
        axis: usize,
        /// How it moves.
        kind: AxisKind,
        /// The position given, rad or m.
        value: f64,
        /// Lower limit, rad or m.
        lower: f64,
        /// Upper limit, rad or m.
        upper: f64,
    },
    /// Start and target are the same on all axes.
    NothingToMove,
    /// The share of the maximum speed is not above 0 and at most 1.
    VelocityShare {
        /// The share given.
        value: f64,
    },
    /// The share of the move time spent accelerating is not above 0 and at most 0.5.
    AccelerationShare {
        /// The share given.
        value: f64,
    },
    /// The lower position limit of an axis is not below the upper one.
    LimitsCrossed {
        /// Index of the axis.
        axis: usize,
        /// How it moves.
        kind: AxisKind,
        /// Lower limit, rad or m.
        lower: f64,
        /// Upper limit, rad or m.
        upper: f64,
    },
    /// The maximum speed of an axis is not a positive number.
    SpeedLimit {
        /// Index of the axis.
        axis: usize,
        /// How it moves.
        kind: AxisKind,
        /// The limit given, rad/s or m/s.
        value: f64,
    },
    /// The maximum acceleration of an axis is not positive.
    AccelerationLimit {
        /// Index of the axis.
        axis: usize,
        /// How it moves.
        kind: AxisKind,
        /// The limit given, rad/s² or m/s².
        value: f64,
    },
    /// The distances are so small or the times so long that they cannot be computed with.
    NotComputable {
        /// Index of the axis.
        axis: usize,
        /// How it moves.
        kind: AxisKind,
        /// Distance, rad or m.
        distance: f64,
        /// Move time, s.
        duration: f64,
    },
}

impl std::error::Error for MoveError {}

impl fmt::Display for MoveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            MoveError::NoAxes => write!(f, "there is no axis to move; give the limits of at least one"),
            MoveError::WrongLength { endpoint, given, axes } => write!(
                f,
                "the {endpoint} has {given} positions, but there are {axes} axes; give one position per axis, decimals with a point"
            ),
            MoveError::NotFinite { endpoint, axis, kind, value } => {
                let quantity = match kind {
                    AxisKind::Turning => "an angle unit",
                    AxisKind::Sliding => "a unit of length",
                };
                write!(
                    f,
                    "axis {}: the {endpoint} is {value}, which is not a position; give a number with {quantity}",
                    axis + 1
                )
            }
            MoveError::OutsideLimits { endpoint, axis, kind, value, lower, upper } => {
                let (side, limit) = if value < lower { ("below", lower) } else { ("above", upper) };
                let (text, unit) = (|value| kind.text(value), kind.unit());
                write!(
                    f,
                    "axis {}: the {endpoint} {} {unit} is {} {unit} {side} the limit {} {unit}; choose a position \
                     from {} to {} {unit}",
                    axis + 1,
                    text(value),
                    text((value - limit).abs()),
                    text(limit),
                    text(lower),
                    text(upper)
                )
            }
            MoveError::NothingToMove => {
                write!(f, "start and target are the same on all axes; change the target of at least one")
            }
            MoveError::VelocityShare { value } => write!(
                f,
                "the velocity is {} % of the maximum speed; choose more than 0 % and at most 100 %",
                short(100.0 * value)
            ),
            MoveError::AccelerationShare { value } => write!(
                f,
                "{} % of the move time are to be spent accelerating; choose more than 0 % and at most 50 %, \
                 for braking takes as long",
                short(100.0 * value)
            ),
            MoveError::LimitsCrossed { axis, kind, lower, upper } => write!(
                f,
                "axis {}: the lower limit {} {unit} is not below the upper limit {} {unit}; correct the limits",
                axis + 1,
                kind.text(lower),
                kind.text(upper),
                unit = kind.unit()
            ),
            MoveError::SpeedLimit { axis, kind, value } => write!(
                f,
                "axis {}: the maximum speed is {} {}/s; give a positive number",
                axis + 1,
                kind.text(value),
                kind.unit()
            ),
            MoveError::AccelerationLimit { axis, kind, value } => write!(
                f,
                "axis {}: the maximum acceleration is {} {}/s^2; give a positive number",
                axis + 1,
                kind.text(value),
                kind.unit()
            ),
            MoveError::NotComputable { axis, kind, distance, duration } => write!(
                f,
                "axis {}: a distance of {} {} in {duration:e} s cannot be computed with; choose a larger \
                 distance, velocity or share of acceleration",
                axis + 1,
                kind.text(distance),
                kind.unit()
            ),
        }
    }
}
