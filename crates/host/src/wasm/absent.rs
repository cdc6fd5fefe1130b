//! What a program without the interpreter says.

use std::path::Path;

use blocksim_block::LoadError;

use crate::fault::{self, LEFT_OUT};
use crate::open::Library;

/// Refuses.
///
/// # Errors
/// Always.
pub fn load(path: &Path) -> Result<Library, LoadError> {
    let message =
        format!("`{}` cannot be run: this blocksim was built without WebAssembly", fault::shown(path));
    Err(fault::help(
        fault::library(LEFT_OUT, message),
        "build it with `cargo build --release --features wasm`, or with `--features full` for all of its parts",
    ))
}
