//! Inverse kinematics and moves against answers of other methods.

mod inverse;
mod moves;
