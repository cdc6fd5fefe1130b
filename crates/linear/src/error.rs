//! What can go wrong with a linear system.

use std::fmt::{Display, Formatter, Result};

/// A system about which something cannot be told.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LinearError {
    /// The matrices do not fit each other; the sentence says which.
    Shape(String),
    /// A matrix has a value that is not finite.
    NotFinite(&'static str),
    /// The eigenvalues did not converge.
    NoConvergence,
}

impl Display for LinearError {
    fn fmt(&self, f: &mut Formatter) -> Result {
        match self {
            LinearError::Shape(what) => f.write_str(what),
            LinearError::NotFinite(matrix) => {
                write!(f, "the matrix {matrix} has a value that is not finite")
            }
            LinearError::NoConvergence => f.write_str("the eigenvalues cannot be computed"),
        }
    }
}

impl std::error::Error for LinearError {}
