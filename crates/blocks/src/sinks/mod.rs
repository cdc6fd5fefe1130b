//! Blocks: sinks.

mod assertion;
mod scope;
mod stop;

pub use assertion::Assertion;
pub use scope::Scope;
pub use stop::Stop;
