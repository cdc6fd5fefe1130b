//! Loads controller plug-ins and makes blocks of them: the kind [`Plugin`].
//!
//! # Who owns what
//!
//! - The **plug-in** owns its tables and texts. A library is never unloaded, so they live as long as the process;
//!   [`Library`] is a checked copy of them that is leaked for the same reason.
//! - The **engine** owns states and signals, as for every block. They are handed to the plug-in for a call.
//! - The **block** owns its parameters, as numbers in SI, shared by all its copies and never changed.
//! - **Each thread** owns the buffers that a plug-in sees: copies of what the engine has, with guards around them (`guard`), so
//!   that a call allocates nothing and what a plug-in writes beside its buffers is found.
//!
//! # The way of a plug-in
//!
//! `locate` finds what `library` names, `build` makes it if that is a folder with sources, `open` loads a copy of
//! the library, `table` checks what the library says of itself, `parameters` turns the diagram's values into
//! numbers, `guard` is the border itself, and `plugin` is the block. What goes wrong on the way becomes a
//! [`LoadError`](blocksim_block::LoadError) with one of the codes in `fault`.
//!
//! What no call returns from, such as a crash or an endless loop, is seen by `watch`; `isolate` keeps plug-ins in processes of
//! their own. Those that are WebAssembly (`wasm`) need neither, as they cannot leave the memory that they are given.
//!
//! Whether it goes that way is not decided here: `Files::code` says whether a library may be built and loaded. Where it may not,
//! a block is made of what the plug-in offered when it was loaded last (`offer`), which can be looked at but not run.
//!
//! A library is loaded from a copy in the temporary folder: overwriting a loaded library would crash the process,
//! and opening the same path twice would give the old code. Therefore a plug-in must not look for other libraries
//! relative to its own place.
//!
//! Blocks register themselves; a program that links this crate must name it in code (`use blocksim_host as _;`).

mod build;
mod call;
mod environment;
mod examine;
mod fault;
mod finite;
mod guard;
mod isolate;
mod kind;
mod locate;
mod machine;
mod offer;
mod open;
mod parameters;
mod plugin;
mod table;
mod wasm;
mod watch;

pub use build::{ANSWER_HOLDS, built, folders, set_build_notice};
pub use examine::{Examined, Finding, Verdict, examine};
pub use isolate::{serve, set_isolation, was_interrupted};
pub use kind::{Kind, Quantity};
pub use locate::{Source, Target, is_module, locate};
pub use machine::{Machines, NoMachines, machines};
pub use offer::{merged, offer, recalled};
pub use open::{Library, open, opened};
pub use plugin::Plugin;
pub use watch::{Cause, Death, end, leave, set_call_limit, set_death_notice, set_interrupt};
