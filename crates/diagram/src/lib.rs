//! From the text of a diagram to a schedule.
mod source;
mod tree;
pub use source::{Reader, SourceFile, Sources};
pub use tree::{Name, Node};
