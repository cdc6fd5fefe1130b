//! The author's side of a controller plug-in: one safe trait, one macro line.
//!
//! ```
#![doc = include_str!("../examples/low_pass.rs")]
//! ```
//!
//! A crate with `crate-type = ["cdylib", "rlib"]` that holds such code is a plug-in. Its cdylib is loaded by
//! blocksim; its rlib serves tests and other crates, through the trait or through `table()`, which the macro
//! writes. `docs/plugins.md` is the guide.

mod border;
mod context;
mod controller;
mod describe;
mod entry;
#[cfg(target_family = "wasm")]
mod panics;
mod quantity;
mod values;

#[doc(hidden)]
pub mod macro_parts;
pub mod testing;

pub use context::Context;
pub use controller::{Controller, Outcome};
pub use entry::{blocksim_plugin_v1, linked};
pub use quantity::{Continuous, Discrete, Input, Output, Parameter, Quantity, role};
pub use values::{ContinuousStates, Derivatives, DiscreteStates, Outputs, Parameters, Values};

pub use blocksim_abi as abi;

/// What a plug-in needs.
pub mod prelude {
    pub use crate::{
        Context, Continuous, ContinuousStates, Controller, Derivatives, Discrete, DiscreteStates, Input,
        Outcome, Output, Outputs, Parameter, Parameters, export_plugin,
    };
}
