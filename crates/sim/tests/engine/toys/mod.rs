//! Small diagrams made by hand.

#![allow(dead_code, unused_imports, reason = "the benchmark uses a part of it")]

mod blocks;
mod build;
mod tape;

pub use blocks::*;
pub use blocksim_block::methods::VARIABLE as METHODS;
pub use build::{Toy, ode4, ode45};
pub use tape::Tape;
