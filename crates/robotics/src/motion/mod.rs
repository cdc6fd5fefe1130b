//! Set values for moves: from a start, a target and limits to position, velocity and acceleration over time.
//!
//! Positions are in rad for axes that turn and in m for axes that slide, times in s.
//!
//! ```
//! use blocksim_robotics::motion::{AxisKind, AxisLimits, JointMove, JointMoveRequest, Synchronisation};
//!
//! let limits = [AxisLimits { kind: AxisKind::Turning, lower: -3.0, upper: 3.0, speed: 2.0, acceleration: 10.0 }];
//! let request = JointMoveRequest {
//!     start: vec![0.0],
//!     target: vec![1.0],
//!     velocity: 0.5,
//!     acceleration: 0.25,
//!     rule: Synchronisation::Feasible,
//! };
//! let planned = JointMove::plan(&request, &limits)?;
//! let (position, velocity, acceleration) = planned.at(0, planned.duration() / 2.0);
//! assert!((position - 0.5).abs() < 1e-12 && (velocity - 1.0).abs() < 1e-12 && acceleration == 0.0);
//! # Ok::<(), blocksim_robotics::motion::MoveError>(())
//! ```

mod axis_kind;
mod error;
mod jerk_limited;
mod joint_move;
mod limits;
mod path;
mod profile;
mod request;
mod times;

pub use axis_kind::AxisKind;
pub use error::{Endpoint, MoveError};
pub use jerk_limited::{JerkLimited, ProfileLimits};
pub use joint_move::JointMove;
pub use limits::{AxisLimits, AxisQuantity, AxisViolation, Margin};
pub use path::{Path, PathError, PathPoint};
pub use profile::Profile;
pub use request::{JointMoveRequest, Synchronisation};
