//! Blocks that give set values for moves.

mod forewarning;
mod joint_move;
mod joint_path;
pub(crate) mod limits;
mod path_error;
mod planned;
mod robot_move;
mod timed;
mod tool_path;
pub use joint_move::JointMove;
pub use joint_path::{JointPath, NextMove, Rule};
pub use limits::Limits;
pub use path_error::PathError;
pub use planned::{Segments, planned, refused, replanned};
pub use robot_move::RobotMove;
pub use tool_path::{ORIENTATIONS, PROFILES, Point, ToolPath, Turns};
