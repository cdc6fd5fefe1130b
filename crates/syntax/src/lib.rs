//! RON text as a tree with places, and its usual layout.

mod common;
mod format;
mod mistakes;
mod read;
mod scan;
mod tree;

pub use format::{WIDTH, format};
pub use read::{Remedy, SyntaxError, read};
pub use tree::{Name, Node, Shape};
