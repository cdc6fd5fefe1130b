//! Laws as data: what a block records instead of computing it, and how the engine runs that.

mod block_law;
mod forms;
mod joined;
mod reads;
mod recording;

pub use block_law::{BlockLaw, Form, ValueGroup};
pub use blocksim_law::{
    Binary, Domain, Failure, Id, Instruction, Leaf, Machine, Op, Program, Ran, Root, Tape, Unary, Word,
    WordCode,
};
pub use forms::Forms;
pub use joined::{Draft, Joined, Placed};
pub use reads::Reads;
pub use recording::{Condition, Recording, Relation, Value};
