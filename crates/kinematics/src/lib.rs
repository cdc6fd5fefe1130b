//! Inverse kinematics: joint positions for what a tool shall do.
//!
//! | question | answer |
//! |---|---|
//! | all joint positions that put the tool of a six-axis arm there | [`ClosedForm`], where the arm is of its class |
//! | the one nearest to where the arm is, within its limits | [`ClosedForm::nearest`] |
//!
//! Frames and forward kinematics are those of `blocksim_multibody`. Positions are in m, angles in rad.

mod class;
mod closed_form;
mod error;
mod ortho_parallel;
mod range;
mod solution;

pub use closed_form::ClosedForm;
pub use error::{ClassError, InverseError};
pub use ortho_parallel::OrthoParallel;
pub use range::JointRange;
pub use solution::{Configuration, Elbow, Shoulder, Singular, Solution, Solutions, Wrist};
