//! The library of blocks, one file a block, in folders by category.
//!
//! Blocks register themselves; a program that links this crate must name it in code (`use blocksim_blocks as _;`),
//! otherwise the linker leaves them out.

pub mod continuous;
pub mod discontinuities;
pub mod discrete;
pub mod drives;
pub mod electrical;
pub mod gears;
pub mod hydraulic;
mod laws;
pub mod lookup;
pub mod machines;
pub mod magnetic;
pub mod math;
pub mod mechanics;
pub mod motion;
pub mod multibody;
pub mod networks;
pub mod power_electronics;
pub mod robotics;
pub mod rotational;
pub mod routing;
pub mod sinks;
pub mod sources;
pub mod thermal;
pub mod three_phase;
pub mod translational;
