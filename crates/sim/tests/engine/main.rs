//! The engine run on small diagrams that are made by hand.

mod errors;
mod events;
mod freezing;
mod looking;
mod periods;
mod recording;
mod sampling;
mod solvers;
mod toys;
mod verifying;
