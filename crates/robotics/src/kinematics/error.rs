//! What can be wrong, with the reason and a remedy. Axes count from 0 here and from 1 in the messages.

use std::error::Error;
use std::fmt;

const REMEDY: &str = "use the general solver for this arm";

/// Why an arm has no closed form of this class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClassError {
    /// Another number of joints than six between the ground and the frame.
    NotSixAxes {
        /// Joints found.
        axes: usize,
    },
    /// A joint slides or is a ball.
    NotRevolute {
        /// Index of the axis.
        axis: usize,
    },
    /// Two axes are not perpendicular.
    NotPerpendicular {
        /// Indices of the axes.
        axes: [usize; 2],
        /// Angle between them, rad.
        angle: f64,
    },
    /// Two axes are not parallel.
    NotParallel {
        /// Indices of the axes.
        axes: [usize; 2],
        /// Angle between them, rad.
        angle: f64,
    },
    /// Two axes of the wrist do not meet in the wrist centre.
    NotMeeting {
        /// Indices of the axes.
        axes: [usize; 2],
        /// How far they pass by, m.
        distance: f64,
    },
    /// A part of the arm has no length.
    NoLength {
        /// Its name.
        part: &'static str,
    },
}

impl fmt::Display for ClassError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            ClassError::NotSixAxes { axes } => {
                write!(f, "{axes} joints move the frame, the closed form is for six; ")
            }
            ClassError::NotRevolute { axis } => {
                write!(f, "joint {} does not turn about one axis; ", axis + 1)
            }
            ClassError::NotPerpendicular { axes: [i, j], angle } => write!(
                f,
                "axes {} and {} are at {:.6} deg, not perpendicular; ",
                i + 1,
                j + 1,
                angle.to_degrees()
            ),
            ClassError::NotParallel { axes: [i, j], angle } => {
                write!(f, "axes {} and {} are at {:.6} deg, not parallel; ", i + 1, j + 1, angle.to_degrees())
            }
            ClassError::NotMeeting { axes: [i, j], distance } => write!(
                f,
                "axes {} and {} pass each other by {distance:.6} m, the wrist is not spherical; ",
                i + 1,
                j + 1
            ),
            ClassError::NoLength { part } => write!(f, "the {part} has no length; "),
        }?;
        f.write_str(REMEDY)
    }
}

impl Error for ClassError {}

/// Why there are no joint positions for a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InverseError {
    /// A number of the target or of the positions to stay near is infinite or none.
    NotFinite,
    /// The rotation of the target is not orthonormal and right-handed.
    NotRotation,
    /// The arm does not reach the target.
    Unreachable {
        /// How far the wrist centre is out of reach, m.
        distance: f64,
    },
    /// The lower end of a range is not below the upper one, or is not a number.
    RangeCrossed {
        /// Index of the axis.
        axis: usize,
        /// Lower end, rad.
        lower: f64,
        /// Upper end, rad.
        upper: f64,
    },
    /// The arm reaches the target, but not within the ranges of its joints.
    OutsideRanges {
        /// Index of the axis that keeps the solution which comes nearest from its range.
        axis: usize,
        /// By how much it leaves its range, rad.
        excess: f64,
    },
    /// The arm reaches the target within the ranges of its joints, but in none of the configurations that are wanted.
    OtherConfiguration,
}

impl fmt::Display for InverseError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match *self {
            InverseError::NotFinite => {
                write!(f, "the target or the position to stay near is not finite; give numbers")
            }
            InverseError::NotRotation => {
                write!(
                    f,
                    "the rotation of the target is not orthonormal and right-handed; give a rotation matrix"
                )
            }
            InverseError::Unreachable { distance } => write!(
                f,
                "the target is out of reach: the wrist centre lies {distance:.6} m outside; move the target or the \
                 base by as much, or turn the tool"
            ),
            InverseError::RangeCrossed { axis, lower, upper } => write!(
                f,
                "axis {}: the range from {} to {} deg is empty; give the lower end first",
                axis + 1,
                lower.to_degrees(),
                upper.to_degrees()
            ),
            InverseError::OutsideRanges { axis, excess } => write!(
                f,
                "the arm reaches the target only with axis {} {:.4} deg outside its range; move the target or turn \
                 the tool",
                axis + 1,
                excess.to_degrees()
            ),
            InverseError::OtherConfiguration => {
                write!(
                    f,
                    "the arm reaches the target only in another configuration; leave shoulder, elbow or wrist free"
                )
            }
        }
    }
}

impl Error for InverseError {}

/// Why the general solver cannot start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SolveError {
    /// The model has no joint.
    NoJoint,
    /// A joint is spherical.
    Spherical {
        /// Index of its body.
        body: usize,
    },
    /// A list does not have one entry per joint.
    WrongLength {
        /// Which list.
        list: &'static str,
        /// Entries given.
        given: usize,
        /// Joints.
        joints: usize,
    },
    /// A number is infinite or none where it must be finite.
    NotFinite {
        /// Of what.
        what: &'static str,
        /// Index of the constraint, `None` for the seed.
        constraint: Option<usize>,
    },
    /// A lower bound is above its upper bound, or one of them is not a number.
    BoundsCrossed {
        /// Index of the constraint, `None` for the ranges of the joints.
        constraint: Option<usize>,
        /// Index of the entry.
        entry: usize,
    },
    /// The rotation of a target is not orthonormal and right-handed.
    NotRotation {
        /// Index of the constraint.
        constraint: usize,
    },
    /// A tolerance or weight is negative or no number.
    Negative {
        /// Index of the constraint.
        constraint: usize,
        /// `tolerance` or `weight`.
        what: &'static str,
    },
    /// A frame of a constraint is on a body that the model does not have.
    UnknownBody {
        /// Index of the constraint.
        constraint: usize,
    },
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let place = |constraint: &Option<usize>, otherwise: &'static str| match constraint {
            Some(i) => format!("constraint {}", i + 1),
            None => otherwise.to_owned(),
        };
        match self {
            SolveError::NoJoint => write!(f, "the model has no joint to move; add one"),
            SolveError::Spherical { body } => {
                write!(f, "body {body}: the solver takes no spherical joint; write it as three axes")
            }
            SolveError::WrongLength { list, given, joints } => {
                write!(f, "{list}: {given} entries for {joints} joints; give one per joint")
            }
            SolveError::NotFinite { what, constraint } => {
                write!(f, "{}: {what} is not finite; give numbers", place(constraint, "start"))
            }
            SolveError::BoundsCrossed { constraint, entry } => write!(
                f,
                "{}: bounds {} are not in order; give the lower bound first",
                place(constraint, "joint ranges"),
                entry + 1
            ),
            SolveError::NotRotation { constraint } => write!(
                f,
                "constraint {}: the rotation is not orthonormal and right-handed; give a rotation matrix",
                constraint + 1
            ),
            SolveError::Negative { constraint, what } => {
                write!(f, "constraint {}: a {what} must be zero or a positive number", constraint + 1)
            }
            SolveError::UnknownBody { constraint } => write!(
                f,
                "constraint {}: a frame is on a body that the model does not have; take a body of this model",
                constraint + 1
            ),
        }
    }
}

impl Error for SolveError {}
