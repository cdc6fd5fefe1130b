//! Moves against forward kinematics, differences, and other ways to plan them.

mod arm;
mod collisions;
mod configurations;
mod errors;
mod limits;
mod lines;
mod reviews;
mod sequences;
mod slides;
