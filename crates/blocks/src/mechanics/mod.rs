//! Blocks: mechanics.

mod inertia;
pub use inertia::Inertia;
