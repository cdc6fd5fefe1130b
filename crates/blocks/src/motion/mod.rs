//! Blocks that give set values for moves.

mod joint_move;
pub use joint_move::{JointMove, JointPath, Limits, Rule};
