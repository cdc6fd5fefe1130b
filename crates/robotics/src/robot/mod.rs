//! Robots: a chain of axes with its frames, its tool, what its axes can do and what their drives need.
//!
//! A [`Robot`] is made of plain data ([`Parts`]) and holds the mechanism as a
//! [`Model`](blocksim_multibody::Model), so that kinematics, planning and dynamics work on one description. Positions
//! are in rad where an axis turns and in m where it slides, lengths in m.
//!
//! # Frames
//! The **world** is that of the model. The **base** is the mounting surface of the robot in the world; the
//! **reference** is where targets are given, in the base; the **flange** is fixed to the last link; the **tool** has
//! its origin in the tool centre point, in the flange.

mod chain;
mod drive;
mod error;
mod parts;

pub use chain::Robot;
pub use drive::{Drive, Friction};
pub use error::RobotError;
pub use parts::{Link, LinkSolid, Parts, TcpLimits};
