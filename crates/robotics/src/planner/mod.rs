//! Moves of a robot along paths of its tool: from what is asked to positions, speeds and accelerations of all axes.
//!
//! | step | where |
//! |---|---|
//! | what is asked, checked before anything is solved | [`CartesianRequest`] |
//! | in which configuration of the arm it begins | [`choose`] |
//! | joint positions along the path, with their derivatives by its length | [`JointPath`] |
//! | length over time: sin², trapezoid, S-curve, time-optimal | [`TimeLaw`] |
//! | the move | [`CartesianMove`] |
//! | moves behind each other, corners rounded | [`Sequence`] |
//! | limits along the whole move, first violation with its place | [`inspect`] |
//! | collisions along the whole move, and the least distance | [`encounters`] |
//! | all of this as one list with codes, places, numbers and remedies | [`review`] |
//!
//! Lengths are in m, angles in rad, times in s; targets are in the reference frame of the robot.

mod arm;
mod check;
mod collide;
mod configuration;
mod course;
mod error;
mod fastest;
mod joint_path;
mod law;
mod phase_plane;
mod plan;
mod prescribed;
mod request;
mod review;
mod sequence;
mod start;
mod task;
mod workspace;

pub use check::{AxisExtremes, Effort, Findings, Quantity, Scrutiny, Violation, inspect};
pub use collide::{Encounter, Encounters, RobotShapes, Space, Surroundings, encounters};
pub use configuration::{Chosen, Tried, choose, configuration_word, configurations};
pub use course::{Course, Narrow, Note, Spot, State, Way};
pub use error::{PlanError, Reason};
pub use joint_path::JointPath;
pub use law::TimeLaw;
pub use phase_plane::{Bounds, Knot, time_optimal};
pub use plan::{CartesianMove, pose};
pub use request::{CartesianRequest, Orientation, Speeds, Start, Timing, Turning};
pub use review::{Finding, Review, Severity, inspect_axes, review};
pub use sequence::{Sequence, SequenceError, Step};
