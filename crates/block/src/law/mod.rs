//! Laws as data: what a block records instead of computing it, and how the engine runs that.

mod block_law;
mod recording;

pub use block_law::BlockLaw;
pub use blocksim_law::Failure;
pub use recording::{Condition, Recording, Relation, Value};
