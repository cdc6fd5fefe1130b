//! Blocks with continuous states.

mod low_pass;
pub use low_pass::LowPass;
