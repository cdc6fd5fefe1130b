//! Blocks: math.

mod gain;
pub use gain::Gain;
