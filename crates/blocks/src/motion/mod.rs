//! Blocks that give set values for moves.

mod joint_move;
mod planned;
mod tool_path;
pub use joint_move::{JointMove, JointPath, Limits, NextMove, Rule};
pub use planned::{planned, refused};
pub use tool_path::{ORIENTATIONS, PROFILES, Point, ToolPath, Turns};
