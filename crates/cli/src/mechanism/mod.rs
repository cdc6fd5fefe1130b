//! The mechanism of a run: what it looked like, where it was over time, what stands around it, what touched.

pub mod recorded;
pub mod surroundings;
pub mod text;
pub mod touching;
