//! Blocks: sinks.

mod assertion;
mod scope;

pub use assertion::Assertion;
pub use scope::Scope;
