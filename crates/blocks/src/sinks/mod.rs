//! Blocks: sinks.

mod assertion;
mod scope;
mod stop;
mod xy_scope;

pub use assertion::Assertion;
pub use scope::Scope;
pub use stop::Stop;
pub use xy_scope::XyScope;
