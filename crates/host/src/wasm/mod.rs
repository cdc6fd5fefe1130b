//! Controllers as WebAssembly modules: the same table and the same functions, run by an interpreter.
//!
//! A module has nothing but a memory of its own, and what it may do there is limited: it is given no imports, so many bytes, and so
//! many instructions for a call. So it needs no trust to be looked at, and cannot crash or hang the program.
//!
//! Each thread has an instance of its own of each module: runs at the same time do not wait for each other. As with a library, what
//! functions leave in the memory stays there for the next call, since the contract wants none of it to matter; an instance whose
//! function did not return is thrown away, because nothing is known of its memory.
//!
//! | file | idea |
//! |---|---|
//! | `layout` | the table in the memory of a module, translated to that of this process |
//! | `instance` | a module in a store with limits: started, its functions found and called |
//! | `load` | from a file to blocks |
//! | `absent` | what a program without the interpreter says |

#[cfg(not(feature = "wasm"))]
mod absent;
#[cfg(feature = "wasm")]
mod instance;
#[cfg(feature = "wasm")]
mod layout;
#[cfg(feature = "wasm")]
mod load;

#[cfg(not(feature = "wasm"))]
pub use absent::{load, usable};
#[cfg(feature = "wasm")]
pub use load::{Boxed, load, usable};
