//! Robots: what they are, where their tool is, how they move, and what they would hit.
//!
//! | module | holds |
//! |---|---|
//! | [`robot`] | a robot as one thing: chain of axes, frames, limits, tool, what its drives need |
//! | [`kinematics`] | inverse kinematics: closed form of six-axis arms, general solver for stacked constraints |
//! | [`motion`] | moves of axes: profiles over time, Cartesian paths |
//! | [`planner`] | moves of the tool: lines, arcs, time laws, sequences, limits and collisions on the way |
//! | [`collision`] | distances of simple shapes, first collision on a way, all contacts of one |
//!
//! They know neither blocks nor files. Lengths are in m, angles in rad, times in s.

pub mod collision;
pub mod kinematics;
pub mod motion;
pub mod planner;
pub mod robot;
