//! What a program without the interpreter says.

use std::path::Path;

use blocksim_block::LoadError;

use crate::fault::{self, LEFT_OUT};
use crate::open::Library;

/// Refuses a module.
///
/// # Errors
/// Always.
pub fn load(path: &Path) -> Result<Library, LoadError> {
    Err(refusal(&format!("`{}` cannot be run", fault::shown(path))))
}

/// Refuses a crate that would be built as one.
///
/// # Errors
/// Always.
pub fn usable(named: &str) -> Result<(), LoadError> {
    Err(refusal(&format!("the plug-in `{named}` cannot be run as a module (`target: Wasm`)")))
}

fn refusal(what: &str) -> LoadError {
    fault::help(
        fault::library(LEFT_OUT, format!("{what}: this blocksim was built without WebAssembly")),
        "build it with `cargo build --release --features wasm`, or with `--features full` for all of its parts",
    )
}
