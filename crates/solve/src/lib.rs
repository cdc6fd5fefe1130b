//! Integration of ordinary differential equations, root finding and small dense linear algebra.
//!
//! A [`System`] is dx/dt = f(t, x) and nothing more. A [`Stepper`] makes one accepted step at a time and
//! interpolates within it.

mod stepper;
mod system;

pub use stepper::{Counts, StepError, StepLimits, Stepper};
pub use system::{Failed, System, Tolerances};
