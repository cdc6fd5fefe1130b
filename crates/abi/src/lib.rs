//! The border between blocksim and controller plug-ins: C structs, nothing else.
//!
//! [`table`] is the whole contract. A plug-in exports one function, [`SYMBOL`], that returns a
//! [`PluginTable`]; everything else is found from there. `include/blocksim_plugin.h` says the same in C
//! and is generated from `table.rs`; a test compares the two.
//!
//! [`message`] writes a reason into the host's buffer, [`read`] reads tables of older and newer plug-ins.
//! Authors in Rust never see this crate: they implement a safe trait of `blocksim-controller`.

#![no_std]

pub mod message;
pub mod read;
pub mod table;

pub use table::*;

/// The contract in C, for compilers that this program calls.
pub const HEADER: &str = include_str!("../include/blocksim_plugin.h");
