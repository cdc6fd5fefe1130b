//! Inverse kinematics against forward kinematics, and what is said where there is no solution.

mod arms;
mod class;
mod closed_form;
mod constraints;
mod singular;
mod solver;

type Outcome = Result<(), Box<dyn std::error::Error>>;
