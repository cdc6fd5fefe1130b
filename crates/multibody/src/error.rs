//! What can be wrong with a model.

use std::error::Error;
use std::fmt;

/// Why mass properties do not belong to a rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InertiaError {
    /// A mass, centre of mass or tensor element is infinite or not a number.
    NotFinite,
    /// The mass is negative.
    NegativeMass {
        /// The mass, kg.
        mass: f64,
    },
    /// The tensor differs from its transpose.
    NotSymmetric {
        /// Largest difference of mirrored elements, kg m².
        difference: f64,
    },
    /// The largest principal moment exceeds the sum of the two others.
    Triangle {
        /// Principal moments in ascending order, kg m².
        principal: [f64; 3],
    },
}

impl fmt::Display for InertiaError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            InertiaError::NotFinite => write!(f, "mass properties must be finite numbers"),
            InertiaError::NegativeMass { mass } => {
                write!(f, "the mass is {mass} kg, it must not be negative")
            }
            InertiaError::NotSymmetric { difference } => {
                write!(
                    f,
                    "the inertia tensor is not symmetric: mirrored elements differ by {difference} kg m²"
                )
            }
            InertiaError::Triangle { principal: [a, b, c] } => write!(
                f,
                "no rigid body has the principal moments {a:.6}, {b:.6} and {c:.6} kg m²: \
                 the largest must not exceed the sum of the others; \
                 is the tensor about the centre of mass, with products of the right sign?"
            ),
        }
    }
}

impl Error for InertiaError {}

/// Why a body cannot be added to a model. `body` is its [index](crate::BodyId::index), counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ModelError {
    /// The parent is not a body of this model.
    UnknownBody {
        /// Index of the body asked for.
        body: usize,
    },
    /// The axis of the joint has no direction.
    Axis {
        /// Index of the body.
        body: usize,
        /// The axis as given.
        axis: [f64; 3],
    },
    /// The rotation of a placement is not orthonormal and right-handed, or a translation is not finite.
    Placement {
        /// Index of the body.
        body: usize,
    },
    /// The mass properties are impossible.
    Inertia {
        /// Index of the body.
        body: usize,
        /// What is wrong with them.
        cause: InertiaError,
    },
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            ModelError::UnknownBody { body } => write!(f, "there is no body {body} in this model"),
            ModelError::Axis { body, axis: [x, y, z] } => {
                write!(f, "body {body}: the joint axis ({x}, {y}, {z}) must be finite and longer than zero")
            }
            ModelError::Placement { body } => write!(
                f,
                "body {body}: the placement must be finite, its rotation orthonormal and right-handed"
            ),
            ModelError::Inertia { body, cause } => write!(f, "body {body}: {cause}"),
        }
    }
}

impl Error for ModelError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            ModelError::Inertia { cause, .. } => Some(cause),
            _ => None,
        }
    }
}
