//! Inverse kinematics: joint positions for what a tool shall do.
//!
//! | question | answer |
//! |---|---|
//! | all joint positions that put the tool of a six-axis arm there | [`ClosedForm`], where the arm is of its class |
//! | the one nearest to where the arm is, within its limits | [`ClosedForm::nearest`] |
//! | any tree of axes, any stack of constraints | [`Solver`] with [`Constraint`]s |
//!
//! Frames and forward kinematics are those of `blocksim_multibody`. Positions are in m, angles in rad.

mod class;
mod closed_form;
mod constraint;
mod error;
mod normal_equations;
mod ortho_parallel;
mod random;
mod range;
mod residual;
mod solution;
mod solver;

pub use closed_form::ClosedForm;
pub use constraint::{Constraint, follow_point};
pub use error::{ClassError, InverseError, SolveError};
pub use ortho_parallel::OrthoParallel;
pub use range::JointRange;
pub use solution::{Configuration, Elbow, Shoulder, Singular, Solution, Solutions, Wrist};
pub use solver::{Options, Report, Solved, Solver, Status};
