//! Moves of a robot along paths of its tool: from what is asked to positions, speeds and accelerations of all axes.
//!
//! | step | where |
//! |---|---|
//! | what is asked, checked before anything is solved | [`CartesianRequest`] |
//! | joint positions along the path, with their derivatives by its length | [`JointPath`] |
//! | length over time: sin², trapezoid, S-curve, time-optimal | [`TimeLaw`] |
//! | the move | [`CartesianMove`] |
//! | moves behind each other, corners rounded | [`Sequence`] |
//! | limits along the whole move, first violation with its place | [`inspect`] |
//!
//! Lengths are in m, angles in rad, times in s; targets are in the reference frame of the robot.

mod arm;
mod check;
mod course;
mod error;
mod joint_path;
mod law;
mod phase_plane;
mod plan;
mod request;
mod sequence;
mod start;
mod task;

pub use check::{AxisExtremes, Findings, Quantity, Violation, inspect};
pub use course::{Course, Narrow, State};
pub use error::{PlanError, Reason};
pub use joint_path::JointPath;
pub use law::TimeLaw;
pub use phase_plane::{Bounds, Knot, time_optimal};
pub use plan::{CartesianMove, pose};
pub use request::{CartesianRequest, Orientation, Speeds, Start, Timing};
pub use sequence::{Sequence, SequenceError, Step};
