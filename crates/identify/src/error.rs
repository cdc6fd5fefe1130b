//! Why data tell nothing.

use std::fmt;

/// Data from which nothing can be identified.
#[derive(Debug, Clone, PartialEq)]
pub enum IdentifyError {
    /// Fewer values than unknowns.
    TooFew {
        /// Values that there are.
        values: usize,
        /// Unknowns.
        unknowns: usize,
    },
    /// A value that is not a number.
    NotFinite {
        /// What it belongs to.
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// The unknowns cannot be told apart: the columns of the regression depend on each other.
    Dependent {
        /// Condition number of the scaled regression.
        condition: f64,
    },
    /// Lists that belong together have different lengths.
    Lengths {
        /// What is too long or too short.
        what: &'static str,
        /// Its length.
        found: usize,
        /// What it should be.
        expected: usize,
    },
    /// Two speeds that make no two equations.
    SameSpeed {
        /// The speed, rad/s.
        speed: f64,
    },
    /// A cutoff that does not fit the time between two instants.
    Cutoff {
        /// The cutoff, Hz.
        cutoff: f64,
        /// What it must be below, Hz.
        largest: f64,
    },
    /// The iteration did not settle.
    NotSettled {
        /// Steps that were taken.
        steps: usize,
    },
    /// A limit leaves no room.
    NoRoom {
        /// Joint, from 0.
        joint: usize,
        /// Why.
        reason: String,
    },
}

impl fmt::Display for IdentifyError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::TooFew { values, unknowns } => {
                write!(f, "{values} values are too few for {unknowns} unknowns")
            }
            Self::NotFinite { what, index } => write!(f, "{what} number {} is no finite number", index + 1),
            Self::Dependent { condition } => write!(
                f,
                "the data cannot separate the unknowns (condition number {condition:.1e}); more varied motion helps"
            ),
            Self::Lengths { what, found, expected } => {
                write!(f, "{what} has {found} entries, but {expected} are needed")
            }
            Self::SameSpeed { speed } => {
                write!(
                    f,
                    "the two speeds are both {speed} rad/s; two different ones of the same sense are needed"
                )
            }
            Self::Cutoff { cutoff, largest } => {
                write!(
                    f,
                    "a cutoff of {cutoff} Hz does not fit these instants; it must be below {largest:.4} Hz"
                )
            }
            Self::NotSettled { steps } => write!(f, "the fit did not settle in {steps} steps"),
            Self::NoRoom { joint, reason } => write!(f, "joint {}: {reason}", joint + 1),
        }
    }
}

impl std::error::Error for IdentifyError {}
