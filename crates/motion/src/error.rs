//! Why a move cannot be planned, in words for the person who asked for it.

use std::fmt;

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
/// in SI units here and in degrees in the message.
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
        /// The position given.
        value: f64,
    },
    /// A position is outside the limits of its axis.
    OutsideLimits {
        /// Start or target.
        endpoint: Endpoint,
        /// Index of the axis.
        axis: usize,
        /// The position given, rad.
        value: f64,
        /// Lower limit, rad.
        lower: f64,
        /// Upper limit, rad.
        upper: f64,
    },
    /// Start and target are the same on all axes.
    NothingToMove,
    /// The share of the largest speed is not above 0 and at most 1.
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
        /// Lower limit, rad.
        lower: f64,
        /// Upper limit, rad.
        upper: f64,
    },
    /// The largest speed of an axis is not a positive number.
    SpeedLimit {
        /// Index of the axis.
        axis: usize,
        /// The limit given, rad/s.
        value: f64,
    },
    /// The largest acceleration of an axis is not positive.
    AccelerationLimit {
        /// Index of the axis.
        axis: usize,
        /// The limit given, rad/s².
        value: f64,
    },
    /// The distances are so small or the times so long that they cannot be computed with.
    NotComputable {
        /// Index of the axis.
        axis: usize,
        /// Distance, rad.
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
            MoveError::NotFinite { endpoint, axis, value } => write!(
                f,
                "axis {}: the {endpoint} is {value}, which is no position; give a number with an angle unit",
                axis + 1
            ),
            MoveError::OutsideLimits { endpoint, axis, value, lower, upper } => {
                let (side, limit) = if value < lower { ("below", lower) } else { ("above", upper) };
                write!(
                    f,
                    "axis {}: the {endpoint} {} deg is {} deg {side} the limit {} deg; choose a position \
                     from {} to {} deg",
                    axis + 1,
                    degrees(value),
                    degrees((value - limit).abs()),
                    degrees(limit),
                    degrees(lower),
                    degrees(upper)
                )
            }
            MoveError::NothingToMove => {
                write!(f, "start and target are the same on all axes; change the target of at least one")
            }
            MoveError::VelocityShare { value } => write!(
                f,
                "the velocity is {} % of the largest speed; choose more than 0 % and at most 100 %",
                short(100.0 * value)
            ),
            MoveError::AccelerationShare { value } => write!(
                f,
                "{} % of the move time are to be spent accelerating; choose more than 0 % and at most 50 %, \
                 for braking takes as long",
                short(100.0 * value)
            ),
            MoveError::LimitsCrossed { axis, lower, upper } => write!(
                f,
                "axis {}: the lower limit {} deg is not below the upper limit {} deg; correct the limits",
                axis + 1,
                degrees(lower),
                degrees(upper)
            ),
            MoveError::SpeedLimit { axis, value } => write!(
                f,
                "axis {}: the largest speed is {} deg/s; give a positive number",
                axis + 1,
                degrees(value)
            ),
            MoveError::AccelerationLimit { axis, value } => write!(
                f,
                "axis {}: the largest acceleration is {} deg/s^2; give a positive number",
                axis + 1,
                degrees(value)
            ),
            MoveError::NotComputable { axis, distance, duration } => write!(
                f,
                "axis {}: a distance of {} deg in {duration:e} s cannot be computed with; choose a larger \
                 distance, velocity or share of acceleration",
                axis + 1,
                degrees(distance)
            ),
        }
    }
}

/// An angle in rad as degrees for people.
pub(crate) fn degrees(angle: f64) -> String {
    short(angle.to_degrees())
}

/// At most three decimals, no zeros at the end; numbers that would vanish in this are written in full.
fn short(value: f64) -> String {
    let rounded = format!("{value:.3}");
    if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e15) {
        return format!("{value:.3e}");
    }
    let trimmed = rounded.trim_end_matches('0').trim_end_matches('.');
    (if trimmed.is_empty() || trimmed == "-0" { "0" } else { trimmed }).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_never_vanish() {
        let cases = [(0.0, "0"), (-0.0, "0"), (60.0, "60"), (-7.5, "-7.5"), (1.23456, "1.235")];
        for (value, expected) in cases {
            assert_eq!(short(value), expected);
        }
        assert_eq!(short(1e-7), "1.000e-7");
        assert_eq!(short(100.0), "100");
        assert_eq!(short(f64::INFINITY), "inf");
    }
}
